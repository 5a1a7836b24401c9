"""What a corner's sigma rests on: its structure tensor and the noise, pixel by pixel."""

from __future__ import annotations

import numpy as np
import pytest

from models.arrays import Floats, Image
from models.sensors.camera_chip import Detector
from pipelines.detection import corners
from pipelines.detection.corners import corners_of, find_corners
from pipelines.detection.target_region import TargetRegion, _without_specks, find_target

DETECTOR = Detector()


def painted(low: tuple[int, int], high: tuple[int, int], size=(140, 170), dn=1500.0) -> Image:
    """Paint a lit rectangle on black, (height, width), between (x, y) corners."""
    image = np.full(size, DETECTOR.bias_dn)
    image[low[1] : high[1], low[0] : high[0]] += dn
    noise = 2.0 * np.random.default_rng(1).standard_normal(size)
    return np.clip(np.rint(image + noise), 0, 4095).astype(np.uint16)


def region(size: tuple[int, int], signal: float, sigma: float = 1.5) -> TargetRegion:
    shape = np.full(size, signal, dtype=np.float32)
    return TargetRegion(shape, np.arcsinh(shape / 6.0), shape > 0.0, sigma, 6.0, 0.0)


def tensors(smooth: Floats, column: int, row: int) -> Floats:
    """Scharr's slopes, in levels a pixel, summed over 9 by 9."""
    total = np.zeros((2, 2))
    for v in range(row - 4, row + 5):
        for u in range(column - 4, column + 5):
            weigh = np.array([3.0, 10.0, 3.0]) / 32.0
            gx = weigh @ (smooth[v - 1 : v + 2, u + 1] - smooth[v - 1 : v + 2, u - 1])
            gy = weigh @ (smooth[v + 1, u - 1 : u + 2] - smooth[v - 1, u - 1 : u + 2])
            total += np.outer([gx, gy], [gx, gy])
    return total


@pytest.mark.parametrize("detector", [None, DETECTOR])
def test_a_corners_sigma_is_its_tensors_inverse_times_the_noise(detector) -> None:
    rng = np.random.default_rng(2)
    smooth = rng.uniform(0.0, 3.0, (40, 50)).astype(np.float32)
    target = region(smooth.shape, 300.0)
    points = np.array([[20.3, 14.8], [30.6, 22.2]])
    sigma, clear = corners._noise_sigma(
        smooth, target, (slice(None), slice(None)), points, detector
    )
    noise_dn = 1.5 if detector is None else DETECTOR.noise_dn(np.array(300.0 + DETECTOR.bias_dn))
    local = 0.2 * noise_dn / np.hypot(300.0, 6.0)  # slopes of a smoothed arcsinh
    for own, (column, row) in zip(sigma, ((20, 15), (31, 22)), strict=True):
        inverse = np.linalg.inv(tensors(smooth, column, row))
        expected = np.hypot(np.sqrt(np.diag(inverse)) * local * 2.0, 0.1)
        np.testing.assert_allclose(own, expected, rtol=1e-4)
    assert clear.all()


def test_a_corner_stands_out_if_its_weaker_slope_is_eight_times_noises() -> None:
    """The smaller eigenvalue against 81 pixels of noise squared."""
    rng = np.random.default_rng(3)
    smooth = rng.uniform(0.0, 1.0, (40, 50)).astype(np.float32)
    smallest = np.linalg.eigvalsh(tensors(smooth, 25, 20))[0]
    whole, point = (slice(None), slice(None)), np.array([[25.0, 20.0]])
    at_limit = np.sqrt(smallest / (8.0 * 81.0)) / 0.2 * np.hypot(300.0, 6.0)
    for share, stands in ((0.99, True), (1.01, False)):
        target = region(smooth.shape, 300.0, sigma=share * at_limit)
        assert corners._noise_sigma(smooth, target, whole, point, None)[1].tolist() == [stands]


