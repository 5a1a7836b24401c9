"""Estimates held against the truth, frame by frame: what every number of the score is made of."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.estimating.runs import Run
from bench.scoring.centroids import CentroidErrors
from bench.scoring.detections import JudgedDetections, VisibleMarkers, judge, visible_markers
from models.camera import Camera
from models.dataset.dataset import FrameEntry, read_frame_entries, read_knowledge
from models.errors import DatasetError
from models.estimate import Estimate, PoseEstimate
from models.markers import MarkerPattern
from models.pose import PoseError, pose_error
from renders.scenario.scenario import read_scenario
from renders.truth.exposure_truth import ExposureTruth, read_exposures

SAME_INSTANT_S = 1e-6


@dataclass(frozen=True)
class TrueFrame:
    """What really was at the instant to which a frame's estimate is stamped.

    That is the middle of its 850 nm exposure.

    Attributes
    ----------
    entry : FrameEntry
    truth : ExposureTruth
    markers : VisibleMarkers
    range_m : float, m
        From the camera to the target frame's origin.
    """

    entry: FrameEntry
    truth: ExposureTruth
    markers: VisibleMarkers
    range_m: float


@dataclass(frozen=True)
class TrueDataset:
    """The truth half of a dataset, as scoring needs it.

    Attributes
    ----------
    camera : Camera
        As simulated, from ``truth/scenario.toml``; where there is none, as calibrated.
    pattern : MarkerPattern
    frames : tuple of TrueFrame
        In time.
    """

    camera: Camera
    pattern: MarkerPattern
    frames: tuple[TrueFrame, ...]

    @property
    def entries(self) -> list[FrameEntry]:
        """The rows of ``frames.csv``."""
        return [frame.entry for frame in self.frames]


@dataclass(frozen=True)
class JudgedFrame:
    """One estimate against the truth.

    Attributes
    ----------
    run : int
    frame : TrueFrame
    estimate : Estimate
    detections : JudgedDetections
    error : PoseError or None
        None without a pose.
    """

    run: int
    frame: TrueFrame
    estimate: Estimate
    detections: JudgedDetections
    error: PoseError | None

    @property
    def pose(self) -> PoseEstimate | None:
        """The estimate, if it is one."""
        return self.estimate if isinstance(self.estimate, PoseEstimate) else None

    @property
    def missed(self) -> bool:
        """Whether there is no pose although four or more markers were whole."""
        return self.error is None and self.frame.markers.enough


def read_true_dataset(folder: Path) -> TrueDataset:
    """Read the truth of a dataset's frames.

    Raises
    ------
    DatasetError
        If the truth half is missing or lacks an exposure.
    """
    entries = read_frame_entries(folder)
    exposures = read_exposures(folder)
    knowledge = read_knowledge(folder)
    scenario = folder / "truth" / "scenario.toml"
    camera = read_scenario(scenario).simulated_camera if scenario.is_file() else knowledge.camera
    frames = []
    for entry in entries:
        truth = exposures.get((entry.index, 850))
        if truth is None:
            raise DatasetError(
                f"{folder}/truth/exposures.jsonl: expected the 850 nm exposure of frame "
                f"{entry.index}, found none; run the render again, it goes on where it stopped"
            )
        if len(truth.markers_px) != len(knowledge.markers):
            raise DatasetError(
                f"{folder}/truth/exposures.jsonl: expected {len(knowledge.markers)} markers, as in "
                f"markers.toml, got {len(truth.markers_px)} in frame {entry.index}; "
                "the two halves are of different renders"
            )
        frames.append(
            TrueFrame(
                entry=entry,
                truth=truth,
                markers=visible_markers(truth, camera, knowledge.markers),
                range_m=float(np.linalg.norm(truth.cam_from_target.translation)),
            )
        )
    return TrueDataset(camera, knowledge.markers, tuple(frames))


def judge_run(run: Run, dataset: TrueDataset) -> list[JudgedFrame]:
    """Hold one run's estimates against the truth.

    Raises
    ------
    DatasetError
        If an estimate is stamped to another instant than its frame, or names no marker of the
        target.
    """
    judged = []
    for frame in dataset.frames:
        estimate = run.estimates[frame.entry.index]
        if abs(estimate.time_s - frame.truth.time_s) > SAME_INSTANT_S:
            raise DatasetError(
                f"run {run.number}, frame {estimate.frame}: expected an estimate at "
                f"{frame.truth.time_s} s, the middle of the 850 nm exposure, got one at "
                f"{estimate.time_s} s; the frames have changed since: run the estimate again"
            )
        if max(estimate.detections.marker, default=-1) >= len(dataset.pattern):
            raise DatasetError(
                f"run {run.number}, frame {estimate.frame}: expected markers below "
                f"{len(dataset.pattern)}, as many as markers.toml has, got "
                f"{max(estimate.detections.marker)}; run the estimate again"
            )
        error = (
            pose_error(estimate.cam_from_target, frame.truth.cam_from_target)
            if isinstance(estimate, PoseEstimate)
            else None
        )
        judged.append(
            JudgedFrame(
                run=run.number,
                frame=frame,
                estimate=estimate,
                detections=judge(estimate.detections, frame.markers),
                error=error,
            )
        )
    return judged


def centroid_errors(judged: Iterable[JudgedFrame]) -> CentroidErrors:
    """Gather the errors of all true detections that the solver kept."""
    errors, columns = [np.empty((0, 2))], [np.empty((0, 4))]
    for each in judged:
        kept = each.detections.true & each.detections.used
        where = [each.frame.range_m, each.frame.entry.index, each.run]
        errors.append(each.detections.error_px[kept])
        columns.append(np.array([[*where, marker] for marker in each.detections.marker[kept]]))
    table = np.concatenate([column.reshape(-1, 4) for column in columns])
    return CentroidErrors(
        error_px=np.concatenate(errors),
        range_m=table[:, 0],
        frame=table[:, 1].astype(np.int64),
        run=table[:, 2].astype(np.int64),
        marker=table[:, 3].astype(np.int64),
    )
