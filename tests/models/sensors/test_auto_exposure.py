"""Automatic exposure as a camera does it: from the last image alone, in bounded steps."""

from __future__ import annotations

import inspect
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arrays import Image
from models.sensors.auto_exposure import AT_SATURATION, AutoExposure
from models.sensors.camera_chip import Detector

METER = AutoExposure()
DETECTOR = Detector()
SPAN = DETECTOR.saturation_dn - DETECTOR.bias_dn
SIDE = 100


def image_of(rate_dn_ms: float, exposure_ms: float, lit: float = 0.01) -> Image:
    """Return an image without noise: a share of its pixels has so many DN a millisecond."""
    level = min(DETECTOR.bias_dn + rate_dn_ms * exposure_ms, DETECTOR.saturation_dn)
    image = np.full(SIDE * SIDE, round(DETECTOR.bias_dn), dtype=np.uint16)
    image[: round(lit * image.size)] = round(level)
    return image.reshape(SIDE, SIDE)


def exposures(
    rates_dn_ms: list[float], first_ms: float, meter: AutoExposure = METER
) -> list[float]:
    """Return the exposure time of each image of a scene that shines with these rates."""
    found = [first_ms]
    for rate in rates_dn_ms[:-1]:
        found.append(meter.next_ms(found[-1], image_of(rate, found[-1]), DETECTOR))
    return found


@given(
    rate=st.floats(300.0, 1e5),
    first_ms=st.floats(0.05, 10.0),
)
def test_a_still_scene_comes_to_its_fill_and_stays(rate: float, first_ms: float) -> None:
    """Ten doublings span a factor of a thousand; rounding to whole DN is all that is left."""
    found = exposures([rate] * 14, first_ms)
    wanted = np.clip(METER.fill * SPAN / rate, METER.min_ms, METER.max_ms)
    one_dn = 1.0 / (METER.fill * SPAN)
    assert found[-1] == pytest.approx(wanted, rel=one_dn)
    assert found[-1] == pytest.approx(found[-2], rel=2.0 * one_dn)


@given(
    levels=st.lists(st.integers(0, 4095), min_size=1, max_size=40),
    exposure_ms=st.floats(0.01, 20.0),
    max_step=st.floats(1.01, 10.0),
)
def test_no_image_moves_it_further_than_a_step_or_out_of_its_range(
    levels: list[int], exposure_ms: float, max_step: float
) -> None:
    meter = replace(METER, max_step=max_step)
    image = np.array([levels], dtype=np.uint16)
    following = meter.next_ms(exposure_ms, image, DETECTOR)
    assert meter.min_ms <= following <= meter.max_ms
    rounding = 1.0 + 1e-12
    assert exposure_ms / max_step / rounding <= following <= exposure_ms * max_step * rounding


def test_a_saturated_image_halves_it_whatever_its_fill() -> None:
    """Cut off, a level does not say how bright it was: a deadbeat step of 0.6 would be a guess."""
    saturated = image_of(1e6, 1.0)
    assert METER.next_ms(1.0, saturated, DETECTOR) == 0.5
    bright = image_of(0.99 * AT_SATURATION * SPAN, 1.0)
    assert METER.next_ms(1.0, bright, DETECTOR) == pytest.approx(METER.fill / 0.97, rel=2e-3)


def test_glints_do_not_count_and_markers_do() -> None:
    """Half a permille of saturated pixels lie beyond the 99.9th percentile; two permille do not."""
    image = image_of(METER.fill * SPAN, 1.0, lit=0.02)
    flat = image.reshape(-1)
    flat[-5:] = DETECTOR.max_dn
    assert METER.next_ms(1.0, image, DETECTOR) == pytest.approx(1.0, rel=1e-3)
    flat[-20:] = DETECTOR.max_dn
    assert METER.next_ms(1.0, image, DETECTOR) == 0.5


@given(percentile=st.floats(1.0, 100.0), seed=st.integers(0, 1000))
def test_the_metered_level_is_numpys_percentile(percentile: float, seed: int) -> None:
    image = np.random.default_rng(seed).integers(0, 4096, (30, 41)).astype(np.uint16)
    expected = np.percentile(image, percentile, method="inverted_cdf")
    assert replace(METER, percentile=percentile).metered_dn(image) == expected


def test_on_an_approach_it_lags_by_one_frame() -> None:
    """Light grows as the inverse square; each image is brighter than metered by one frame's share.

    From 6.7 m to 1.8 m in 330 s at 5 Hz that is 1 % at most: no marker saturates.
    """
    range_m = np.linspace(6.7, 1.8, 1650)
    rates = 4e5 / range_m**2
    found = np.array(exposures(rates.tolist(), METER.fill * SPAN / rates[0]))
    fill = rates * found / SPAN
    behind = rates[1:] / rates[:-1]
    two_dn = 2.0 / (METER.fill * SPAN)
    np.testing.assert_allclose(fill[1:], METER.fill * behind, rtol=two_dn)
    assert fill.max() < 1.01 * METER.fill


def test_the_dark_lengthens_it_to_its_longest_and_no_further() -> None:
    found = exposures([0.0] * 20, 1.0)
    assert found[1:5] == [2.0, 4.0, 8.0, 16.0]
    assert set(found[5:]) == {METER.max_ms}


def test_it_is_told_nothing_but_the_last_image_and_what_is_calibrated() -> None:
    parameters = list(inspect.signature(AutoExposure.next_ms).parameters)
    assert parameters == ["self", "exposure_ms", "image", "detector"]
