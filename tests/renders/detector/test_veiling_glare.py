"""Veiling glare: the share that is put in comes back, nothing is gained, and the Sun's own law."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arrays import Floats
from models.camera import Camera
from models.sensors.camera_chip import Detector, Optics, photon_energy_j
from models.sensors.lens_scatter import LensScatter
from renders.detector.compose import compose
from renders.detector.expose import SUNLIGHT_NM, electrons_per_radiance, mean_electrons
from renders.detector.veiling_glare import sun_glare, veiled
from renders.scenario.scenario import Scenario
from renders.tracing.light_groups import LightGroup
from renders.world.build import world_of
from renders.world.exposure import Exposure

ROUNDING = 1e-9
CAMERA = Camera.from_fov(128, 128, 50.0)


def distance(height: int, width: int, row: float, column: float) -> Floats:
    v, u = np.mgrid[0:height, 0:width]
    return np.hypot(v - row, u - column)


@given(
    share=st.floats(0.001, 0.5),
    radius=st.floats(8.0, 200.0),
    row=st.integers(0, 59),
    column=st.integers(0, 79),
)
def test_the_share_put_in_is_the_share_that_is_spread(
    share: float, radius: float, row: int, column: int
) -> None:
    """A point keeps the rest; all of its light is on the chip, wherever it stands."""
    image = np.zeros((60, 80))
    image[row, column] = 1.0
    after = veiled(image, share, radius)
    assert after.sum() == pytest.approx(1.0, rel=ROUNDING)
    assert after.min() >= 0.0
    peak = share / (2.0 * np.pi * radius**2)  # of the spread light, and as much from each mirror
    assert 1.0 - share <= after[row, column] < 1.0 - share + 4.5 * peak + share / image.size


def test_an_even_field_stays_even() -> None:
    np.testing.assert_allclose(veiled(np.full((50, 70), 3.0), 0.3, 40.0), 3.0, rtol=ROUNDING)


@pytest.mark.parametrize("patch_px", [10.0, 30.0])
def test_a_black_patch_in_an_even_field_shows_the_glare_index_of_iso_9358(patch_px: float) -> None:
    """In closed form, share r0 / sqrt(r0^2 + a^2); the patch's edge is cut out of whole pixels."""
    share, radius = 0.04, 20.0
    field = np.where(distance(401, 401, 200, 200) > patch_px, 1.0, 0.0)
    found = veiled(field, share, radius)[200, 200]
    expected = share * radius / np.hypot(radius, patch_px)
    mirrored = patch_px**2 / (2.0 * 400.0**2)  # of patches in the mirrors, at 400 px and beyond
    assert found == pytest.approx(expected, rel=0.5 / patch_px + mirrored)


def test_a_bright_square_has_a_halo_that_falls_as_the_cube() -> None:
    image = np.zeros((601, 601))
    image[300, 300] = 1.0
    halo = veiled(image, 0.1, 10.0)[300]
    found = halo[300 + np.array([40, 80, 120])]
    radius = np.array([40.0, 80.0, 120.0])
    alone = 0.1 * 10.0 / (2.0 * np.pi * (100.0 + radius**2) ** 1.5)
    mirrors = 4.0 * 0.1 * 10.0 / (2.0 * np.pi * 480.0**3)  # four at 480 px or more, and others
    np.testing.assert_allclose(found, alone, atol=3.0 * mirrors)


def test_it_is_off_by_default_and_an_option_of_the_lens() -> None:
    assert Optics().veiling_glare == 0.0
    rate = np.zeros((128, 128), np.float32)
    rate[40:60, 40:60] = 1e5
    detector = Detector(prnu=0.0, dark_current_e_s=0.0)
    plain = Optics(psf_sigma_px=0.0, vignetting=False)
    glaring = replace(plain, veiling_glare=0.05, veiling_glare_px=60.0)
    sharp = mean_electrons(rate, 1000.0, CAMERA, plain, detector)
    soft = mean_electrons(rate, 1000.0, CAMERA, glaring, detector)
    assert (sharp[:30] == 0.0).all()
    assert (soft[:30] > 0.0).all()
    assert soft.sum() == pytest.approx(sharp.sum(), rel=ROUNDING)
    np.testing.assert_allclose(soft, veiled(sharp, 0.05, 60.0), rtol=1e-6, atol=1e-6)


# The Sun

SCATTER = LensScatter(peak_1_sr=10.0)


