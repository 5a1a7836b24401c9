"""The retroreflector: drawn as it says, energy kept, reciprocal, dark at 800 nm and to the Sun."""

import itertools

import numpy as np
import pytest

from models.materials import MATERIALS
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.tracing.surfaces import surface_of_disc
from tests.support.small_scenes import activate_best, needs_jit
from tests.support.surfaces import chi_square, value

OPTICS = RetroreflectorOptics()
DISC = surface_of_disc(OPTICS)


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    activate_best()


def returned_share(incidence_deg: float, band: int) -> float:
    """Integrate f_r cos over the hemisphere on a fine grid about the incident direction."""
    angle = np.deg2rad(incidence_deg)
    viewer = np.array([[np.sin(angle)], [0.0], [np.cos(angle)]])
    # The lobe ends at 2 deg: fine rings there, coarse ones beyond.
    edges = np.deg2rad(np.concatenate([np.linspace(0, 2.2, 221), np.linspace(2.2, 120, 400)[1:]]))
    middle, width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    phi = (np.arange(96) + 0.5) / 96 * 2 * np.pi
    theta, turn = np.meshgrid(middle, phi, indexing="ij")
    local = np.stack(
        [np.sin(theta) * np.cos(turn), np.sin(theta) * np.sin(turn), np.cos(theta)], axis=-1
    )
    x = np.array([np.cos(angle), 0.0, -np.sin(angle)])
    z = np.array([np.sin(angle), 0.0, np.cos(angle)])
    directions = local @ np.stack([x, [0.0, 1.0, 0.0], z])
    weight = np.sin(theta) * width[:, None] * (2 * np.pi / 96)
    returned = value(DISC, viewer, directions.reshape(-1, 3).T)[band]
    return float((returned * weight.ravel()).sum())


@pytest.mark.parametrize("incidence_deg", [0.0, 15.0, 30.0, 60.0, 80.0])
@pytest.mark.parametrize("band", [0, 1, 2])
def test_returns_no_more_than_it_receives(incidence_deg: float, band: int) -> None:
    needs_jit()
    assert 0.0 <= returned_share(incidence_deg, band) <= 1.0


@pytest.mark.parametrize("incidence_deg", [0.0, 10.0, 20.0])
def test_returns_rho_times_aperture_times_cosine(incidence_deg: float) -> None:
    """Within the cone the projected solid angle is pi sin^2 psi cos theta."""
    needs_jit()
    cosine = float(np.cos(np.deg2rad(incidence_deg)))
    lobe = returned_share(incidence_deg, 2) - returned_share(incidence_deg, 1)
    expected = (OPTICS.returned.nir850 - OPTICS.returned.nir800) * aperture(cosine) * cosine
    two_percent = 0.02  # over the lobe the half vector, and so the aperture, varies by a degree
    assert lobe == pytest.approx(expected, rel=two_percent)


def aperture(cosine: float) -> float:
    """Return the share of a round face that its image covers, by counting points of it."""
    refracted = np.arcsin(np.sqrt(1.0 - cosine**2) / OPTICS.refractive_index)
    apart = 2.0 * np.sqrt(2.0) * np.tan(refracted)  # twice the depth D / sqrt(2), over the radius
    y, x = np.mgrid[-1.0:1.0:2001j, -1.0:1.0:2001j]
    face = x**2 + y**2 < 1.0
    return float((face & ((x - apart) ** 2 + y**2 < 1.0)).sum() / face.sum())


@pytest.mark.parametrize("incidence_deg", [0.0, 15.0, 25.0, 40.0])
def test_aperture_of_a_solid_cube_is_the_overlap_of_its_face_and_its_image(
    incidence_deg: float,
) -> None:
    from renders.tracing.retroreflector import active_aperture

    cosine = float(np.cos(np.deg2rad(incidence_deg)))
    points = 1e-3  # of a face of three million points
    expected = pytest.approx(aperture(cosine), abs=points)
    assert active_aperture(cosine, OPTICS.refractive_index) == expected


def test_aperture_closes_and_stays_closed() -> None:
    from renders.tracing.retroreflector import active_aperture

    shares = [float(active_aperture(float(c), 1.4525)) for c in np.linspace(1.0, 0.0, 200)]
    assert all(later <= earlier + 1e-12 for earlier, later in itertools.pairwise(shares))
    assert shares[-1] == 0.0


def test_is_reciprocal() -> None:
    needs_jit()
    rng = np.random.default_rng(1)
    first = rng.normal(size=(2000, 3)) * [0.3, 0.3, 0.0] + [0, 0, 1]
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = first + rng.normal(scale=0.02, size=first.shape)
    second /= np.linalg.norm(second, axis=1, keepdims=True)

    def f(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.asarray(value(DISC, a.T, b.T)[2] / b[:, 2])

    forward, backward = f(first, second), f(second, first)
    assert (forward > 10.0).sum() > 500  # many of the pairs lie in the lobe
    single_precision = 2e-3  # of asin near 1, at normal incidence
    np.testing.assert_allclose(forward, backward, rtol=single_precision)


@pytest.mark.parametrize("incidence_deg", [0.0, 20.0, 45.0])
def test_chi_square_of_its_sampling(incidence_deg: float) -> None:
    """Directions drawn follow the density that is claimed for them (Mitsuba's own chi-square)."""
    needs_jit()
    wide = RetroreflectorOptics(half_angle_deg=8.0)  # the test's grid must resolve the lobe
    angle = np.deg2rad(incidence_deg)
    viewer = np.array([[np.sin(angle)], [0.0], [np.cos(angle)]])
    test = chi_square(surface_of_disc(wide), viewer, 1_000_000, res=201, ires=32)
    assert test.run(), test.messages


def test_sunlight_is_not_returned_but_lights_the_face() -> None:
    needs_jit()
    share = returned_share(10.0, 0)
    face = MATERIALS["corner_cube_face"]
    assert 0.5 * face.diffuse.sunlight < share < face.diffuse.sunlight + face.specular.sunlight
