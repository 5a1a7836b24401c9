"""One frame with all that is known of it, public or true: what pictures are drawn from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.chains.catalogue import chain_named
from bench.chains.chain import Chain
from bench.estimating.runs import read_run, spoken_variant
from models.arrays import Image
from models.camera import Camera
from models.dataset.dataset import Dataset, open_dataset
from models.estimate import Estimate
from models.frame import Frame
from models.motion.relative_state import relative_state
from models.onboard import OnboardKnowledge, needed
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector


@dataclass(frozen=True, eq=False)
class FrameRecord:
    """A frame, what a pipeline said of it, and what it truly was.

    Attributes
    ----------
    frame : Frame
    exposure_ms : float, ms
    onboard : OnboardKnowledge
    variant : str or None
        Whose estimate it is.
    estimate : Estimate or None
        None before any estimate was made.
    truth : FrameTruth or None
        Of the chain's own kind; None where the dataset has no truth half.
    """

    frame: Frame
    exposure_ms: float
    onboard: OnboardKnowledge
    variant: str | None
    estimate: Estimate | None
    truth: Any

    @property
    def estimated_pose(self) -> RigidTransform | None:
        """``cam_from_target`` that the pipeline stands by: its state's, else the frame's own."""
        return None if self.estimate is None else pose_stood_by(self.estimate, self.onboard)

    @property
    def best_known_pose(self) -> RigidTransform | None:
        """``cam_from_target`` as it truly was, or else as estimated, or None."""
        cam_from_target = self.true_pose
        return self.estimated_pose if cam_from_target is None else cam_from_target

    @property
    def true_pose(self) -> RigidTransform | None:
        """``cam_from_target`` as it truly was; None where the truth tells none."""
        return getattr(self.truth, "cam_from_target", None)

    @property
    def true_range_m(self) -> float | None:
        """From the camera to the target frame's origin, m; None where the truth tells no pose."""
        pose = self.true_pose
        return None if pose is None else float(np.linalg.norm(pose.translation))

    @property
    def camera(self) -> Camera:
        """The camera as calibrated; an error where none is on board."""
        return needed(self.onboard.camera, "camera.toml", "the picture of a frame")

    @property
    def detector(self) -> Detector:
        """The detector as calibrated; an error where none is on board."""
        return needed(self.onboard.detector, "detector.toml", "the picture of a frame")

    def image(self, stream: str) -> Image:
        """Return the image of a stream, (height, width), DN."""
        return self.frame.image(stream).image


def pose_stood_by(estimate: Estimate, onboard: OnboardKnowledge) -> RigidTransform | None:
    """Return ``cam_from_target`` of an estimate's relative motion, else of its own pose, or None.

    Parameters
    ----------
    estimate : Estimate
    onboard : OnboardKnowledge
        Tells how the camera is mounted.
    """
    state = relative_state(estimate)
    if state is not None and onboard.expectations is not None:
        return state.cam_from_target(onboard.expectations.cam_from_lvlh)
    return None if estimate.pose is None else estimate.pose.cam_from_target


class FrameRecords:
    """The frames of a dataset, read one at a time; estimates and truth are read once.

    Parameters
    ----------
    folder : Path
    variant : str, optional
        Whose estimates; those of ``best`` unless given, or of the first that has spoken.

    Raises
    ------
    DatasetError
        If the public half cannot be read, the estimates are not of these frames, or others have
        spoken but not this one.
    """

    def __init__(self, folder: Path, variant: str | None = None) -> None:
        self.folder = folder
        self.dataset: Dataset = open_dataset(folder)
        self.chain: Chain = chain_named(self.dataset.info.chain)
        self.onboard = self.dataset.onboard
        self.variant = spoken_variant(folder, variant)
        self._estimates: Mapping[int, Estimate] = (
            read_run(self.dataset, 0, self.variant).estimates if self.variant else {}
        )
        self._truth = self.chain.truths(self.dataset)

    def record(self, index: int) -> FrameRecord:
        """Read one frame.

        Raises
        ------
        DatasetError
            If the dataset has no such frame or it cannot be read.
        """
        entry = self.dataset.entry(index)
        return FrameRecord(
            frame=self.dataset.frame(index),
            exposure_ms=entry.exposure_ms,
            onboard=self.onboard,
            variant=self.variant,
            estimate=self._estimates.get(index),
            truth=self._truth.get(index),
        )
