"""The photon-transfer curve gives back what was put into the detector, within its own error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from models.arrays import Image
from models.camera import Camera
from models.sensors.camera_chip import Detector, Optics
from renders.detector.expose import expose_electrons, exposure_rng, mean_electrons
from tests.support.photon_transfer import Measured, PhotonTransfer, photon_transfer

CAMERA = Camera.from_fov(192, 192, 50.0)
OPTICS = Optics(psf_sigma_px=0.0, vignetting=False)
LEVELS_E = (0.0, 500.0, 2e3, 5e3, 1e4, 2e4, 4e4, 7e4)
FOUR_SIGMA = 4.0
ONE_IN_10_000 = 1e-4


def flat_field(electrons: float, detector: Detector, run: int) -> Image:
    """Return one evenly lit frame, through the whole chain."""
    rate = np.full((CAMERA.height, CAMERA.width), electrons, dtype=np.float32)
    mean = mean_electrons(rate, 1000.0, CAMERA, OPTICS, detector)
    return expose_electrons(mean, detector, exposure_rng(run, 0, 850))


def measured(detector: Detector, session: int = 0) -> PhotonTransfer:
    """Return the curve of pairs at every level, each frame with its own noise."""
    runs = 1000 * session + 2 * np.arange(len(LEVELS_E))
    pairs = [
        (flat_field(level, detector, int(run)), flat_field(level, detector, int(run) + 1))
        for level, run in zip(LEVELS_E, runs, strict=True)
    ]
    return photon_transfer(pairs, detector.bias_dn)


def pull(found: Measured, truth: float) -> float:
    return (found.value - truth) / found.sigma


DETECTORS = {
    "ours, finely converted": Detector(dark_current_e_s=0.0, gain_e_dn=6.0, bits=14),
    "scientific CMOS": Detector(
        dark_current_e_s=0.0, gain_e_dn=1.2, read_noise_e=1.6, prnu=0.01, bits=16
    ),
    "noisy and uneven": Detector(
        dark_current_e_s=0.0, gain_e_dn=20.0, read_noise_e=60.0, prnu=0.02, bits=12
    ),
}


@pytest.mark.parametrize("detector", DETECTORS.values(), ids=DETECTORS.keys())
def test_gain_read_noise_and_pixel_response_come_back(detector: Detector) -> None:
    curve = measured(replace(detector, full_well_e=1e6))
    assert abs(pull(curve.gain_e_dn, detector.gain_e_dn)) < FOUR_SIGMA
    assert abs(pull(curve.read_noise_e, detector.read_noise_e)) < FOUR_SIGMA
    # A pattern of so many pixels is itself known no better than sqrt(1 / 2n).
    drawn = detector.prnu / np.sqrt(2.0 * CAMERA.width * CAMERA.height)
    prnu = Measured(curve.prnu.value, float(np.hypot(curve.prnu.sigma, drawn)))
    assert abs(pull(prnu, detector.prnu)) < FOUR_SIGMA


def test_the_errors_it_states_are_the_errors_it_makes() -> None:
    """Over 24 sessions the pulls have the spread of a normal: neither wider nor narrower."""
    detector = replace(DETECTORS["ours, finely converted"], full_well_e=1e6)
    curves = [measured(detector, session) for session in range(1, 25)]
    for truth, name in ((6.0, "gain_e_dn"), (12.0, "read_noise_e")):
        pulls = np.array([pull(getattr(curve, name), truth) for curve in curves])
        low, high = chi2.ppf([ONE_IN_10_000, 1.0 - ONE_IN_10_000], len(pulls))
        assert low < (pulls**2).sum() < high, name


def test_the_pattern_grows_as_the_square_of_the_signal_and_noise_as_the_signal() -> None:
    curve = measured(Detector(prnu=0.02, dark_current_e_s=0.0, gain_e_dn=6.0, bits=14))
    bright = curve.mean_dn > 1000.0
    order = np.polyfit(np.log(curve.mean_dn[bright]), np.log(curve.pattern_dn2[bright]), 1)[0]
    assert order == pytest.approx(2.0, abs=0.02)  # 37 thousand pixels: 0.7 % a variance
    order = np.polyfit(np.log(curve.mean_dn[bright]), np.log(curve.variance_dn2[bright]), 1)[0]
    assert order == pytest.approx(1.0, abs=0.02)


def test_an_even_chip_shows_no_pattern() -> None:
    curve = measured(replace(DETECTORS["ours, finely converted"], prnu=0.0))
    assert curve.prnu.value < FOUR_SIGMA * curve.prnu.sigma
    assert 0.0 < curve.prnu.sigma < 1e-3


def test_our_own_converter_hides_the_read_noise_but_not_the_gain() -> None:
    """At 26 e/DN the 12 e of read noise are half a step: gain from the lit levels alone."""
    detector = Detector(dark_current_e_s=0.0)
    pairs = [
        (flat_field(level, detector, 50 + 2 * k), flat_field(level, detector, 51 + 2 * k))
        for k, level in enumerate(LEVELS_E[2:])
    ]
    curve = photon_transfer(pairs, detector.bias_dn)
    assert abs(pull(curve.gain_e_dn, 26.0)) < FOUR_SIGMA


def test_too_few_levels_and_saturated_ones_are_refused() -> None:
    detector = Detector(dark_current_e_s=0.0)
    pair = (flat_field(1e3, detector, 0), flat_field(1e3, detector, 1))
    with pytest.raises(ValueError, match="at 3 levels or more, got 2"):
        photon_transfer([pair, pair], 100.0)
    levels = (6e4, 8e4, 1.5e5, 2e5, 3e5)
    pairs = [
        (flat_field(level, detector, 2 * k), flat_field(level, detector, 2 * k + 1))
        for k, level in enumerate(levels)
    ]
    with pytest.raises(ValueError, match="leave out the levels at saturation"):
        photon_transfer(pairs, 100.0)
    stuck = np.full((8, 8), 4095, dtype=np.uint16)
    with pytest.raises(ValueError, match="frames that are equal at 3995 DN"):
        photon_transfer([pair, pair, (stuck, stuck)], 100.0)
