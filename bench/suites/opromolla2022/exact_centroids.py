"""What a run's draws alone do to a pose: solved from exact centroids, for many runs at once.

Beside a pipeline's errors this tells how much of them is the calibration's, the survey's, or the
small number of runs, and how much the images'.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.pose import RigidTransform, pose_error
from pipelines.chaser_fixed.options import options_for
from pipelines.pnp.batched_levenberg_marquardt import solve_poses

SOLVER = options_for("best").solver
LEAST = 3


def errors_of_exact_centroids(
    cameras: Sequence[Camera],
    points_in_target: Floats,
    markers_px: Floats,
    seen: Mask,
    truth: RigidTransform,
) -> Floats:
    """Solve one frame in all runs from where its markers truly are.

    Parameters
    ----------
    cameras : sequence of Camera
        As told, run by run.
    points_in_target : (runs, n, 3) array, m
        As told.
    markers_px : (n, 2) array, px
        True projections of the markers' centres.
    seen : (n,) array of bool
    truth : RigidTransform
        ``cam_from_target``, from which the search starts.

    Returns
    -------
    (runs, 6) array, m and deg
        Errors of t and of (alpha, beta, gamma); NaN where fewer than three markers are seen.
    """
    count = len(cameras)
    if seen.sum() < LEAST:
        return np.full((count, 6), np.nan)
    found = solve_poses(
        np.ascontiguousarray(points_in_target[:, seen]),
        np.array([camera.normalise(markers_px[seen]) for camera in cameras]),
        np.repeat(truth.rotation[None], count, axis=0),
        np.repeat(truth.translation[None], count, axis=0),
        SOLVER,
    )
    errors = [
        pose_error(RigidTransform(_orthonormal(rotation), translation), truth)
        for rotation, translation in zip(found.rotations, found.translations, strict=True)
    ]
    return np.array([[*each.position_m, *each.euler_deg] for each in errors])


def _orthonormal(rotation: Floats) -> Floats:
    left, _, right = np.linalg.svd(rotation)
    return np.asarray(left @ right)
