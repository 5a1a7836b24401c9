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
from pipelines.pnp.gauss_newton import gauss_newton_step, linearised

STEPS = 6  # from the truth, a hundredth of a degree off, one would nearly do
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
    observed = np.array([camera.normalise(markers_px[seen]).T for camera in cameras])
    points = points_in_target[:, seen]
    weights = np.ones((count, int(seen.sum())))
    rotations = np.repeat(truth.rotation[None], count, axis=0)
    translations = np.repeat(truth.translation[None], count, axis=0)
    for _ in range(STEPS):
        linear = linearised(rotations, translations, points)
        rotations, translations, _ = gauss_newton_step(
            rotations, translations, linear, observed, weights
        )
    found = [
        pose_error(RigidTransform(_orthonormal(rotation), translation), truth)
        for rotation, translation in zip(rotations, translations, strict=True)
    ]
    return np.array([[*each.position_m, *each.euler_deg] for each in found])


def _orthonormal(rotation: Floats) -> Floats:
    left, _, right = np.linalg.svd(rotation)
    return np.asarray(left @ right)
