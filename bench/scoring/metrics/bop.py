"""The errors of the BOP benchmark: MSSD, MSPD and VSD, and the average recalls made of them.

Hodan et al. 2020, "BOP Challenge 2020 on 6D Object Localization", section 2.2. The thresholds are
those of table-top objects; for a spacecraft of 30 m a twentieth of its diameter is 1.5 m, which is
why ``recall`` has others beside them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.pose import RigidTransform

VSD_DELTA_M = 0.015  # a surface so far behind what the scene shows is still taken for visible
SHARES = tuple(round(0.05 * k, 2) for k in range(1, 11))  # of the diameter, and VSD's thresholds
MSPD_PX = tuple(5.0 * k for k in range(1, 11))
MSPD_WIDTH_PX = 640.0  # thresholds are of images so wide


def turns_alike(symmetries: Iterable[Floats]) -> list[Floats]:
    """Return the turns of a target that look alike, (3, 3) each: no turn, and its symmetries."""
    return [np.eye(3), *symmetries]


def mssd(
    estimate: RigidTransform,
    truth: RigidTransform,
    points_in_target: Floats,
    symmetries: Iterable[Floats] = (),
) -> float:
    """Return the maximum symmetry-aware surface distance, m.

    ``min over S of max over x of |estimate x - truth S x|``. A maximum over a solid's points is one
    over the corners of its convex hull, since the distance is convex in x.

    Parameters
    ----------
    estimate, truth : RigidTransform
        ``cam_from_target``.
    points_in_target : (n, 3) array, m
    symmetries : iterable of (3, 3) arrays
        Turns about the target frame's origin, no turn left out.
    """
    estimated = estimate @ points_in_target
    return min(
        float(np.linalg.norm(estimated - (truth @ (points_in_target @ turn.T)), axis=1).max())
        for turn in turns_alike(symmetries)
    )


def mspd(
    estimate: RigidTransform,
    truth: RigidTransform,
    points_in_target: Floats,
    camera: Camera,
    symmetries: Iterable[Floats] = (),
) -> float:
    """Return the maximum symmetry-aware projection distance, px.

    As ``mssd``, of projections. Points that the camera cannot project at the true pose are left
    out; one that it cannot project at the estimated pose alone makes the distance infinite.

    Parameters
    ----------
    estimate, truth : RigidTransform
        ``cam_from_target``.
    points_in_target : (n, 3) array, m
    camera : Camera
        As simulated.
    symmetries : iterable of (3, 3) arrays
    """
    estimated_px = camera.project(estimate @ points_in_target)
    least = np.inf
    for turn in turns_alike(symmetries):
        true_px = camera.project(truth @ (points_in_target @ turn.T))
        seen = np.isfinite(true_px).all(axis=1)
        apart_px = np.linalg.norm(estimated_px[seen] - true_px[seen], axis=1)
        farthest = float(np.where(np.isnan(apart_px), np.inf, apart_px).max(initial=0.0))
        least = min(least, farthest if seen.any() else np.inf)
    return float(least)


def vsd(
    estimated_m: Floats,
    true_m: Floats,
    scene_m: Floats,
    diameter_m: float,
    taus: Sequence[float] = SHARES,
    delta_m: float = VSD_DELTA_M,
) -> Floats:
    """Return the visible surface discrepancy for each of n tolerances, (n,): 0 right, 1 wrong.

    The share of pixels, of all where the target is visible at either pose, where it is visible at
    one alone or the two distances differ by ``tau`` or more. Distances are along the rays, 0 where
    nothing is met; where the scene shows nothing, the target hides behind nothing ("bop19").

    Parameters
    ----------
    estimated_m, true_m : (height, width) arrays, m
        To the target alone, at the two poses.
    scene_m : (height, width) array, m
        To what truly stood there.
    diameter_m : float, m
    taus : sequence of float
        Over the diameter.
    delta_m : float, m
    """
    true_seen = _visible(true_m, scene_m, delta_m)
    seen = _visible(estimated_m, scene_m, delta_m) | (true_seen & (estimated_m > 0.0))
    both, either = true_seen & seen, int((true_seen | seen).sum())
    if not either:
        return np.ones(len(taus))
    apart = np.abs(true_m[both] - estimated_m[both]) / diameter_m
    alone = either - int(both.sum())
    return np.array([(int((apart >= tau).sum()) + alone) / either for tau in taus])


def _visible(target_m: Floats, scene_m: Floats, delta_m: float) -> Mask:
    in_front = (target_m - scene_m <= delta_m) | (scene_m == 0.0)
    return np.asarray(in_front & (target_m > 0.0))


def vsd_recall(discrepancies: Floats) -> float:
    """Return one frame's share of (tolerance, threshold) pairs passed; (t,) of its tolerances."""
    return float((discrepancies[:, None] < np.array(SHARES)).mean())


def mssd_recall(distance_m: float, diameter_m: float) -> float:
    """Return one frame's share of thresholds passed."""
    return float((distance_m < diameter_m * np.array(SHARES)).mean())


def mspd_recall(distance_px: float, width_px: int) -> float:
    """Return one frame's share of thresholds passed, as if the image were 640 px wide."""
    return float((distance_px * MSPD_WIDTH_PX / width_px < np.array(MSPD_PX)).mean())
