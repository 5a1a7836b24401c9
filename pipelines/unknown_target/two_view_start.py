"""A first guess of how a target turns: from two images far enough apart, whatever it is.

Five points in two images tell how a body turned between them, and in which direction it moved
(Nistér 2004); of many tracks that turn which most agree with is taken. Over that time the rate is
taken as constant, which a tumbling body's is not, and the guess says so by its sigma.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats, Indices
from models.camera import Camera
from models.motion.gravity_gradient_rotation import lvlh_from_first
from pipelines.unknown_target.tracked_frame import TrackedFrame

FEWEST = 25  # tracks that both images must show
AGREEING = 0.5  # of them
LEAST_TURN_DEG = 15.0
THRESHOLD_PX = 1.0
CONFIDENCE, MOST_DRAWS, SEED = 0.9999, 5000, 1
LEAST_SIGMA = 0.1  # of the rate, relative


@dataclass(frozen=True, eq=False)
class TwoViews:
    """What two images tell.

    Attributes
    ----------
    omega_in_target : (3,) array, rad/s
        Inertial rate, mean over the time between; axes of the first camera.
    sigma_rad_s : float
    disagreeing : (k,) int array
        Tracks that do not move as most do.
    """

    omega_in_target: Floats
    sigma_rad_s: float
    disagreeing: Indices


def two_views(
    camera: Camera, mean_motion_rad_s: float, first: TrackedFrame, last: TrackedFrame
) -> TwoViews | None:
    """Return what two images tell; None where they are too near, or agree on nothing.

    Parameters
    ----------
    camera : Camera
    mean_motion_rad_s : float, rad/s
        Of the target's orbit, with which its local frame turns.
    first, last : TrackedFrame
    """
    names, here, there = np.intersect1d(first.tracks, last.tracks, return_indices=True)
    if len(names) < FEWEST:
        return None
    one, other = (
        camera.normalise(frame.points_px[own]) for frame, own in ((first, here), (last, there))
    )
    cv2.setRNGSeed(SEED)
    matrix, agree = cv2.findEssentialMat(
        one,
        other,
        np.eye(3),
        method=cv2.RANSAC,
        prob=CONFIDENCE,
        threshold=THRESHOLD_PX / camera.fx,
        maxIters=MOST_DRAWS,
    )
    if matrix is None or matrix.shape != (3, 3):
        return None
    inside = agree.ravel() > 0
    if inside.sum() < max(FEWEST, AGREEING * len(names)):
        return None
    count, turn, _, _ = cv2.recoverPose(matrix, one[inside], other[inside], np.eye(3))
    if count < AGREEING * inside.sum():  # in front of both cameras
        return None
    after_s = last.time_s - first.time_s
    moved = lvlh_from_first(mean_motion_rad_s * after_s)
    cam_from_start = last.R_cam_from_lvlh @ moved
    turned = first.R_cam_from_lvlh @ cam_from_start.T @ turn
    vector = Rotation.from_matrix(turned).as_rotvec()
    angle = float(np.linalg.norm(vector))
    if angle < np.deg2rad(LEAST_TURN_DEG):
        return None
    spread = max(LEAST_SIGMA, angle / 3.0)
    return TwoViews(vector / after_s, spread * angle / after_s, names[~inside])
