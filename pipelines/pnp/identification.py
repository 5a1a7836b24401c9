"""Which candidate is which marker: matching with the markers as a pose predicts them.

Opromolla et al. 2022, section 3.1.2, matches each candidate with the nearest reprojected marker
within a gate (equation 8). At 6.7 m that gate is 131 px, twice the least distance between markers:
two candidates may claim one marker, or one candidate stand nearest to a marker that is not its
own. One-to-one assignment of least total cost has neither fault.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment

from models.arrays import Floats, Indices, Mask

FORBIDDEN = 1e9  # cost of a pair outside its gate: dearer than all pairs inside together


def identification_gate_px(
    separation_m: float, range_m: float, focal_px: float, s_id: float
) -> float:
    """Return tau_id (equation 8), px.

    Parameters
    ----------
    separation_m : float, m
        Least distance between two markers.
    range_m : float, m
        Expected distance from camera to target, d_ig.
    focal_px : float, px
    s_id : float
    """
    return separation_m / range_m * focal_px * s_id


def nearest_neighbour(points_px: Floats, reprojected_px: Floats, gate_px: float) -> Indices:
    """Match every candidate with the nearest marker, as printed.

    Where several candidates claim one marker the nearest keeps it; the paper does not say.

    Parameters
    ----------
    points_px : (n, 2) array, px
    reprojected_px : (m, 2) array, px
        NaN for a marker that cannot be seen.
    gate_px : float, px

    Returns
    -------
    (n,) int array: the marker of each candidate, or -1.
    """
    matched = np.full(len(points_px), -1, dtype=np.int64)
    if len(points_px) == 0 or not np.isfinite(reprojected_px).any():
        return matched
    distance = np.linalg.norm(points_px[:, None] - reprojected_px[None, :], axis=-1)
    distance = np.where(np.isfinite(distance), distance, np.inf)
    nearest = np.argmin(distance, axis=1)
    gap = distance[np.arange(len(points_px)), nearest]
    for candidate in np.argsort(gap, kind="stable"):
        if gap[candidate] < gate_px and nearest[candidate] not in matched:
            matched[candidate] = nearest[candidate]
    return matched


def one_to_one(cost: Floats, allowed: Mask) -> Indices:
    """Match candidates and markers one to one: as many pairs as can be, at the least total cost.

    Parameters
    ----------
    cost : (n, m) array
        Of each pair, not negative, such as a squared distance in sigmas.
    allowed : (n, m) array of bool
        Which pairs lie within their gate.

    Returns
    -------
    (n,) int array: the marker of each candidate, or -1.
    """
    matched = np.full(cost.shape[0], -1, dtype=np.int64)
    if cost.size == 0 or not allowed.any():
        return matched
    priced = np.where(allowed, np.minimum(cost, 1e5), FORBIDDEN)
    candidates, markers = linear_sum_assignment(priced)
    good = priced[candidates, markers] < FORBIDDEN
    matched[candidates[good]] = markers[good]
    return matched
