"""The solvers that race: each takes all problems and returns a pose for each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from bench.solver_race.problems import Problems
from models.arrays import Floats
from models.errors import ScenarioError
from models.pose import RigidTransform
from pipelines.chaser_fixed.options import options_for
from pipelines.pnp.batched_levenberg_marquardt import solve_poses
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.problem import PnpProblem

Poses = tuple[Floats, Floats]
"""Rotations (b, 3, 3) and translations (b, 3)."""
Solver = Callable[[Problems], Poses]

EXACT = options_for("best").solver
STEP = float(np.finfo(np.float32).eps)  # OpenCV's own: it ends at a step so small
EASED = replace(EXACT, eps2=STEP)
NO_LENS = np.eye(3)
PINHOLE = {"model": "SIMPLE_PINHOLE", "width": 2, "height": 2, "params": [1.0, 0.0, 0.0]}
BEHIND = (np.eye(3), np.full(3, np.nan))  # of a solver that found nothing


def one_by_one(problems: Problems) -> Poses:
    """Solve by ``solve_pose``, one problem after another."""
    whole = np.broadcast_to(np.eye(2), (len(problems.points_in_target), 2, 2))
    found = [
        solve_pose(PnpProblem(problems.points_in_target, seen, whole),
                   RigidTransform(turn, shift), EASED).pose
        for seen, turn, shift in zip(problems.observed, problems.start_rotations,
                                     problems.start_translations, strict=True)
    ]  # fmt: skip
    return _stacked([(pose.rotation, pose.translation) for pose in found])


def in_a_batch(problems: Problems) -> Poses:
    """Solve by ``solve_poses``, all together."""
    found = solve_poses(
        problems.points_in_target,
        problems.observed,
        problems.start_rotations,
        problems.start_translations,
        EASED,
    )
    return found.rotations, found.translations


def opencv_refined(problems: Problems) -> Poses:
    """Solve by OpenCV's ``solvePnPRefineLM`` from the first poses, as it comes."""
    turns = Rotation.from_matrix(problems.start_rotations).as_rotvec()
    return _refined(problems, [*zip(turns, problems.start_translations.copy(), strict=True)])


def opencv_from_nothing(problems: Problems) -> Poses:
    """Solve by OpenCV's SQPNP, which needs no first pose, and refine."""
    starts = []
    for seen in problems.observed:
        _, turn, shift = cv2.solvePnP(
            problems.points_in_target, seen, NO_LENS, None, flags=cv2.SOLVEPNP_SQPNP
        )
        starts.append((turn, shift))
    return _refined(problems, starts)


def poselib_refined(problems: Problems) -> Poses:
    """Solve by PoseLib's ``refine_absolute_pose`` from the first poses.

    Raises
    ------
    ScenarioError
        If PoseLib is not installed: it is not needed to run rvbench.
    """
    try:
        import poselib
    except ImportError as error:
        raise ScenarioError(
            "expected PoseLib to race against; `make setup` installs it, or `pip install poselib`"
        ) from error
    found = []
    for seen, turn, shift in zip(
        problems.observed, problems.start_rotations, problems.start_translations, strict=True
    ):
        guess = poselib.CameraPose()
        guess.R, guess.t = turn, shift
        pose, _ = poselib.refine_absolute_pose(
            seen, problems.points_in_target, guess, PINHOLE, {"loss_type": "TRIVIAL"}
        )
        found.append((pose.R, pose.t))
    return _stacked(found)


SOLVERS: dict[str, Solver] = {
    "OpenCV RefineLM": opencv_refined,
    "OpenCV SQPNP, RefineLM": opencv_from_nothing,
    "PoseLib refine": poselib_refined,
    "rvbench, one by one": one_by_one,
    "rvbench, in a batch": in_a_batch,
}
PEER = "OpenCV RefineLM"  # whose time the others' are told in


def _refined(problems: Problems, starts: list[tuple[Floats, Floats]]) -> Poses:
    found = []
    for seen, (turn, shift) in zip(problems.observed, starts, strict=True):
        if turn is None:
            found.append(BEHIND)
            continue
        refined = cv2.solvePnPRefineLM(
            problems.points_in_target, seen, NO_LENS, None,
            turn.reshape(3, 1), shift.reshape(3, 1),
        )  # fmt: skip
        found.append((cv2.Rodrigues(refined[0])[0], refined[1].ravel()))
    return _stacked(found)


def _stacked(found: list[tuple[Floats, Floats]]) -> Poses:
    return np.array([each[0] for each in found]), np.array([each[1] for each in found])
