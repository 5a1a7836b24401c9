"""The filter's motion against closed forms and the true integrator."""

import numpy as np
import pytest

from models.gravity.field import GravityField, earth_gravity
from models.quaternions import from_rotation_vector, multiplied, rotated
from pipelines.absolute import options
from pipelines.absolute.dynamics import carried, modelled_gravity, process_noise_factor
from pipelines.absolute.error_state import SIZE
from pipelines.absolute.options import absolute_options_for

BEST = absolute_options_for("best", "leo")
PAPER = absolute_options_for("paper", "leo")
TURNED = np.array([1.0, 0.0, 0.0, 0.0])


def state(position, velocity) -> np.ndarray:
    vector = np.zeros(SIZE)
    vector[:3], vector[3:6] = position, velocity
    return vector


def test_equation_6_is_the_field_of_degree_two():
    full = earth_gravity(2)
    c = np.zeros((3, 3))
    c[0, 0], c[2, 0] = 1.0, -BEST.j2 / np.sqrt(5.0)
    field = GravityField(BEST.mu_m3_s2, BEST.radius_m, c, np.zeros((3, 3)))
    place = np.array([4.1e6, -3.3e6, 4.9e6])
    assert modelled_gravity(place, BEST) == pytest.approx(field.acceleration(place), rel=1e-13)
    assert full.j2 == pytest.approx(BEST.j2, rel=1e-6)


@pytest.mark.parametrize(("step_s", "most_m"), [(0.2, 1e-3), (1.0, 2e-2)])
def test_steps_add_up_to_the_orbit(step_s, most_m):
    """A minute against an eighth-order integrator of the same law, at both step sizes."""
    from scipy.integrate import solve_ivp

    start = state([7.158e6, 0.0, 0.0], [0.0, -1103.0, 7380.0])
    vector, quaternion = start, TURNED
    for _ in range(round(60.0 / step_s)):
        vector, quaternion = carried(vector, quaternion, np.zeros(3), step_s, BEST)
    found = solve_ivp(
        lambda _, now: np.concatenate([now[3:], modelled_gravity(now[:3], BEST)]),
        (0.0, 60.0),
        start[:6],
        method="DOP853",
        rtol=1e-12,
        atol=1e-6,
    )
    assert vector[:3] == pytest.approx(found.y[:3, -1], abs=most_m)
    assert vector[3:6] == pytest.approx(found.y[3:, -1], abs=3e-3 * most_m)


def test_the_quaternion_turns_at_the_rate_less_the_bias():
    """Equation 4 with its q: a right-hand product by the turn of the body."""
    vector = state([7.158e6, 0.0, 0.0], [0.0, 7460.0, 0.0])
    vector[12:15] = [0.0, 0.0, 0.01]
    first = from_rotation_vector(np.array([0.3, -0.2, 0.9]))
    _, turned = carried(vector, first, np.array([0.02, 0.01, 0.03]), 2.0, BEST)
    expected = multiplied(first, from_rotation_vector(np.array([0.02, 0.01, 0.01])))
    assert turned == pytest.approx(expected, abs=1e-14)


def test_accelerometers_push_along_the_body():
    vector = state([7.158e6, 0.0, 0.0], [0.0, 7460.0, 0.0])
    quaternion = from_rotation_vector(np.array([0.3, -0.2, 0.9]))
    force = np.array([0.01, -0.02, 0.03])
    coasting, _ = carried(vector, quaternion, np.zeros(3), 0.1, BEST)
    pushed, _ = carried(vector, quaternion, np.zeros(3), 0.1, BEST, None, force)
    gained = (pushed - coasting)[3:6] / 0.1
    assert gained == pytest.approx(rotated(quaternion, force), abs=1e-9)


@pytest.mark.parametrize("options", [PAPER, BEST])
def test_noise_of_many_steps_is_noise_of_one(options):
    """Van Loan's integral is additive under the motion of each block."""
    small, large = (process_noise_factor(options, t) for t in (0.2, 1.0))
    step = np.eye(SIZE)
    t = 0.2
    for axis in range(3):
        step[axis, 3 + axis] = step[3 + axis, 6 + axis] = t
        step[axis, 6 + axis] = 0.5 * t**2
        step[9 + axis, 12 + axis] = -t
    step[15, 16] = t
    total = np.zeros((SIZE, SIZE))
    for _ in range(5):
        total = step @ total @ step.T + small @ small.T
    scale = np.sqrt(np.diag(large @ large.T))
    assert total / np.outer(scale, scale) == pytest.approx(
        large @ large.T / np.outer(scale, scale), abs=1e-9
    )


def test_the_constants_on_board_are_those_of_wgs_84_and_egm() -> None:
    """GM as GPS and EGM have it, the equator's radius, and J2 of EGM2008 to its printed digits."""
    assert options.EARTH_RADIUS_M == 6_378_137.0
    assert pytest.approx(earth_gravity(2).j2, rel=2e-5) == options.J2
    assert earth_gravity(2).mu_m3_s2 == options.EGM_MU_M3_S2
    assert pytest.approx(1.0, abs=2e-7) == options.GPS_MU_M3_S2 / options.EGM_MU_M3_S2
