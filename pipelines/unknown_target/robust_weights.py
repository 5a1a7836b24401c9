"""How much a measurement counts that is far from where it was predicted."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Indices

OUTLIER = 10.0  # sigmas, by which a single sighting counts at most against its track
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


def of_tracks(sizes: Floats, who: Indices, gate: float) -> Floats:
    """Return (m,) weights by how well the whole life of each track is explained.

    A highlight that slides moves from image to image as a point does, and errs by a little in all
    of them: it is told by its whole life, not by any frame. What errs more than it states counts
    by what it errs; beyond the gate, in units of what most tracks err, it counts less and less.

    Parameters
    ----------
    sizes : (m,) array
        Lengths of errors in sigmas, of two numbers each.
    who : (m,) int array
        The track of each.
    gate : float
    """
    if not len(sizes) or not np.isfinite(gate):
        return np.ones(len(sizes))
    squares = np.where(np.isfinite(sizes), np.minimum(sizes, OUTLIER) ** 2, OUTLIER**2)
    seen = np.bincount(who)
    errs = np.sqrt(np.bincount(who, weights=squares) / np.maximum(2 * seen, 1))
    most = max(1.0, float(np.median(errs[seen > 0])))
    own = np.maximum(errs, 1.0)
    return np.asarray((weights(errs / most, gate) / own**2)[who])


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
    told = np.isfinite(sizes)
    if not told.any() or np.mean(sizes[told] < gate * narrow) > MOST:
        return weights(sizes, gate * narrow)
    return weights(sizes, gate * wide) / wide**2
