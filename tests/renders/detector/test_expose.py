"""The detector chain, tried as a laboratory tries a camera: flat fields, dark frames, a point."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arrays import Image, Radiance
from models.camera import CAMERAS, Camera
from models.lights.led_beam import LAMPS_800, LAMPS_850
from models.sensors.camera_chip import Detector, Optics
from renders.detector.expose import (
    SUNLIGHT_NM,
    electron_rate,
    electrons_per_radiance,
    expose_electrons,
    exposure_rng,
    mean_electrons,
    pixel_response,
    vignetting,
)
from renders.tracing.light_groups import NIR800, NIR850, LampGroup, SunGroup

CAMERA = Camera.from_fov(128, 128, 50.0)
OPTICS = Optics(psf_sigma_px=0.0, vignetting=False)  # what is not under test is left out
DETECTOR = Detector(prnu=0.0, dark_current_e_s=0.0)
SUN = SunGroup("sun", (0.0, 0.0, 1.0))
LAMPS = LampGroup("lamps_850", LAMPS_850, NIR850)


def flat(rate_e_s: float, camera: Camera = CAMERA) -> Radiance:
    return np.full((camera.height, camera.width), rate_e_s, dtype=np.float32)


def flat_field(
    electrons: float, detector: Detector = DETECTOR, run: int = 0, optics: Optics = OPTICS
) -> Image:
    """Return one frame of an even field that gives ``electrons`` a pixel in a second."""
    mean = mean_electrons(flat(electrons), 1000.0, CAMERA, optics, detector)
    return expose_electrons(mean, detector, exposure_rng(run, 0, 850))


# Photons


def test_electrons_per_radiance_by_hand() -> None:
    """1 W m-2 sr-1 through f/16: 2.454 mW/m2 on the chip, 0.447 pW a pixel, 1.91e6 photons/s."""
    on_chip = 0.8 * np.pi / (4.0 * 16.0**2)
    on_pixel = on_chip * 13.5e-6**2
    photons = on_pixel / 2.33699e-19  # an 850 nm photon, J
    assert photons == pytest.approx(1.914e6, rel=1e-3)
    found = electrons_per_radiance(Optics(), Detector(), 850.0)
    assert found == pytest.approx(0.5 * photons, rel=1e-5)


@given(
    f_number=st.floats(1.0, 32.0),
    pitch=st.floats(2.0, 30.0),
    efficiency=st.floats(0.01, 1.0),
    transmission=st.floats(0.01, 1.0),
    wavelength=st.floats(400.0, 1000.0),
)
def test_the_camera_equation_scales_as_it_should(
    f_number: float, pitch: float, efficiency: float, transmission: float, wavelength: float
) -> None:
    optics = Optics(f_number=f_number, transmission=transmission)
    detector = Detector(pixel_pitch_um=pitch, quantum_efficiency=efficiency)
    ratio = electrons_per_radiance(optics, detector, wavelength)
    ratio /= electrons_per_radiance(Optics(), Detector(), 850.0)
    by_hand = (16.0 / f_number) ** 2 * (pitch / 13.5) ** 2
    by_hand *= (efficiency / 0.5) * (transmission / 0.8) * (wavelength / 850.0)
    assert ratio == pytest.approx(by_hand, rel=1e-9)


def test_groups_add_up_each_at_its_own_wavelength() -> None:
    sun, lamps = flat(2.0), flat(3.0)
    total = electron_rate({SUN: sun, LAMPS: lamps}, OPTICS, DETECTOR)
    expected = 2.0 * electrons_per_radiance(OPTICS, DETECTOR, SUNLIGHT_NM)
    expected += 3.0 * electrons_per_radiance(OPTICS, DETECTOR, 850.0)
    np.testing.assert_allclose(total, expected, rtol=1e-6)
    other = LampGroup("lamps_800", LAMPS_800, NIR800)
    fewer = electron_rate({other: lamps}, OPTICS, DETECTOR)[0, 0]
    more = electron_rate({LAMPS: lamps}, OPTICS, DETECTOR)[0, 0]
    assert fewer / more == pytest.approx(800.0 / 850.0, rel=1e-6)


def test_another_lamp_power_is_a_factor_after_rendering() -> None:
    groups = {SUN: flat(2.0), LAMPS: flat(3.0)}
    alone = electron_rate({LAMPS: flat(3.0)}, OPTICS, DETECTOR)
    plain = electron_rate(groups, OPTICS, DETECTOR)
    doubled = electron_rate(groups, OPTICS, DETECTOR, scales={"lamps_850": 2.0})
    np.testing.assert_allclose(doubled - plain, alone, rtol=1e-5)


def test_no_light_group_is_an_error() -> None:
    with pytest.raises(ValueError, match="at least one light group"):
        electron_rate({}, OPTICS, DETECTOR)


# Optics


def test_the_lens_blurs_by_the_sigma_it_says() -> None:
    """The kernel itself is held in ``test_point_spread.py``."""
    rate = flat(0.0)
    rate[60, 70] = 5e4
    charge = mean_electrons(rate, 1000.0, CAMERA, replace(OPTICS, psf_sigma_px=0.5), DETECTOR)
    v, u = np.mgrid[0:128, 0:128]
    for axis, centre in ((u, 70), (v, 60)):
        spread = np.sqrt((charge * (axis - centre) ** 2).sum() / charge.sum())
        assert spread == pytest.approx(0.5, rel=1e-4)
    assert charge.sum() == pytest.approx(5e4, rel=1e-6)


def test_exposing_leaves_the_light_as_it_was() -> None:
    """Also where no step needs a copy of it, as in double precision without blur."""
    rate = flat(1e4).astype(np.float64)
    mean_electrons(rate, 1.0, CAMERA, Optics(psf_sigma_px=0.0), DETECTOR)
    assert (rate == 1e4).all()


@pytest.mark.parametrize("camera", [CAMERA, Camera(100, 80, 90.0, 95.0, 30.2, 60.1)])
def test_vignetting_is_the_fourth_power_of_the_cosine_off_axis(camera: Camera) -> None:
    v, u = np.mgrid[0 : camera.height, 0 : camera.width]
    cosine = camera.rays(np.stack([u.ravel(), v.ravel()], axis=1))[:, 2]
    expected = (cosine**4).reshape(camera.height, camera.width)
    charge = mean_electrons(flat(1e6, camera), 1.0, camera, Optics(psf_sigma_px=0.0), DETECTOR)
    np.testing.assert_allclose(charge, 1000.0 * expected, rtol=1e-6)
    np.testing.assert_allclose(vignetting(camera), expected, rtol=1e-12)


def test_a_corner_of_the_chaser_fixed_camera_gets_half_the_light() -> None:
    """It is tan 25 deg off the axis both ways: cos^4 is 1 / (1 + 2 x 0.2174)^2 = 0.486."""
    corner = vignetting(CAMERAS["chaser_fixed"].resized(256))[0, 0]
    assert corner == pytest.approx(0.486, abs=4e-3)  # the corner pixel's centre is half a pixel in


# Noise


@pytest.mark.parametrize("electrons", [0.0, 300.0, 3e4, 9e4])
def test_frames_are_as_noisy_as_the_detector_says(electrons: float) -> None:
    """Centroid weights rest on ``Detector.noise_dn``: it must be what frames really show."""
    frame = flat_field(electrons).astype(np.float64)
    level = DETECTOR.bias_dn + electrons / DETECTOR.gain_e_dn
    four_sigma = 4.0 / np.sqrt(2.0 * frame.size)
    assert frame.std() == pytest.approx(DETECTOR.noise_dn(np.array([level]))[0], rel=four_sigma)
    assert frame.mean() == pytest.approx(level, abs=4.0 * frame.std() / np.sqrt(frame.size))


def test_an_empty_scene_lies_at_the_bias_within_the_noise() -> None:
    detector = replace(Detector(), dark_current_e_s=20.0)
    frame = flat_field(0.0, detector).astype(np.float64)  # an exposure of a second: 20 e of dark
    noise = np.sqrt((12.0**2 + 20.0) / 26.0**2 + 1.0 / 12.0)
    assert frame.mean() == pytest.approx(100.0 + 20.0 / 26.0, abs=4.0 * noise / np.sqrt(frame.size))
    assert frame.std() == pytest.approx(noise, rel=0.05)
    assert np.abs(frame - 100.0).max() < 6.0 * noise + 1.0


def test_dark_current_grows_with_time_and_knows_no_vignetting() -> None:
    detector = replace(DETECTOR, dark_current_e_s=500.0)
    dark = mean_electrons(flat(0.0), 40.0, CAMERA, Optics(), detector)
    np.testing.assert_allclose(dark, 20.0)


def test_pixel_response_is_one_chip_in_every_frame_and_run() -> None:
    detector = replace(DETECTOR, prnu=0.01)
    frames = [flat_field(8e4, detector, run).astype(np.float64) - 100.0 for run in range(8)]
    pattern = np.mean(frames, axis=0)
    pattern /= pattern.mean()
    known = pixel_response(128, 128, 0.01)
    assert known.std() == pytest.approx(0.01, rel=0.03)
    noise = 1.0 / np.sqrt(8 * 8e4)
    assert np.corrcoef(pattern.ravel(), known.ravel())[0, 1] > 0.98
    assert (pattern - known).std() == pytest.approx(noise, rel=0.1)


# Saturation


def test_charge_is_linear_in_time_until_it_saturates() -> None:
    exposures_ms = [10.0, 20.0, 40.0, 80.0]
    means = []
    for exposure_ms in exposures_ms:
        mean = mean_electrons(flat(1e6), exposure_ms, CAMERA, OPTICS, DETECTOR)
        frame = expose_electrons(mean, DETECTOR, exposure_rng(0, 0, 850))
        means.append(float(frame.mean()) - DETECTOR.bias_dn)
    slopes = np.array(means) / exposures_ms
    np.testing.assert_allclose(slopes, 1e3 / DETECTOR.gain_e_dn, rtol=1e-3)


def test_a_full_well_clips_below_the_converters_end() -> None:
    frame = flat_field(5e5)
    noise = DETECTOR.read_noise_e / DETECTOR.gain_e_dn
    assert frame.mean() == pytest.approx(DETECTOR.saturation_dn, abs=0.01)
    assert frame.std() < 2.0 * noise  # no photon noise is left above a full well
    assert frame.max() < DETECTOR.max_dn


@pytest.mark.parametrize("bits", [8, 12, 14])
def test_the_converter_ends_at_its_bits(bits: int) -> None:
    detector = replace(DETECTOR, gain_e_dn=1.0, bits=bits)
    frame = flat_field(9e4, detector)
    assert frame.dtype == np.uint16
    assert (frame == 2**bits - 1).all()


def test_nothing_goes_below_zero() -> None:
    detector = replace(DETECTOR, bias_dn=0.0, read_noise_e=200.0)
    frame = flat_field(0.0, detector)
    assert frame.min() == 0
    assert (frame == 0).mean() == pytest.approx(0.5, abs=0.05)  # half the noise is below
    assert frame.max() < 100


# Seeds


def test_the_same_exposure_gives_the_same_bits_and_any_other_does_not() -> None:
    mean = mean_electrons(flat(3e4), 1000.0, CAMERA, OPTICS, DETECTOR)

    def frame(*key: int) -> Image:
        return expose_electrons(mean, DETECTOR, exposure_rng(*key))

    first = frame(3, 7, 850)
    np.testing.assert_array_equal(first, frame(3, 7, 850))
    for other in ((4, 7, 850), (3, 8, 850), (3, 7, 800), (7, 3, 850), (3, 7, 850, 1)):
        # Independent draws of a normal with sigma s agree in one of about 3.5 s values.
        assert (frame(*other) == first).mean() < 0.1
        correlation = np.corrcoef(frame(*other).ravel(), first.ravel())[0, 1]
        assert abs(correlation) < 4.0 / np.sqrt(first.size)
