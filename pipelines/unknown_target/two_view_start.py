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

TURN_DEG = (10.0, 50.0)  # less tells little of depth; after more, tracks are of other places
IN_FRONT = 0.9  # of those that agree: for a turn in place of a shift, half are behind
THRESHOLD_PX = 0.7
CONFIDENCE, MOST_DRAWS, SEED = 0.9999, 5000, 1
SIGMA = 0.2  # of the rate, relative: of a small target far off two images tell no more


@dataclass(frozen=True)
class Demand:
    """How much two images must tell.

    Attributes
    ----------
    tracks : int
        That both must show.
    agreeing : float
        Share of them that must move alike.
    """

    tracks: int
    agreeing: float


WELL = Demand(50, 0.7)
BARELY = Demand(25, 0.55)


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
    camera: Camera,
    mean_motion_rad_s: float,
    first: TrackedFrame,
    last: TrackedFrame,
    demand: Demand = WELL,
) -> TwoViews | None:
    """Return what two images tell; None where they are too near, or agree on nothing.

    Parameters
    ----------
    camera : Camera
    mean_motion_rad_s : float, rad/s
        Of the target's orbit, with which its local frame turns.
    first, last : TrackedFrame
    demand : Demand
    """
    names, here, there = np.intersect1d(first.tracks, last.tracks, return_indices=True)
    if len(names) < demand.tracks:
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
    if inside.sum() < demand.agreeing * len(names):
        return None
    count, turn, _, _ = cv2.recoverPose(matrix, one[inside], other[inside], np.eye(3))
    if count < IN_FRONT * inside.sum():
        return None
    after_s = last.time_s - first.time_s
    moved = lvlh_from_first(mean_motion_rad_s * after_s)
    cam_from_start = last.R_cam_from_lvlh @ moved
    turned = first.R_cam_from_lvlh @ cam_from_start.T @ turn
    vector = Rotation.from_matrix(turned).as_rotvec()
    angle = float(np.linalg.norm(vector))
    least, most = np.deg2rad(TURN_DEG)
    if not least < angle < most:
        return None
    return TwoViews(vector / after_s, SIGMA * angle / after_s, names[~inside])
