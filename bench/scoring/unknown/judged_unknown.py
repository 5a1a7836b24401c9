"""An unknown target's estimates held against the truth, up to the one turn of its own axes.

A target without a model has no axes of its own: a pipeline's are what its first camera's were. One
constant turn brings them onto the true ones, the mean over the second half of a run; all errors are
after it. The origin is the centre of mass for both, and nothing is scaled.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from bench.estimating.runs import Run
from bench.scoring.judgement import Judgement, is_wrong
from bench.scoring.limits import Limits, read_limits
from bench.scoring.metrics.pose_errors import POSE_DOF, frame_nees
from models.arrays import Floats
from models.dataset.dataset import Dataset
from models.errors import DatasetError
from models.estimate import Estimate
from models.pose import RigidTransform
from pipelines.unknown_target.pipeline import MOTION
from renders.truth.image_truth import ImageTruth, read_image_truths
from renders.truth.range_truth import RangeTruth, read_range_truths


@dataclass(frozen=True, eq=False)
class TrueUnknown:
    """The truth half of a dataset of an unknown target, as judging needs it.

    Attributes
    ----------
    dataset : Dataset
    by_frame : mapping of int to ImageTruth
    ranges : mapping of int to RangeTruth
        Empty without a range finder.
    limits : Limits
    """

    dataset: Dataset
    by_frame: Mapping[int, ImageTruth]
    ranges: Mapping[int, RangeTruth]
    limits: Limits


@dataclass(frozen=True)
class MotionError:
    """The errors of one frame's motion.

    Attributes
    ----------
    range_share : float
        Distance to the centre of mass over the true one, minus 1.
    velocity_m_s : float
        Size of the relative velocity's error, local frame.
    rate_deg_s, axis_deg : float
        Size of the inertial rate's error, and the angle between both axes.
    sigma_range_m, sigma_attitude_deg, sigma_rate_deg_s : float or None
        As stated; None without a covariance.
    """

    range_share: float
    velocity_m_s: float
    rate_deg_s: float
    axis_deg: float
    sigma_range_m: float | None
    sigma_attitude_deg: float | None
    sigma_rate_deg_s: float | None


@dataclass(frozen=True, eq=False)
class JudgedUnknown(Judgement):
    """One frame by one pipeline.

    Attributes
    ----------
    motion : MotionError or None
        None without such a state.
    true_from_own : (3, 3) array or None
        The turn of the run from the pipeline's axes into the true ones; None without any pose.
    """

    motion: MotionError | None
    true_from_own: Floats | None


def read_true_unknown(dataset: Dataset) -> TrueUnknown:
    """Read the truth of a dataset of an unknown target.

    Raises
    ------
    DatasetError
        If the truth half is missing or lacks a frame.
    """
    truths = read_image_truths(dataset.folder)
    missing = [index for index in dataset.indices if index not in truths]
    if missing:
        raise DatasetError(
            f"{dataset.folder}/truth/exposures.jsonl: expected frame {missing[0]}, found none; "
            "run the render again, it goes on where it stopped"
        )
    ranges = read_range_truths(dataset.folder)
    return TrueUnknown(dataset, truths, ranges, read_limits(dataset.folder))


def true_unknown(dataset: Dataset) -> dict[int, ImageTruth]:
    """Return the truth of each frame; empty where there is no truth half."""
    there = (dataset.folder / "truth" / "exposures.jsonl").is_file()
    return read_image_truths(dataset.folder) if there else {}


def judge_run(run: Run, truth: TrueUnknown) -> list[JudgedUnknown]:
    """Hold one run's estimates against the truth; a frame is missed once there has been a pose."""
    turn = true_from_own(run.estimates, truth.by_frame)
    judged, begun = [], False
    for index in truth.dataset.indices:
        said = run.estimates[index]
        begun = begun or said.pose is not None
        judged.append(_judged(run.number, said, truth.by_frame[index], turn, truth.limits, begun))
    return judged


