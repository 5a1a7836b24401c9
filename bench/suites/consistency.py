"""Whether stated covariances fit the errors made, over the runs of a setting."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from models.arrays import AnyArray, Floats

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Consistency:
    """Whether stated covariances fit the errors made.

    Attributes
    ----------
    mean : float or None
        Mean over runs and frames of ``e' P^-1 e`` over its degrees of freedom: 1 if honest.
    bounds : list of 2 floats
        Where the mean over the runs at one instant falls 95 times in 100, for as many runs.
    inside : float or None
        Share of the instants at which it does.
    """

    mean: float | None
    bounds: list[float]
    inside: float | None


def consistency(squares: Floats, dof: int) -> Consistency:
    """Judge normalised squares, (runs, frames), NaN where there is none.

    Errors of one run are alike from frame to frame, those of different runs are not: so each
    instant is judged over the runs.
    """
    low, high = honest_band(len(squares), dof)
    whole = squares[:, np.isfinite(squares).all(axis=0)]
    if whole.size == 0:
        there = squares[np.isfinite(squares)]
        mean = float(there.mean() / dof) if there.size else None
        return Consistency(mean, [low, high], None)
    means = whole.mean(axis=0) / dof
    inside = float(np.mean((low <= means) & (means <= high)))
    return Consistency(float(np.nanmean(squares) / dof), [low, high], inside)


def honest_band(runs: int, dof: int) -> tuple[float, float]:
    """Return where an honest mean of NEES over its degrees of freedom falls 95 times in 100."""
    tail = 0.5 * (1.0 - CONFIDENCE)
    low, high = (float(chi2.ppf(p, dof * runs) / (dof * runs)) for p in (tail, 1.0 - tail))
    return low, high


def root_mean_square(errors: AnyArray) -> float | None:
    """Return the root mean square of what is not NaN; None of nothing.

    Parameters
    ----------
    errors : (...,) array
    """
    there = errors[np.isfinite(errors)]
    return float(np.sqrt(np.mean(there**2))) if there.size else None
