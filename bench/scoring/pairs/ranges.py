"""Bins of range, so that far and near are not averaged away."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats

STEPS_M = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
MOST_BINS = 12


def range_bins(range_m: Floats) -> list[tuple[float, float]]:
    """Return round bin edges [near, far) in m that hold all ranges: at most twelve bins.

    Parameters
    ----------
    range_m : (n,) array, m
    """
    if len(range_m) == 0:
        return []
    nearest, farthest = float(np.min(range_m)), float(np.max(range_m))
    for step in STEPS_M:
        first, last = _bin_of(nearest, step), _bin_of(farthest, step)
        if last - first < MOST_BINS:
            break
    return [(round(k * step, 6), round((k + 1) * step, 6)) for k in range(first, last + 1)]


def _bin_of(range_m: float, step_m: float) -> int:
    """Return the number of the bin whose rounded edges hold a range: 0.3 is no 2.9999 tenths."""
    number = int(range_m // step_m)
    return number + (round((number + 1) * step_m, 6) <= range_m)