def true_from_own(
    estimates: Mapping[int, Estimate], truths: Mapping[int, ImageTruth]
) -> Floats | None:
    """Return the (3, 3) turn from a pipeline's axes into the true ones; None without any pose.

    Parameters
    ----------
    estimates : mapping of int to Estimate
    truths : mapping of int to ImageTruth
    """
    turns = [
        truths[index].cam_from_target.rotation.T @ said.pose.cam_from_target.rotation
        for index, said in estimates.items()
        if said.pose is not None and index in truths
    ]
    if not turns:
        return None
    return np.asarray(Rotation.from_matrix(np.array(turns[len(turns) // 2 :])).mean().as_matrix())


def true_rate(truth: ImageTruth) -> Floats:
    """Return the (3,) inertial rate of the target in its true axes, rad/s."""
    place, velocity = truth.chaser.position_in_inertial, truth.chaser.velocity_in_inertial
    of_lvlh = float(np.linalg.norm(np.cross(place, velocity)) / (place @ place))
    normal = truth.state.R_lvlh_from_target[2]
    return np.asarray(truth.state.omega_target_wrt_lvlh_in_target + of_lvlh * normal)


def _judged(
    number: int, said: Estimate, was: ImageTruth, turn: Floats | None, limits: Limits, begun: bool
) -> JudgedUnknown:
    truth, range_m = was.cam_from_target, float(np.linalg.norm(was.cam_from_target.translation))
    position_m = attitude_deg = None
    squares: tuple[tuple[float | None, int], ...] = ()
    if said.pose is not None and turn is not None:
        own = RigidTransform(truth.rotation @ turn, truth.translation)
        pose = said.pose.cam_from_target
        position_m = float(np.linalg.norm(pose.translation - truth.translation))
        off = Rotation.from_matrix(pose.rotation @ own.rotation.T).magnitude()
        attitude_deg = float(np.rad2deg(off))
        squares = ((frame_nees(said.pose, own), POSE_DOF),)
    return JudgedUnknown(
        run=number,
        estimate=said,
        range_m=range_m,
        position_m=position_m,
        attitude_deg=attitude_deg,
        missed=begun and said.pose is None,
        wrong=is_wrong(position_m, attitude_deg, squares, limits),
        motion=None if turn is None else motion_error(said, was, turn),
        true_from_own=turn,
    )


def motion_error(said: Estimate, was: ImageTruth, turn: Floats) -> MotionError | None:
    """Return the errors of the motion that an estimate keeps; None where it keeps none.

    Parameters
    ----------
    said : Estimate
    was : ImageTruth
    turn : (3, 3) array
        See ``true_from_own``.

    Raises
    ------
    DatasetError
        If a state of that name is something else.
    """
    if MOTION not in said.states or said.pose is None:
        return None
    state = said.states[MOTION]
    rho, rho_dot, omega = (
        _three(said, state.values.get(name))
        for name in ("rho_in_lvlh_m", "rho_dot_in_lvlh_m_s", "omega_in_target_rad_s")
    )
    true_omega, own_omega = true_rate(was), turn @ omega
    across = float(np.linalg.norm(np.cross(true_omega, own_omega)))
    spread = state.covariance
    away = rho / max(float(np.linalg.norm(rho)), 1e-9)
    return MotionError(
        range_share=float(np.linalg.norm(rho) / np.linalg.norm(was.state.rho_in_lvlh)) - 1.0,
        velocity_m_s=float(np.linalg.norm(rho_dot + was.state.rho_dot_in_lvlh)),
        rate_deg_s=float(np.rad2deg(np.linalg.norm(own_omega - true_omega))),
        axis_deg=float(np.rad2deg(np.arctan2(across, true_omega @ own_omega))),
        sigma_range_m=_root(float(away @ spread[:3, :3] @ away)) if spread is not None else None,
        sigma_attitude_deg=_in_deg(spread, slice(6, 9)),
        sigma_rate_deg_s=_in_deg(spread, slice(9, 12)),
    )


def _three(said: Estimate, value: Floats | None) -> Floats:
    if value is None or value.shape != (3,):
        raise DatasetError(
            f"frame {said.frame}: expected the state {MOTION} with rho_in_lvlh_m, "
            "rho_dot_in_lvlh_m_s and omega_in_target_rad_s, three numbers each; estimate again"
        )
    return value


def _root(square: float) -> float:
    return float(np.sqrt(max(square, 0.0)))


def _in_deg(spread: Floats | None, which: slice) -> float | None:
    if spread is None:
        return None
    return float(np.rad2deg(_root(float(np.trace(spread[which, which])))))


def second_half(frames: Sequence[JudgedUnknown]) -> list[MotionError]:
    """Return the motions of the second half of the frames with one: by then all has settled."""
    there = [each.motion for each in frames if each.motion is not None]
    return there[len(there) // 2 :]
