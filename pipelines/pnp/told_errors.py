"""What the errors that are told before flight do to a pose: they are common to its points.

A focal length that is off moves every point, a survey error every frame's same marker: no residual
of three points shows it, and no averaging takes it off. With the solver's ``A = (J'WJ)^-1 J'W`` the
covariance of a pose is ``A S A'`` with S that of all points together.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from models.arrays import Floats
from models.camera import DISTORTION_ORDER, Camera
from models.pose import RigidTransform
from pipelines.pnp.projection_jacobian import jacobian_by_turn

CALIBRATION = ("fx", "fy", "cx", "cy", *DISTORTION_ORDER)
"""Keys of a camera that a calibration may have wrong."""
PLACE = "markers.point_in_target_m"
CLOCK_OFFSET, CLOCK_DRIFT = "frames.offset_s", "frames.drift_ppm"


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
    shared = calibration_errors_px(camera, in_cam[:, :2] / in_cam[:, 2:], sigmas)
    if shared is not None:
        moved = shared.reshape(2 * count, -1)
        common += moved @ moved.T
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


def calibration_errors_px(
    camera: Camera, ideal: Floats, sigmas: Mapping[str, float]
) -> Floats | None:
    """Return what one sigma of each number of a calibration does to points, (n, 2, k) px.

    None where nothing of it is told to be uncertain.

    Parameters
    ----------
    camera : Camera
    ideal : (n, 2) array
        Undistorted normalised coordinates.
    sigmas : mapping of str to float
        As on board: ``camera.fx`` and so on.
    """
    told = {key: sigmas.get(f"camera.{key}", 0.0) for key in CALIBRATION}
    slopes = _calibration_slopes(camera, ideal)
    shared = [sigma * slopes[key] for key, sigma in told.items() if sigma > 0.0]
    return np.stack(shared, axis=-1) if shared else None


def _calibration_slopes(camera: Camera, ideal: Floats) -> dict[str, Floats]:
    """Return how points move with each number of a calibration, by its key, (n, 2) each.

    They are linear in each of them (Brown 1966, in OpenCV's order).
    """
    focal = np.array([camera.fx, camera.fy])
    x, y = ideal.T
    square = (ideal * ideal).sum(axis=1, keepdims=True)
    distorted = camera.distort(ideal)
    across, down = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    twist = 2.0 * x * y
    return {
        "fx": distorted * across,
        "fy": distorted * down,
        "cx": np.broadcast_to(across, ideal.shape),
        "cy": np.broadcast_to(down, ideal.shape),
        "k1": focal * ideal * square,
        "k2": focal * ideal * square**2,
        "p1": focal * np.stack([twist, square[:, 0] + 2.0 * y * y], axis=1),
        "p2": focal * np.stack([square[:, 0] + 2.0 * x * x, twist], axis=1),
        "k3": focal * ideal * square**3,
    }


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


def stamp_sigma_s(sigmas: Mapping[str, float], time_s: float) -> float:
    """Return the 1-sigma of the time that the clock on board stamps on a frame, s.

    Parameters
    ----------
    sigmas : mapping of str to float
        As on board: ``frames.offset_s`` and ``frames.drift_ppm``, of all time since zero.
    time_s : float, s

    Returns
    -------
    float, s
        0 where the clock is told to be exact.
    """
    drifted_s = 1e-6 * sigmas.get(CLOCK_DRIFT, 0.0) * time_s
    return float(np.hypot(sigmas.get(CLOCK_OFFSET, 0.0), drifted_s))
