"""The poses that three matches allow, and the one that a prediction speaks for.

Three points fit up to four poses exactly (P3P), so no residual tells which is right: what was known
before does, and how clearly it does is part of the answer. Each pose is solved anew with the
matches' weights; those nearer to each other than their covariances are one.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from pipelines.pnp.covariance import pose_covariance
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.match import Match
from pipelines.pnp.predicted_pose import PredictedPose
from pipelines.pnp.problem import PnpProblem
from pipelines.pnp.solver_options import LevenbergMarquardtOptions

EXACT_CHI2 = 25.0  # a pose that misses three points by more is no minimum of them
SAME_TURN_RAD, SAME_SHIFT = 2e-3, 2e-3  # and of the range


@dataclass(frozen=True, eq=False)
class FittingPose:
    """A pose that fits.

    Attributes
    ----------
    pose : RigidTransform
        ``cam_from_target``.
    covariance : (6, 6) array, rad and m
    chi2 : float
        Of the matches.
    squared_distance : float
        From what was predicted, in sigmas of both together, squared.
    """

    pose: RigidTransform
    covariance: Floats
    chi2: float
    squared_distance: float


def poses_of_three(
    camera: Camera,
    markers: MarkerPattern,
    match: Match,
    predicted: PredictedPose,
    solver: LevenbergMarquardtOptions,
) -> list[FittingPose]:
    """Return every pose that three matches allow, the likeliest first; none where none is.

    Parameters
    ----------
    camera : Camera
    markers : MarkerPattern
    match : Match
        Three pairs that are not in a line.
    predicted : PredictedPose
    solver : LevenbergMarquardtOptions
    """
    points = markers.points_in_target[match.marker]
    problem = PnpProblem.weighted(camera, points, match.points_px, match.covariance_px2)
    found: list[FittingPose] = []
    for start in (predicted.pose, *_exact_poses(camera, points, match.points_px)):
        solved = solve_pose(problem, start, solver)
        if not solved.chi2 < EXACT_CHI2 or any(_same(solved.pose, each.pose) for each in found):
            continue
        covariance = pose_covariance(problem, solved.pose)
        if covariance is None:
            continue
        both = PredictedPose(predicted.pose, predicted.covariance + covariance, 0)
        found.append(
            FittingPose(
                solved.pose,
                covariance,
                solved.chi2,
                both.squared_distance(solved.pose) + solved.chi2,
            )
        )
    return sorted(found, key=lambda each: each.squared_distance)


def _exact_poses(camera: Camera, points: Floats, pixels: Floats) -> list[RigidTransform]:
    count, turns, shifts = cv2.solveP3P(
        points[:, None, :],
        camera.normalise(pixels)[:, None, :],
        np.eye(3),
        None,
        flags=cv2.SOLVEPNP_P3P,
    )
    poses = []
    for number in range(count):
        turn, shift = np.ravel(turns[number]), np.ravel(shifts[number])
        if np.isfinite(turn).all() and np.isfinite(shift).all() and shift[2] > 0.0:
            pose = RigidTransform(Rotation.from_rotvec(turn).as_matrix(), shift)
            if ((pose @ points)[:, 2] > 0.0).all():
                poses.append(pose)
    return poses


def _same(pose: RigidTransform, other: RigidTransform) -> bool:
    turn = Rotation.from_matrix(pose.rotation @ other.rotation.T).magnitude()
    shift = float(np.linalg.norm(pose.translation - other.translation))
    nearby = shift < SAME_SHIFT * float(np.linalg.norm(pose.translation))
    return bool(turn < SAME_TURN_RAD) and nearby