def test_points_at_the_rim_read_the_rims_pixels() -> None:
    smooth = np.random.default_rng(4).uniform(0.0, 1.0, (30, 34)).astype(np.float32)
    target = region(smooth.shape, 300.0)
    outside = np.array([[-0.7, 3.0], [33.6, 3.0], [5.0, 29.6], [5.0, -0.6]])
    inside = np.array([[0.0, 3.0], [33.0, 3.0], [5.0, 29.0], [5.0, 0.0]])
    whole = (slice(None), slice(None))
    np.testing.assert_array_equal(
        corners._noise_sigma(smooth, target, whole, outside, None)[0],
        corners._noise_sigma(smooth, target, whole, inside, None)[0],
    )


@pytest.mark.parametrize("low", [(3, 2), (40, 2), (3, 50), (60, 55)])
def test_corners_are_found_where_they_are_whatever_part_was_cut_out(low: tuple[int, int]) -> None:
    """Between pixel centres: edges of a rectangle of pixels lie half a pixel before them."""
    high = (low[0] + 60, low[1] + 50)
    found = find_corners(painted(low, high), DETECTOR)
    expected = np.array([[x - 0.5, y - 0.5] for x in (low[0], high[0]) for y in (low[1], high[1])])
    away = np.linalg.norm(found.points_px[:, None] - expected, axis=-1)
    near_rim = (expected < 8.0).any(axis=1)  # there the refinement's window is cut
    assert (away.min(axis=0)[~near_rim] < 0.35).all()
    assert (away.min(axis=1)[:, None] < 2.0).all()
    assert (found.sigma_px >= 0.1).all()


def test_no_target_no_corner_and_too_small_a_one_neither() -> None:
    dark = np.full((60, 60), int(DETECTOR.bias_dn), np.uint16)
    none = find_corners(dark, DETECTOR)
    assert len(none) == 0
    assert none.points_px.shape == none.sigma_px.shape == (0, 2)
    small = find_target(painted((0, 0), (60, 11), size=(12, 60)), DETECTOR)
    assert small
    assert len(corners_of(small, DETECTOR)) == 0  # 9 + 4 rows are the least


def test_the_sky_is_what_most_of_the_image_is_and_its_noise_what_lies_below() -> None:
    """Level by the median, sigma by the half below it; the stretch is linear to four sigmas."""
    rng = np.random.default_rng(5)
    image = 400.0 + 7.0 * rng.standard_normal((150, 150))
    image[40:90, 50:110] += 800.0
    target = find_target(np.rint(image).astype(np.uint16))
    assert target.sky_sigma_dn == pytest.approx(7.0, rel=0.1)
    assert target.knee_dn == 4.0 * target.sky_sigma_dn
    assert float(np.median(target.signal[:30])) == pytest.approx(0.0, abs=1.0)
    np.testing.assert_allclose(target.stretched, np.arcsinh(target.signal / target.knee_dn))
    lit = np.zeros(target.lit.shape, bool)
    lit[40:90, 50:110] = True
    assert target.lit[lit].all()
    lit[36:94, 46:114] = True  # so far the smoothing carries 800 DN above five of its sigmas
    assert not target.lit[~lit].any()
    assert target.saturated == 0.0


def test_saturation_is_counted_among_what_is_lit() -> None:
    image = painted((40, 40), (80, 80))
    image[40:80, 40:50] = DETECTOR.saturation_dn
    target = find_target(image, DETECTOR)
    assert target.saturated == pytest.approx(400.0 / target.lit.sum(), rel=1e-6)


@pytest.mark.parametrize(("side", "size", "seen"), [(10, 200, 0), (11, 200, 1), (11, 700, 0)])
def test_a_target_covers_120_pixels_at_least_and_3e_4_of_the_image(side, size, seen) -> None:
    shining = np.zeros((size, size), bool)
    shining[50 : 50 + side, 50 : 50 + side] = True
    assert _without_specks(shining).sum() == seen * side**2


def test_what_the_dark_cuts_off_is_the_targets_and_a_speck_is_not() -> None:
    """Parts of 2 % of the largest one, and twelve pixels, are kept."""
    shining = np.zeros((200, 200), bool)
    shining[50:110, 50:110] = True
    for side, kept in ((8, False), (10, True)):  # 64 and 100 against 84
        with_part = shining.copy()
        with_part[150 : 150 + side, 150 : 150 + side] = True
        assert _without_specks(with_part)[155, 155] == kept
