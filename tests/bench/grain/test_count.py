"""Grain is counted in the detector's own sigmas, and bias is told of frames and of tiles."""

from __future__ import annotations

import numpy as np
import pytest

from bench.grain.count import Detector, grain
from bench.grain.rows import TILE_PX, pixels_of, tiles_of

CHIP = Detector(read_noise_e=12.0, full_well_e=1e5)
SHAPE = (8, 32, 32)
SHARE = 5e-3  # three standard errors of a share of 8192 pixels


def test_gaussian_noise_of_one_sigma_is_found_as_such() -> None:
    truth = np.full(SHAPE, 2000.0)
    noise = np.random.default_rng(0).normal(size=SHAPE) * CHIP.sigma_e(truth)
    found = grain(truth + noise, truth, CHIP)
    assert found.above[0] == pytest.approx(0.3173, abs=3 * SHARE)
    assert found.above[1] == pytest.approx(0.0027, abs=SHARE)
    assert found.above[2] == 0.0
    assert found.rms == pytest.approx(1.0, abs=0.03)
    assert found.lit == truth.size


def test_the_detector_adds_shot_read_and_one_percent() -> None:
    assert CHIP.sigma_e(np.array(1e4)) == pytest.approx(np.sqrt(1e4 + 144.0 + 1e4))


def test_dark_pixels_are_not_counted_and_full_ones_are_clipped() -> None:
    truth = np.full(SHAPE, 5.0)
    truth[0] = 3e5
    frame = truth.copy()
    frame[0] *= 2.0
    frame[1] += 1000.0
    found = grain(frame, truth, CHIP)
    assert found.lit == TILE_PX**2
    assert found.above == (0.0, 0.0, 0.0)


def test_one_wrong_tile_is_told_beside_the_frame() -> None:
    truth = np.full(SHAPE, 1000.0)
    frame = truth.copy()
    frame[3] *= 1.1
    found = grain(frame, truth, CHIP)
    assert found.worst_tile == pytest.approx(0.1)
    assert found.frame_bias == pytest.approx(0.1 / 8)


def test_tiles_show_a_spacecraft_and_are_the_same_each_time() -> None:
    seen = np.zeros((512, 512), dtype=bool)
    seen[100:300, 64:448] = True
    tiles = tiles_of(seen)
    assert np.array_equal(tiles, tiles_of(seen))
    assert len(np.unique(tiles, axis=0)) == len(tiles) == 16
    pixels = pixels_of(tiles, 512)
    assert pixels.shape == (16, TILE_PX, TILE_PX)
    assert len(np.unique(pixels)) == pixels.size
    assert seen.ravel()[pixels].mean(axis=(1, 2)).min() > 0.3
