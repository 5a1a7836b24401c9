"""What the errors that are told before flight do to a pose: they are common to its points.

A focal length that is off moves every point, a survey error every frame's same marker: no residual
of three points shows it, and no averaging takes it off. With the solver's ``A = (J'WJ)^-1 J'W`` the
covariance of a pose is ``A S A'`` with S that of all points together.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from models.arrays import Floats
from models.camera import DISTORTION_ORDER, Camera
from models.pose import RigidTransform
from pipelines.pnp.projection_jacobian import jacobian_by_turn

CAMERA_STEPS = {"fx": 1e-3, "fy": 1e-3, "cx": 1e-3, "cy": 1e-3} | dict.fromkeys(
    DISTORTION_ORDER, 1e-6
)
"""Keys of a camera, and by how much each is moved to see what it does."""
PLACE = "markers.point_in_target_m"


def common_covariance_px2(
    camera: Camera, points_in_target: Floats, pose: RigidTransform, sigmas: Mapping[str, float]
) -> Floats:
    """Return the covariance of the projections of points by what is told to be uncertain.

    Parameters
    ----------
    camera : Camera
    points_in_target : (n, 3) array, m
    pose : RigidTransform
        ``cam_from_target``.
    sigmas : mapping of str to float
        As on board: ``camera.fx`` and so on, and ``markers.point_in_target_m``.

    Returns
    -------
    (2 n, 2 n) array, px^2
        In the order u, v of the first, u, v of the second.
    """
    count = len(points_in_target)
    in_cam = pose @ points_in_target
    common = np.zeros((2 * count, 2 * count))
    for key, step in CAMERA_STEPS.items():
        sigma = sigmas.get(f"camera.{key}", 0.0)
        if sigma > 0.0:
            value = float(getattr(camera, key))
            low, high = _with(camera, key, value - step), _with(camera, key, value + step)
            moved = (high.project(in_cam) - low.project(in_cam)).reshape(-1) / (2.0 * step)
            common += sigma**2 * np.outer(moved, moved)
    for index, own in enumerate(place_covariance_px2(camera, points_in_target, pose, sigmas)):
        rows = slice(2 * index, 2 * index + 2)
        common[rows, rows] += own
    return common


def place_covariance_px2(
    camera: Camera, points_in_target: Floats, pose: RigidTransform, sigmas: Mapping[str, float]
) -> Floats:
    """Return the covariance of each projection by where its point was surveyed, (n, 2, 2), px^2.

    Parameters
    ----------
    camera : Camera
    points_in_target : (n, 3) array, m
    pose : RigidTransform
    sigmas : mapping of str to float
    """
    by_place = _by_place(camera, points_in_target, pose)
    return np.asarray(sigmas.get(PLACE, 0.0) ** 2 * by_place @ by_place.transpose(0, 2, 1))


def _with(camera: Camera, key: str, value: float) -> Camera:
    changes: dict[str, Any] = {key: value}
    return replace(camera, **changes)


def _by_place(camera: Camera, points_in_target: Floats, pose: RigidTransform) -> Floats:
    """Return how projections move with their points, (n, 2, 3), px/m."""
    jacobian = jacobian_by_turn(pose.rotation, pose.translation, points_in_target)
    focal = np.array([[camera.fx], [camera.fy]])
    return np.asarray(focal * jacobian[:, :, 3:] @ pose.rotation)


def with_common_errors(
    camera: Camera,
    points_in_target: Floats,
    pose: RigidTransform,
    covariance_px2: Floats,
    sigmas: Mapping[str, float],
) -> Floats:
    """Return the covariance of a pose from points with noise of their own and common errors.

    Parameters
    ----------
    camera : Camera
    points_in_target : (n, 3) array, m
    pose : RigidTransform
    covariance_px2 : (n, 2, 2) array, px^2
        Of each point's own noise, by which the solver weighed it.
    sigmas : mapping of str to float

    Returns
    -------
    (6, 6) array, rad and m
    """
    count = len(points_in_target)
    focal = np.array([[camera.fx], [camera.fy]])
    jacobian = focal * jacobian_by_turn(pose.rotation, pose.translation, points_in_target)
    weights = np.linalg.inv(covariance_px2)
    pull = np.einsum("nia,nij->naj", jacobian, weights)
    information = np.einsum("naj,njb->ab", pull, jacobian)
    own = np.linalg.inv(information)
    gain = own @ pull.transpose(1, 0, 2).reshape(6, 2 * count)
    common = common_covariance_px2(camera, points_in_target, pose, sigmas)
    total = own + gain @ common @ gain.T
    return np.asarray(0.5 * (total + total.T))
