"""How much a measurement counts that is far from where it was predicted."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Indices

MOST = 0.5  # of measurements, which must agree to be believed against the rest
# Median length of a Gaussian vector of so many numbers, sigma 1.
MEDIANS = {1: 0.6745, 2: 1.1774}


def spread(sizes: Floats, numbers: int) -> float:
    """Return how many sigmas errors really have, at least 1: while all is wrong, none is false.

    Parameters
    ----------
    sizes : (m,) array
        Lengths of errors in sigmas; infinite ones do not count.
    numbers : int
        That each length is of.
    """
    finite = sizes[np.isfinite(sizes)]
    if finite.size == 0:
        return 1.0
    return max(1.0, float(np.median(finite)) / MEDIANS[numbers])


def weights(sizes: Floats, gate: float) -> Floats:
    """Return (m,) weights: 1 within the gate, beyond it falling with the fourth power.

    Parameters
    ----------
    sizes : (m,) array
        Lengths of errors in sigmas; an infinite one has no weight.
    gate : float
    """
    return np.asarray((gate / np.maximum(sizes, gate)) ** 4, dtype=np.float64)


def of_most(sizes: Floats, numbers: int, gate: float, opened: float) -> Floats:
    """Return (m,) weights by gates as wide as errors are, but no wider than ``opened``.

    Where less than half would pass, gates stay as wide as errors are, and all counts for less.

    Parameters
    ----------
    sizes : (m,) array
        Lengths of errors in sigmas.
    numbers : int
        That each length is of.
    gate : float
    opened : float
        In units of the gate.
    """
    wide = spread(sizes, numbers)
    narrow = min(wide, opened)
    if not len(sizes) or np.mean(sizes < gate * narrow) > MOST:
        return weights(sizes, gate * narrow)
    return weights(sizes, gate * wide) / wide**2


def medians(sizes: Floats, who: Indices, points: int) -> Floats:
    """Return each point's median error over what is usual, (n,); zero of one that was not seen.

    Parameters
    ----------
    sizes : (m,) array
        Lengths of errors of pixels in sigmas.
    who : (m,) int array
        The point of each.
    points : int
    """
    usual = MEDIANS[2] * spread(sizes, 2)
    order = np.lexsort((sizes, who))
    count = np.bincount(who, minlength=points)
    first = np.cumsum(count) - count
    found = np.zeros(points)
    there = count > 0
    middle = first[there] + count[there] // 2
    found[there] = sizes[order][middle] / usual
    return found
