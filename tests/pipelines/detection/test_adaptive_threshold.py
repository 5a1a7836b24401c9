from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arrays import Floats
from pipelines.detection.adaptive_threshold import (
    above_threshold,
    adaptive_threshold,
    ceil_odd,
    without_holes,
)

ROUNDING = 2e-6  # of a mean of float32 levels in [0, 1]


def naive_threshold(grey: Floats, window: tuple[int, int], sensitivity: float) -> Floats:
    """MATLAB's adaptthresh for a bright foreground, pixel by pixel as its page states it."""
    across, down = window[0] // 2, window[1] // 2
    padded = np.pad(grey, ((down, down), (across, across)), mode="edge")
    threshold = np.empty_like(grey)
    for row in range(grey.shape[0]):
        for column in range(grey.shape[1]):
            around = padded[row : row + window[1], column : column + window[0]]
            threshold[row, column] = (0.6 + (1.0 - sensitivity)) * around.mean()
    return np.clip(threshold, 0.0, 1.0)


@given(
    seed=st.integers(0, 1000),
    across=st.integers(0, 6),
    down=st.integers(0, 6),
    sensitivity=st.floats(0.0, 1.0),
)
def test_equals_the_formula_written_out(
    seed: int, across: int, down: int, sensitivity: float
) -> None:
    grey = np.random.default_rng(seed).random((11, 9)).astype(np.float32)
    window = (2 * across + 1, 2 * down + 1)
    found = adaptive_threshold(grey, window, sensitivity)
    assert found == pytest.approx(naive_threshold(grey, window, sensitivity), abs=ROUNDING)


@pytest.mark.parametrize(
    ("value", "expected"), [(0.2, 1), (1.0, 1), (1.1, 3), (35.3, 37), (36.0, 37), (37.0, 37)]
)
def test_windows_are_the_least_odd_number_that_is_not_smaller(value: float, expected: int) -> None:
    assert ceil_odd(value) == expected


def disc_on_black(level: float, radius: float) -> Floats:
    v, u = np.mgrid[0:101, 0:101] - 50
    return np.where(np.hypot(u, v) < radius, level, 0.05).astype(np.float32)


def test_a_disc_as_wide_as_the_window_gets_a_hole_and_is_made_whole() -> None:
    grey = disc_on_black(0.7, 20.0)
    window = ceil_odd(1.9 * 20.0), ceil_odd(1.9 * 20.0)
    foreground = above_threshold(grey, adaptive_threshold(grey, window, 0.3))
    assert not foreground[50, 50]
    assert np.array_equal(without_holes(foreground, np.pi * 20.0**2), grey > 0.5)


def test_a_saturated_disc_does_not_vanish() -> None:
    grey = disc_on_black(1.0, 20.0)
    foreground = above_threshold(grey, adaptive_threshold(grey, (41, 41), 0.3))
    assert np.array_equal(foreground, grey >= 1.0)


def test_a_board_in_a_bright_surround_is_no_hole_to_be_filled() -> None:
    foreground = np.ones((60, 60), dtype=bool)
    foreground[10:50, 10:50] = False  # a black board
    foreground[25:31, 25:31] = True  # with a dot on it,
    foreground[27:29, 27:29] = False  # which has a hole
    filled = without_holes(foreground, most_px=40.0)
    assert filled[27:29, 27:29].all()
    assert not filled[12, 12]
