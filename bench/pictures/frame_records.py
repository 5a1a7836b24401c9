"""One frame with all that is known of it, public or true: what pictures are drawn from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from bench.estimating.runs import estimates_path, spoken_variant
from bench.report.numbers import number, numbers
from models.arrays import Floats
from models.dataset.dataset import read_frame, read_frame_entries, read_info, read_knowledge
from models.dataset.estimates_file import read_estimates
from models.errors import DatasetError
from models.estimate import Estimate, NoPose, PoseEstimate
from models.frame import FlightKnowledge, Frame
from models.pose import RigidTransform, pose_error
from renders.truth.exposure_truth import ExposureTruth, read_exposures

PREFERRED = "best"


@dataclass(frozen=True)
class FrameRecord:
    """A frame, what a pipeline said of it, and what it truly was.

    Attributes
    ----------
    frame : Frame
    knowledge : FlightKnowledge
    variant : str or None
        Whose estimate it is.
    estimate : Estimate or None
        None before any estimate was made.
    truth : ExposureTruth or None
        Of the 850 nm exposure; None where the dataset has no truth half.
    """

    frame: Frame
    knowledge: FlightKnowledge
    variant: str | None
    estimate: Estimate | None
    truth: ExposureTruth | None

    @property
    def reprojections_px(self) -> Floats | None:
        """(n, 2) array, px: the markers' centres by the estimated pose; None without one."""
        if not isinstance(self.estimate, PoseEstimate):
            return None
        points = self.knowledge.markers.points_in_target
        return self.knowledge.camera.project(self.estimate.cam_from_target @ points)

    @property
    def best_known_pose(self) -> RigidTransform | None:
        """``cam_from_target`` as it truly was, or else as estimated, or None."""
        if self.truth is not None:
            return self.truth.cam_from_target
        return self.estimate.cam_from_target if isinstance(self.estimate, PoseEstimate) else None

    @property
    def verdict(self) -> str:
        """One line: the pose error, or why there is no pose."""
        if self.estimate is None:
            return "not estimated"
        if isinstance(self.estimate, NoPose):
            return f"no pose: {self.estimate.reason}"
        if self.truth is None:
            used = sum(self.estimate.detections.used)
            residual = number(self.estimate.residual_rms_px)
            return f"pose from {used} markers, residual {residual} px rms"
        error = pose_error(self.estimate.cam_from_target, self.truth.cam_from_target)
        along_mm = ", ".join(numbers([1e3 * float(x) for x in error.position_m], signed=True))
        return f"position error {along_mm} mm; attitude {number(float(error.attitude_deg))} deg"


class FrameRecords:
    """The frames of a dataset, read one at a time; estimates and truth are read once.

    Raises
    ------
    DatasetError
        If the public half cannot be read, or other variants have spoken but not this one.
    """

    def __init__(self, folder: Path, variant: str = PREFERRED) -> None:
        self.folder = folder
        read_info(folder)
        self.entries = {entry.index: entry for entry in read_frame_entries(folder)}
        self.knowledge = read_knowledge(folder)
        self.variant = spoken_variant(folder, variant)
        path = estimates_path(folder, 0, variant)
        estimates = read_estimates(path) if self.variant else []
        self._estimates = {estimate.frame: estimate for estimate in estimates}
        has_truth = (folder / "truth" / "exposures.jsonl").is_file()
        self._truth = read_exposures(folder) if has_truth else {}

    def record(self, index: int) -> FrameRecord:
        """Read one frame.

        Raises
        ------
        DatasetError
            If the dataset has no such frame or its images cannot be read.
        """
        if index not in self.entries:
            known = sorted(self.entries)
            span = f"{known[0]} to {known[-1]}" if known else "none at all"
            raise DatasetError(
                f"{self.folder}: expected one of its {len(known)} frames ({span}), got {index}"
            )
        return FrameRecord(
            frame=read_frame(self.folder, self.entries[index]),
            knowledge=self.knowledge,
            variant=self.variant,
            estimate=self._estimates.get(index),
            truth=self._truth.get((index, 850)),
        )
