"""One image with all that is known of it, public or true: what pictures are drawn from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from bench.estimating.runs import estimates_path, spoken_variant
from bench.pictures.frame_records import PREFERRED
from bench.pictures.wireframe_overlay import estimated_pose
from bench.report.numbers import number, numbers
from models.dataset.dataset import read_frame_entries
from models.dataset.image_dataset import (
    read_image_frame,
    read_image_info,
    read_navigation,
    read_uncooperative_knowledge,
)
from models.dataset.navigation_estimates_file import read_navigation_estimates
from models.errors import DatasetError
from models.pose import RigidTransform
from models.uncooperative import ImageFrame, NavigationEstimate, UncooperativeKnowledge
from renders.truth.image_truth import ImageTruth, read_image_truths


@dataclass(frozen=True, eq=False)
class ImageRecord:
    """An image, what a pipeline said of it, and what it truly was.

    Attributes
    ----------
    frame : ImageFrame
    knowledge : UncooperativeKnowledge
    variant : str or None
        Whose estimate it is.
    estimate : NavigationEstimate or None
        None before any estimate was made.
    truth : ImageTruth or None
        None where the dataset has no truth half.
    """

    frame: ImageFrame
    knowledge: UncooperativeKnowledge
    variant: str | None
    estimate: NavigationEstimate | None
    truth: ImageTruth | None

    @property
    def estimated_pose(self) -> RigidTransform | None:
        """``cam_from_target`` as estimated, after the filters; None without one."""
        return None if self.estimate is None else estimated_pose(self.estimate, self.knowledge)

    @property
    def best_known_pose(self) -> RigidTransform | None:
        """``cam_from_target`` as it truly was, or else as estimated, or None."""
        return self.estimated_pose if self.truth is None else self.truth.cam_from_target

    @property
    def verdict(self) -> str:
        """One line: the pose error, or why there is no pose."""
        if self.estimate is None:
            return "not estimated"
        said = str(self.estimate.mode)
        if self.estimate.pose.status == "no pose":
            said += f" (no pose from this image: {self.estimate.pose.reason})"
        pose = self.estimated_pose
        if pose is None or self.truth is None:
            return said
        truth = self.truth.cam_from_target
        error_mm = [1e3 * float(x) for x in pose.translation - truth.translation]
        along_mm = ", ".join(numbers(error_mm, signed=True))
        # No 3-2-1 angles: a tumble passes through their singularity.
        turn_deg = np.rad2deg(Rotation.from_matrix(pose.rotation @ truth.rotation.T).magnitude())
        return f"{said}: position error {along_mm} mm; attitude {number(float(turn_deg))} deg"


class ImageRecords:
    """The images of a dataset, read one at a time; estimates and truth are read once.

    Raises
    ------
    DatasetError
        If the public half cannot be read, or other variants have spoken but not this one.
    """

    def __init__(self, folder: Path, variant: str = PREFERRED) -> None:
        self.folder = folder
        read_image_info(folder)
        self.entries = {entry.index: entry for entry in read_frame_entries(folder)}
        self.knowledge = read_uncooperative_knowledge(folder)
        self._navigation = read_navigation(folder)
        self.variant = spoken_variant(folder, variant)
        path = estimates_path(folder, 0, variant)
        estimates = read_navigation_estimates(path) if self.variant else []
        self._estimates = {estimate.frame: estimate for estimate in estimates}
        has_truth = (folder / "truth" / "exposures.jsonl").is_file()
        self._truth = read_image_truths(folder) if has_truth else {}

    def record(self, index: int) -> ImageRecord:
        """Read one image.

        Raises
        ------
        DatasetError
            If the dataset has no such image or it cannot be read.
        """
        if index not in self.entries or index not in self._navigation:
            known = sorted(set(self.entries) & set(self._navigation))
            span = f"{known[0]} to {known[-1]}" if known else "none at all"
            raise DatasetError(
                f"{self.folder}: expected one of its {len(known)} frames ({span}), got {index}"
            )
        return ImageRecord(
            frame=read_image_frame(self.folder, self.entries[index], self._navigation[index]),
            knowledge=self.knowledge,
            variant=self.variant,
            estimate=self._estimates.get(index),
            truth=self._truth.get(index),
        )
