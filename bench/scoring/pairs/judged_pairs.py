"""Estimates of images of markers, pairs and single ones, held against the truth, frame by frame."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.estimating.runs import Run
from bench.scoring.judgement import Counts, Judgement, TrueScene, is_wrong
from bench.scoring.limits import Limits, read_limits
from bench.scoring.metrics import pose_errors
from bench.scoring.pairs.centroids import CentroidErrors
from bench.scoring.pairs.detections import (
    JudgedDetections,
    VisibleMarkers,
    judge,
    visible_markers,
)
from models.camera import Camera
from models.dataset.dataset import Dataset
from models.dataset.frame_table import FrameEntry
from models.dataset.marker_file import read_markers
from models.errors import DatasetError
from models.estimate import Estimate
from models.markers import MarkerPattern
from models.onboard import needed
from models.pose import PoseError, pose_error
from pipelines.pnp.flight_knowledge import FlightKnowledge
from renders.truth.exposure_truth import ExposureTruth, read_exposures

LAST_BANDS = (850, 0)  # of a pair, and the one of a single image
HALF = 0.5  # of a marker, in sunlight


@dataclass(frozen=True)
class TrueFrame:
    """What really was at the instant to which a frame's estimate is stamped.

    That is the middle of its last exposure; of a pair, the 850 nm one.

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
    folder : Path
    camera : Camera
        As simulated, from ``truth/scenario.toml``; where there is none, as calibrated.
    pattern : MarkerPattern
        As installed, from ``truth/markers.toml``; where there is none, as surveyed.
    frames : tuple of TrueFrame
        In time.
    limits : Limits
    """

    folder: Path
    camera: Camera
    pattern: MarkerPattern
    frames: tuple[TrueFrame, ...]
    limits: Limits


@dataclass(frozen=True, eq=False)
class JudgedFrame(Judgement):
    """One estimate against the truth.

    Attributes
    ----------
    frame : TrueFrame
    detections : JudgedDetections
    error : PoseError or None
        None without a pose.
    """

    frame: TrueFrame
    detections: JudgedDetections
    error: PoseError | None

    @property
    def counts(self) -> Counts:
        """The markers of this frame."""
        expected = self.frame.markers.expected
        return Counts(
            expected=int(expected.sum()),
            found=int(expected[self.detections.found].sum()),
            mismatched=int(self.detections.mismatch.sum()),
            used=len(self.detections.solved_with),
            in_sun=int((self.frame.truth.sun_lit >= HALF).sum()),
        )


def read_true_dataset(dataset: Dataset) -> TrueDataset:
    """Read the truth of a dataset's frames.

    Raises
    ------
    DatasetError
        If the truth half is missing or lacks an exposure, or the markers on board are others.
    """
    from renders.scenario.scenario import read_scenario  # 0.1 s, and pictures need it not

    folder = dataset.folder
    exposures = read_exposures(folder)
    told = FlightKnowledge.of(dataset.onboard, "judging markers")
    markers = folder / "truth" / "markers.toml"
    pattern = read_markers(markers) if markers.is_file() else told.markers
    scenario = folder / "truth" / "scenario.toml"
    camera = read_scenario(scenario).simulated_camera if scenario.is_file() else told.camera
    if len(pattern) != len(told.markers):
        raise DatasetError(
            f"{folder}/markers.toml: expected the {len(pattern)} markers that the target has, "
            f"got {len(told.markers)}; the two halves are of different renders"
        )
    frames, pairs = [], any(band > 0 for _, band in exposures)
    for entry in dataset.entries:
        truth = _last_of(exposures, entry.index)
        if truth is None:
            exposure = f"{'850 nm ' if pairs else ''}exposure of frame {entry.index}"
            raise DatasetError(
                f"{folder}/truth/exposures.jsonl: expected the {exposure}, found none; "
                "run the render again, it goes on where it stopped"
            )
        if len(truth.markers_px) != len(pattern):
            raise DatasetError(
                f"{folder}/truth/exposures.jsonl: expected {len(pattern)} markers, as in "
                f"markers.toml, got {len(truth.markers_px)} in frame {entry.index}; "
                "the two halves are of different renders"
            )
        frames.append(
            TrueFrame(
                entry=entry,
                truth=truth,
                markers=visible_markers(truth, camera, pattern),
                range_m=float(np.linalg.norm(truth.cam_from_target.translation)),
            )
        )
    return TrueDataset(folder, camera, pattern, tuple(frames), read_limits(folder))


def true_poses(dataset: Dataset) -> dict[int, ExposureTruth]:
    """Return the truth of each frame's 850 nm exposure; empty where there is no truth half."""
    if not (dataset.folder / "truth" / "exposures.jsonl").is_file():
        return {}
    exposures = read_exposures(dataset.folder)
    return {frame: truth for (frame, band), truth in exposures.items() if band in LAST_BANDS}


def _last_of(exposures: dict[tuple[int, int], ExposureTruth], frame: int) -> ExposureTruth | None:
    """Return the exposure to which a frame's estimate is stamped."""
    return next(
        (exposures[key] for band in LAST_BANDS if (key := (frame, band)) in exposures), None
    )


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
        said = run.estimates[frame.entry.index]
        highest = max(said.detected.marker, default=-1)
        if highest >= len(dataset.pattern):
            raise DatasetError(
                f"frame {said.frame}: expected markers below {len(dataset.pattern)}, as many as "
                f"markers.toml has, got {highest}; run the estimate again"
            )
        judged.append(_judged(run.number, said, frame, dataset.limits))
    return judged


def _judged(run: int, said: Estimate, frame: TrueFrame, limits: Limits) -> JudgedFrame:
    error = position_m = attitude_deg = None
    wrong = False
    if said.pose is not None:
        error = pose_error(said.pose.cam_from_target, frame.truth.cam_from_target)
        position_m, attitude_deg = float(np.linalg.norm(error.position_m)), error.attitude_deg
        square = pose_errors.frame_nees(said.pose, frame.truth.cam_from_target)
        wrong = is_wrong(position_m, attitude_deg, ((square, pose_errors.POSE_DOF),), limits)
    return JudgedFrame(
        run=run,
        estimate=said,
        range_m=frame.range_m,
        position_m=position_m,
        attitude_deg=attitude_deg,
        missed=error is None and frame.markers.enough,
        wrong=wrong,
        frame=frame,
        detections=judge(said.detected, frame.markers),
        error=error,
    )


def judge_alone(said: Estimate, record: ExposureTruth, scene: TrueScene) -> JudgedFrame:
    """Hold one estimate of one pair against the sealed record of its 850 nm exposure.

    Parameters
    ----------
    said : Estimate
    record : ExposureTruth
    scene : TrueScene

    Raises
    ------
    DatasetError
        If the scene has no markers.
    """
    pattern = needed(scene.markers, "markers.toml", "judging pairs")
    frame = TrueFrame(
        entry=FrameEntry(record.frame, record.time_s),
        truth=record,
        markers=visible_markers(record, scene.camera, pattern),
        range_m=float(np.linalg.norm(record.cam_from_target.translation)),
    )
    return _judged(0, said, frame, scene.limits)


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