def towards(off_axis_deg: float) -> Floats:
    """Return a Sun to the right of the boresight."""
    angle = np.deg2rad(off_axis_deg)
    return np.array([np.sin(angle), 0.0, np.cos(angle)])


@pytest.mark.parametrize("off_axis_deg", [0.0, 10.0, 26.0, 60.0])
def test_the_middle_of_the_chip_gets_the_point_source_transmittance(off_axis_deg: float) -> None:
    """Electrons from the scattered radiance, against irradiance x PST x area x QE / photon."""
    camera = Camera(101, 101, 110.0, 110.0, 50.0, 50.0)
    optics, detector = Optics(vignetting=False), Detector()
    glare = sun_glare(camera, towards(off_axis_deg), 74.0, SCATTER, sun_is_hidden=False)
    assert glare is not None
    found = glare[50, 50] * electrons_per_radiance(optics, detector, SUNLIGHT_NM)
    irradiance = 74.0 * SCATTER.point_source_transmittance(optics, off_axis_deg)
    expected = irradiance * 13.5e-6**2 * 0.5 / photon_energy_j(SUNLIGHT_NM)
    single_precision = 1e-5
    assert found == pytest.approx(expected, rel=single_precision)


def test_each_pixel_sees_the_sun_at_its_own_angle() -> None:
    """A Sun just outside the field, 26 deg to the right: a veil that rises towards it."""
    glare = sun_glare(CAMERA, towards(26.0), 74.0, SCATTER, sun_is_hidden=False)
    assert glare is not None
    for row, column in ((0, 0), (64, 5), (64, 127), (100, 90)):
        ray = CAMERA.rays(np.array([[column, row]]))[0]
        expected = 74.0 * np.cos(np.deg2rad(26.0)) * SCATTER.scattered(ray @ towards(26.0))
        assert glare[row, column] == pytest.approx(float(expected), rel=1e-5)
    assert (np.diff(glare[64]) > 0.0).all()
    np.testing.assert_allclose(glare, glare[::-1], rtol=1e-5)
    assert glare[64, 127] > 50.0 * glare[64, 0]


def test_a_sun_in_the_field_is_brightest_where_it_stands() -> None:
    glare = sun_glare(CAMERA, towards(10.0), 74.0, SCATTER, sun_is_hidden=False)
    assert glare is not None
    row, column = np.unravel_index(glare.argmax(), glare.shape)
    found = CAMERA.project(towards(10.0)[None])[0]
    assert np.abs(np.array([column, row]) - found).max() <= 0.51


def test_a_hidden_sun_a_hood_a_sun_behind_and_a_clean_lens_make_no_glare() -> None:
    hooded = replace(SCATTER, hood_deg=30.0)
    assert sun_glare(CAMERA, towards(26.0), 74.0, SCATTER, sun_is_hidden=True) is None
    assert sun_glare(CAMERA, towards(35.0), 74.0, hooded, sun_is_hidden=False) is None
    assert sun_glare(CAMERA, towards(26.0), 74.0, hooded, sun_is_hidden=False) is not None
    assert sun_glare(CAMERA, towards(100.0), 74.0, SCATTER, sun_is_hidden=False) is None
    assert sun_glare(CAMERA, towards(26.0), 74.0, LensScatter(), sun_is_hidden=False) is None


@pytest.mark.parametrize(
    ("sun", "seen"),
    [
        ("0.7,0.7,-0.9", True),  # past the target's corner, 45 deg off the boresight
        ("0.0,1.0,-0.9", False),  # 48 deg off it, behind a solar wing
        ("0.0,0.05,-1.0", False),  # behind the target
        ("S2", False),  # behind the camera
    ],
)
def test_a_scenario_switches_it_on_and_the_target_hides_the_sun(sun: str, seen: bool) -> None:
    def image(**table: float) -> Floats:
        scenario = {"name": "x", "camera": {"width": 128}, "sun": {"default": sun}}
        world = world_of(Scenario.model_validate({**scenario, "lens_scatter": table}))
        dark: dict[LightGroup, np.ndarray] = {world.sun: np.zeros((128, 128), np.float32)}
        return compose(world, dark, Exposure(0, 850, 0.0), 20.0, run=0).astype(float)

    more = image(peak_1_sr=10.0).mean() - image().mean()
    assert (more > 20.0) == seen
    assert seen or more == 0.0
