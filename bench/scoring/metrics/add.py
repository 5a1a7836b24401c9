"""ADD and ADD-S: how far, on average, the target's points are from where they should be."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from models.arrays import Floats
from models.pose import RigidTransform

USUAL_SHARES = (0.02, 0.05, 0.1)  # of the diameter; a tenth is the one that papers quote


def add(estimate: RigidTransform, truth: RigidTransform, points_in_target: Floats) -> float:
    """Return ADD, m: the mean distance of each point from itself at the true pose.

    Hinterstoisser et al. 2012, equation 7.

    Parameters
    ----------
    estimate, truth : RigidTransform
        ``cam_from_target``.
    points_in_target : (n, 3) array, m
    """
    apart = (estimate @ points_in_target) - (truth @ points_in_target)
    return float(np.linalg.norm(apart, axis=1).mean())


def add_s(estimate: RigidTransform, truth: RigidTransform, points: KDTree) -> float:
    """Return ADD-S (ADI), m: the mean distance of each true point from the nearest estimated one.

    Hinterstoisser et al. 2012, equation 8. Distances do not change with the frame that they are
    measured in, so that one tree, of the target as drawn, serves all poses.

    Parameters
    ----------
    estimate, truth : RigidTransform
        ``cam_from_target``.
    points : KDTree
        Of the target's points, target frame, m.
    """
    target_at_estimate_from_cam = estimate.inverse()
    moved = target_at_estimate_from_cam @ (truth @ np.asarray(points.data))
    return float(np.mean(points.query(moved)[0]))
