"""Exposures made one: linear from the dark to beyond a saturated glint, and as noisy as it says."""

from __future__ import annotations

import numpy as np
import pytest

from models.arrays import Floats
from models.errors import DatasetError
from models.frame import ImageReading
from models.sensors.camera_chip import Detector
from pipelines.detection.exposure_fusion import FusedExposures, fused_exposures

DETECTOR = Detector()
FACTORS = (0.25, 1.0, 4.0)
METERED_MS = 2.0
SHAPE = (64, 64)
SCATTER = 0.05  # of a sigma from 4096 pixels: three times 1 / sqrt(2 n)
BIAS_SIGMAS = 0.1  # of a mean: six times 1 / sqrt(4096)


def taken(rate_dn_ms: Floats, exposure_ms: float, seed: int) -> ImageReading:
    """Return an exposure: Poisson numbers, read noise, the full well and rounding."""
    rng = np.random.default_rng(seed)
    electrons = rng.poisson(np.maximum(rate_dn_ms, 0.0) * exposure_ms * DETECTOR.gain_e_dn)
    electrons = np.minimum(electrons, DETECTOR.full_well_e)
    electrons = electrons + DETECTOR.read_noise_e * rng.standard_normal(rate_dn_ms.shape)
    image = np.rint(electrons / DETECTOR.gain_e_dn + DETECTOR.bias_dn)
    return ImageReading(np.clip(image, 0, DETECTOR.max_dn).astype(np.uint16), 0.0, exposure_ms)


def fused(level_dn: float, factors: tuple[float, ...] = FACTORS) -> tuple[FusedExposures, float]:
    """Return a field of so many DN in the metered exposure, fused, and the expected signal."""
    rate = np.full(SHAPE, level_dn / METERED_MS)
    readings = [taken(rate, f * METERED_MS, k) for k, f in enumerate(factors)]
    return fused_exposures(readings, DETECTOR), level_dn * max(factors)


@pytest.mark.parametrize("level_dn", [0.0, 0.5, 20.0, 800.0, 3000.0, 12_000.0])
def test_it_is_linear_and_as_noisy_as_it_says(level_dn: float) -> None:
    """12000 DN of the metered exposure are three times its full well: the shortest alone tells."""
    one, expected = fused(level_dn)
    signal = one.image.astype(float) - DETECTOR.bias_dn
    sigma = float(one.sigma_dn.mean())
    assert abs(signal.mean() - expected) < BIAS_SIGMAS * sigma
    rounded = float(np.hypot(sigma, np.sqrt(1.0 / 12.0)))  # once more, unless one tells it all
    assert (1.0 - SCATTER) * sigma < signal.std() < (1.0 + SCATTER) * rounded
    assert not one.saturated.any()


def test_the_dark_is_less_noisy_than_in_the_metered_exposure() -> None:
    one, _ = fused(2.0)
    metered_dn = float(DETECTOR.noise_dn(np.array([DETECTOR.bias_dn + 2.0]))[0])
    assert one.sigma_dn.mean() / max(FACTORS) < 0.5 * metered_dn


def test_what_saturates_in_all_is_told_and_is_the_brightest() -> None:
    one, _ = fused(60_000.0)
    assert one.saturated.all()
    assert (one.image >= one.detector.saturation_dn - 1.0).all()
    dim, _ = fused(12_000.0)
    assert dim.image.max() < one.image.min()


def test_the_detector_it_is_taken_as_has_its_ends() -> None:
    one, _ = fused(10.0)
    assert one.exposure_ms == 4.0 * METERED_MS
    span = DETECTOR.saturation_dn - DETECTOR.bias_dn
    assert one.detector.saturation_dn == pytest.approx(DETECTOR.bias_dn + 16.0 * span)
    level = np.array([DETECTOR.bias_dn])
    assert one.detector.noise_dn(level) == pytest.approx(DETECTOR.noise_dn(level))


def test_the_order_does_not_matter_and_one_exposure_is_itself() -> None:
    rate = np.full(SHAPE, 30.0)
    readings = [taken(rate, f * METERED_MS, k) for k, f in enumerate(FACTORS)]
    one, other = (fused_exposures(each, DETECTOR) for each in (readings, readings[::-1]))
    np.testing.assert_array_equal(one.image, other.image)
    alone = fused_exposures(readings[1:2], DETECTOR)
    np.testing.assert_array_equal(alone.image, readings[1].image)


@pytest.mark.parametrize(
    ("factors", "said"), [((), "got none"), ((0.1, 4.0), "within a ratio of 17"), ((0.0,), "0 ms")]
)
def test_what_cannot_be_made_one_is_refused(factors: tuple[float, ...], said: str) -> None:
    image = np.full(SHAPE, 200, dtype=np.uint16)
    with pytest.raises(DatasetError, match=said):
        fused_exposures([ImageReading(image, 0.0, 2.0 * f) for f in factors], DETECTOR)
