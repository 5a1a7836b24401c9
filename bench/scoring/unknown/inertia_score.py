"""An inertia up to its scale, held against the true one: principal axes, and ratios."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats


@dataclass(frozen=True)
class InertiaScore:
    """An inertia against the true one.

    Attributes
    ----------
    axes_deg : list of float
        Angle between the principal axes of either, from the smallest true moment to the largest.
        Where two moments are nearly alike, their axes are nobody's.
    moments_percent : list of float
        Error of each principal moment, of the true one, both of trace 1.
    entries_percent : float
        Largest error of an entry, of the trace.
    """

    axes_deg: list[float]
    moments_percent: list[float]
    entries_percent: float


def inertia_score(own: Floats, true: Floats) -> InertiaScore:
    """Hold an inertia against the true one.

    Parameters
    ----------
    own : (3, 3) array
        True axes, as it is said: of trace 1.
    true : (3, 3) array
        Of any scale.
    """
    true = true / np.trace(true)
    (own_moments, own_axes), (moments, axes) = np.linalg.eigh(own), np.linalg.eigh(true)
    cosines = np.clip(np.abs(np.sum(own_axes * axes, axis=0)), 0.0, 1.0)
    return InertiaScore(
        np.rad2deg(np.arccos(cosines)).tolist(),
        (100.0 * np.abs(own_moments / moments - 1.0)).tolist(),
        float(100.0 * np.abs(own - true).max()),
    )
