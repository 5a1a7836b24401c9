"""The gravity field against its own potential, J2's closed form, and the poles."""

import numpy as np
import pytest

from models.gravity.field import MOST_DEGREE, MU_M3_S2, RADIUS_M, GravityField, earth_gravity

LEO_M, GEO_M = 7_158_000.0, 42_164_000.0
STEP_M = 20.0  # of a central difference: its error is 1e-12 of the acceleration here
DIFFERENCE_M_S2 = 1e-8  # the potential has sixteen digits, hence 1e-8 over the step


def potential(field: GravityField, place: np.ndarray) -> float:
    """Return the potential by SciPy's Legendre functions, which know nothing of ours."""
    from scipy.special import factorial, lpmv

    radius = np.linalg.norm(place)
    longitude = np.arctan2(place[1], place[0])
    total = 0.0
    for n in range(field.degree + 1):
        m = np.arange(n + 1)
        norm = np.sqrt((2 - (m == 0)) * (2 * n + 1) * factorial(n - m) / factorial(n + m))
        legendre = norm * (-1.0) ** m * lpmv(m, n, place[2] / radius)
        waves = field.c[n, m] * np.cos(m * longitude) + field.s[n, m] * np.sin(m * longitude)
        total += (field.radius_m / radius) ** n * float(legendre @ waves)
    return field.mu_m3_s2 / radius * total


@pytest.mark.parametrize("seed", range(3))
def test_it_is_the_slope_of_the_potential(seed):
    field = earth_gravity(20)
    way = np.random.default_rng(seed).standard_normal(3)
    place = LEO_M * way / np.linalg.norm(way)
    slope = [
        (potential(field, place + step) - potential(field, place - step)) / (2.0 * STEP_M)
        for step in STEP_M * np.eye(3)
    ]
    assert field.acceleration(place) == pytest.approx(slope, abs=DIFFERENCE_M_S2)


def test_degree_two_alone_is_the_closed_form_of_j2():
    c = np.zeros((3, 3))
    c[0, 0], c[2, 0] = 1.0, earth_gravity(2).c[2, 0]
    field = GravityField(MU_M3_S2, RADIUS_M, c, np.zeros((3, 3)))
    place = np.array([4.1e6, -3.3e6, 4.9e6])
    radius = np.linalg.norm(place)
    share = 5.0 * (place[2] / radius) ** 2 - np.array([1.0, 1.0, 3.0])
    flat = 1.0 - 1.5 * field.j2 * (RADIUS_M / radius) ** 2 * share
    assert field.j2 == pytest.approx(1.0826e-3, abs=1e-7)
    assert field.acceleration(place) == pytest.approx(
        -MU_M3_S2 * place / radius**3 * flat, rel=1e-13
    )


def test_nothing_happens_at_the_poles():
    field = earth_gravity(MOST_DEGREE)
    at_pole = field.acceleration(np.array([0.0, 0.0, LEO_M]))
    beside = field.acceleration(np.array([1e-3, 1e-3, LEO_M]))
    assert np.isfinite(at_pole).all()
    assert beside == pytest.approx(at_pole, abs=1e-8)  # a millimetre of gradient


def test_what_is_left_out_fades_with_height():
    """The field beyond degree 8 is felt in LEO, and not in GEO."""
    for radius, least, most in ((LEO_M, 1e-5, 1e-3), (GEO_M, 0.0, 1e-11)):
        place = radius * np.array([0.6, 0.48, 0.64])
        rest = earth_gravity(36).acceleration(place) - earth_gravity(8).acceleration(place)
        assert least <= np.linalg.norm(rest) < most


def test_a_degree_that_the_table_lacks_is_refused():
    with pytest.raises(ValueError, match="from 2 to 36, got 70"):
        earth_gravity(70)
