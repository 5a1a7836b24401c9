"""The Cramer-Rao bound of a pose from point measurements, and how near a pipeline comes to it.

**Idea.** With independent Gaussian errors (sigma_u, sigma_v) on the centroids of known points, no
unbiased estimator has a covariance below ``(sum_i J_i^T S^-1 J_i)^-1``, J_i being the derivative
of point i's pixel by the pose and S = diag(sigma_u^2, sigma_v^2) (Kay 1993, section 3.8).

**Efficiency** is the root mean square error over the root mean trace of that bound, 1 for a
perfect solver: it takes the geometry, the range and the noise of the image processing out of the
number and leaves the solver's own losses, and biases.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from models.arrays import Floats
from models.camera import Camera
from models.pose import RigidTransform

MIN_POINTS = 3
STEP_M = 1e-6  # central differences: rounding and curvature both below 1e-8 of the derivative
WORST_CONDITION = 1e14


@dataclass(frozen=True)
class Efficiency:
    """Root mean square error over the Cramer-Rao bound.

    Attributes
    ----------
    position, attitude : float
        1 is the best that an unbiased estimator can do.
    frames : int
        Estimates over which it is taken: those with a bound (three markers or more, noise above
        zero).
    """

    position: float | None
    attitude: float | None
    frames: int


def pixel_jacobian(camera: Camera, points_in_target: Floats, pose: RigidTransform) -> Floats:
    """Return d(pixel)/d(pose).

    The pose is perturbed as in ``RigidTransform.perturbed``, rotation first:
    ``dp_in_cam = w x (R x_in_target) + dt``.

    Parameters
    ----------
    camera : Camera
    points_in_target : (n, 3) array, m
    pose : RigidTransform
        ``cam_from_target``.

    Returns
    -------
    (n, 2, 6) array, px/rad and px/m
    """
    turned = pose.rotate(points_in_target)
    points_in_cam = turned + pose.translation
    steps = STEP_M * np.eye(3)
    pixel_by_point = np.stack(
        [
            (camera.project(points_in_cam + step) - camera.project(points_in_cam - step))
            / (2.0 * STEP_M)
            for step in steps
        ],
        axis=-1,
    )
    point_by_rotation = np.cross(np.eye(3)[None, :, :], turned[:, None, :]).swapaxes(1, 2)
    return np.concatenate([pixel_by_point @ point_by_rotation, pixel_by_point], axis=-1)


def pose_bound(
    camera: Camera, points_in_target: Floats, pose: RigidTransform, sigma_px: ArrayLike
) -> Floats | None:
    """Return the smallest covariance that an unbiased estimator can have.

    Parameters
    ----------
    camera : Camera
        As it really is.
    points_in_target : (n, 3) array, m
        The points used.
    pose : RigidTransform
        The true ``cam_from_target``.
    sigma_px : (2,) array, px
        1-sigma of the centroids in u and v.

    Returns
    -------
    (6, 6) array, rad and m, rotation first, in the camera's axes; None where the points do not
    fix a pose or the noise is zero.
    """
    sigma = np.asarray(sigma_px, dtype=np.float64)
    if len(points_in_target) < MIN_POINTS or not (sigma > 0.0).all():
        return None
    jacobian = (pixel_jacobian(camera, points_in_target, pose) / sigma[:, None]).reshape(-1, 6)
    information = jacobian.T @ jacobian
    if not np.isfinite(information).all() or np.linalg.cond(information) > WORST_CONDITION:
        return None
    return np.asarray(np.linalg.inv(information), dtype=np.float64)


def efficiency(errors: Sequence[Floats], bounds: Sequence[Floats | None]) -> Efficiency:
    """Compare errors with their bounds.

    Parameters
    ----------
    errors : sequence of (6,) arrays, rad and m
        Rotation vector, then position.
    bounds : sequence of (6, 6) arrays or None
        Each error's own bound; an error without one is left out.
    """
    pairs = [(e, b) for e, b in zip(errors, bounds, strict=True) if b is not None]
    if not pairs:
        return Efficiency(None, None, 0)
    squares = np.sort(np.array([error * error for error, _ in pairs]), axis=0).sum(axis=0)
    variances = np.sort(np.array([np.diag(bound) for _, bound in pairs]), axis=0).sum(axis=0)
    return Efficiency(
        position=float(np.sqrt(squares[3:].sum() / variances[3:].sum())),
        attitude=float(np.sqrt(squares[:3].sum() / variances[:3].sum())),
        frames=len(pairs),
    )
