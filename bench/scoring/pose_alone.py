"""Poses judged as poses, whatever gave them: for chains that ask no more of a frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from bench.chains.chain import PosedFrameTruth
from bench.estimating.runs import Run
from bench.pictures.frame_record import pose_stood_by
from bench.scoring.asked import Check, checks
from bench.scoring.judgement import Judgement, TrueScene, is_wrong
from bench.scoring.limits import Limits, read_limits
from bench.scoring.metrics.pose_errors import POSE_DOF
from models.dataset.dataset import Dataset
from models.errors import DatasetError
from models.estimate import Estimate
from models.onboard import OnboardKnowledge
from models.pose import RigidTransform
from renders.truth.posed_truth import PosedTruth, read_posed_truths


@dataclass(frozen=True, eq=False)
class TruePoses:
    """The truth half of a dataset, as far as poses go.

    Attributes
    ----------
    dataset : Dataset
    by_frame : mapping of int to PosedFrameTruth
    limits : Limits
    """

    dataset: Dataset
    by_frame: Mapping[int, PosedFrameTruth]
    limits: Limits


@dataclass(frozen=True, eq=False)
class JudgedPose(Judgement):
    """One estimate against the truth.

    Attributes
    ----------
    position_m_in_cam : list of 3 floats or None, m
        Estimate minus truth, along the camera's axes.
    """

    position_m_in_cam: list[float] | None


def read_true_poses(dataset: Dataset) -> TruePoses:
    """Read the truth of a dataset of posed images.

    Raises
    ------
    DatasetError
        If the truth half is missing or lacks a frame.
    """
    truths = read_posed_truths(dataset.folder)
    for index in dataset.indices:
        if index not in truths:
            raise DatasetError(
                f"{dataset.folder}/truth/exposures.jsonl: expected frame {index}, found none; "
                "run the render again, it goes on where it stopped"
            )
    return TruePoses(dataset, truths, read_limits(dataset.folder))


def posed_truths(dataset: Dataset) -> dict[int, PosedTruth]:
    """Return the truth of each frame; empty where there is no truth half."""
    there = (dataset.folder / "truth" / "exposures.jsonl").is_file()
    return read_posed_truths(dataset.folder) if there else {}


def judge_run(run: Run, truth: TruePoses) -> list[JudgedPose]:
    """Hold one run's estimates against the truth; a frame without a pose is missed."""
    onboard = truth.dataset.onboard
    return [
        judged_pose(run.number, run.estimates[index], truth.by_frame[index], onboard, truth.limits)
        for index in truth.dataset.indices
    ]


def judge_alone(said: Estimate, record: PosedFrameTruth, scene: TrueScene) -> JudgedPose:
    """Hold one estimate of one frame against its sealed record.

    Parameters
    ----------
    said : Estimate
    record : PosedFrameTruth
    scene : TrueScene
    """
    return judged_pose(0, said, record, scene.onboard, scene.limits)


def judged_pose(
    run: int, said: Estimate, was: PosedFrameTruth, onboard: OnboardKnowledge, limits: Limits
) -> JudgedPose:
    """Hold the pose that an estimate stands by against the truth.

    Parameters
    ----------
    run : int
    said : Estimate
    was : PosedFrameTruth
    onboard : OnboardKnowledge
    limits : Limits
    """
    pose, truth = pose_stood_by(said, onboard), was.cam_from_target
    position_m = attitude_deg = moved = None
    if pose is not None:
        moved = pose.translation - truth.translation
        position_m = float(np.linalg.norm(moved))
        attitude_deg = turned_deg(pose, truth)
    return JudgedPose(
        run=run,
        estimate=said,
        range_m=float(np.linalg.norm(truth.translation)),
        position_m=position_m,
        attitude_deg=attitude_deg,
        missed=pose is None,
        wrong=is_wrong(position_m, attitude_deg, ((_nees(said, truth), POSE_DOF),), limits),
        position_m_in_cam=None if moved is None else moved.tolist(),
    )


def turned_deg(estimate: RigidTransform, truth: RigidTransform) -> float:
    """Return the angle of the turn between two attitudes, deg."""
    turn = Rotation.from_matrix(estimate.rotation @ truth.rotation.T)
    return float(np.rad2deg(turn.magnitude()))


def asked(judged: Sequence[Sequence[JudgedPose]], truth: TruePoses, label: str) -> list[Check]:
    """Hold run 0 against what the case asks for.

    Parameters
    ----------
    judged : sequence of sequences of JudgedPose
        Run by run.
    truth : TruePoses
    label : str
        Of the pipeline.
    """
    return checks(truth.dataset.folder, judged)


def frame_rows(judged: Sequence[Sequence[JudgedPose]], truth: TruePoses) -> list[dict[str, Any]]:
    """Return the error along the camera's axes of each frame of run 0."""
    return [
        {
            "position_mm": None
            if each.position_m_in_cam is None
            else [1e3 * x for x in each.position_m_in_cam]
        }
        for each in judged[0]
    ]


def _nees(said: Estimate, truth: RigidTransform) -> float | None:
    """Return ``e' P^-1 e`` of the frame's own pose; None where no covariance is stated."""
    if said.pose is None or said.pose.covariance is None:
        return None
    pose = said.pose.cam_from_target
    turn = Rotation.from_matrix(pose.rotation @ truth.rotation.T).as_rotvec()
    error = np.concatenate([turn, pose.translation - truth.translation])
    try:
        return float(error @ np.linalg.solve(said.pose.covariance, error))
    except np.linalg.LinAlgError:
        return None
