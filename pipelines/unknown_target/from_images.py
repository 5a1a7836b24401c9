"""The pipeline for a target never seen before, on images: own tracks, a range, nothing else.

``best`` alone: the paper's filter has its points from the first image and holds its camera on the
target, off the along-track axis (equation 3); tracks that end, and a camera along the track, are
beyond what it says.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from models.arrays import Mask
from models.camera import Camera
from models.estimate import Detections, Estimate
from models.frame import IMAGE, Frame
from pipelines.features.feature_tracker import FeaturesSeen, FeatureTracker
from pipelines.unknown_target.image_start import ImageStart
from pipelines.unknown_target.knowledge import UnknownTargetKnowledge, mean_motion_of
from pipelines.unknown_target.options import ImageOptions, UnknownTargetOptions
from pipelines.unknown_target.pipeline import UnknownTarget, estimate_of
from pipelines.unknown_target.silhouettes import silhouette
from pipelines.unknown_target.tracked_frame import TrackedFrame, range_of


class UnknownFromImages:
    """Follows one target through images.

    Parameters
    ----------
    knowledge : UnknownTargetKnowledge
    options : ImageOptions
    """

    def __init__(self, knowledge: UnknownTargetKnowledge, options: ImageOptions) -> None:
        self._knowledge, self._options = knowledge, options
        self._tracker = FeatureTracker(knowledge.camera, options.tracker, knowledge.detector)
        self._start: ImageStart | None = None
        self._mean_motion = 0.0
        self._target: UnknownTarget | None = None

    def process(self, frame: Frame) -> Estimate:
        """Take in an image, and a range where there is one.

        Returns
        -------
        Estimate
            The pose of the target's centre of mass, in the axes of the first camera; its motion,
            shape and inertia as states. Until two images tell how it turns, a reason.

        Raises
        ------
        DatasetError
            If a stream is missing or says what cannot be.
        """
        seen = self._tracked(frame)
        if self._start is None:
            self._mean_motion = mean_motion_of(frame)
            self._start = self._new_start()
        reason = self._taken(seen)
        if self._target is None:
            return self._without(seen, reason)
        known = self._target.known()
        said = estimate_of(known, seen)
        used = np.isin(seen.tracks, np.array(known.names, dtype=np.int64))
        return replace(said, detections=_detections(seen, used.tolist()))

    def _taken(self, seen: TrackedFrame) -> str:
        """Take in a frame; say why there is no target where there is none."""
        try:
            if self._target is not None:
                self._target.add(seen)
                return ""
            started = self._start_here.take(seen)
            if started is None:
                return (
                    f"{len(self._start_here)} images gathered, no two of them tell how it turns; "
                    f"{len(seen.tracks)} tracks"
                )
            options = UnknownTargetOptions("best", batch=self._options.batch)
            target = UnknownTarget(self._camera, self._mean_motion, started.guess, options)
            for each in started.frames:
                target.add(each)
            self._target = target
        except (np.linalg.LinAlgError, RuntimeError) as error:
            self._target, self._start = None, self._new_start()
            return f"begun anew: {error}"
        return ""

    @property
    def _camera(self) -> Camera:
        return self._knowledge.camera

    @property
    def _start_here(self) -> ImageStart:
        assert self._start is not None
        return self._start

    def _new_start(self) -> ImageStart:
        return ImageStart(self._camera, self._mean_motion, self._knowledge.range_m)

    def _tracked(self, frame: Frame) -> TrackedFrame:
        seen = self._tracker.track(frame.image(IMAGE).image)
        range_m, sigma_m = range_of(frame)
        return TrackedFrame(
            frame.index,
            frame.time_s,
            self._knowledge.cam_from_lvlh.rotation,
            seen.names,
            seen.points_px,
            seen.sigma_px,
            range_m,
            sigma_m,
            self._covered(frame.index, seen),
        )

    def _covered(self, index: int, seen: FeaturesSeen) -> Mask | None:
        if index % self._options.silhouette_every or not seen.region:
            return None
        return silhouette(seen.region)

    def _without(self, seen: TrackedFrame, reason: str) -> Estimate:
        unused = [False] * len(seen.tracks)
        found = _detections(seen, unused)
        return Estimate(seen.index, seen.time_s, reason=reason, detections=found, mode="searching")


def _detections(seen: TrackedFrame, used: list[bool]) -> Detections:
    return Detections(
        seen.points_px,
        np.column_stack([seen.sigma_px, seen.sigma_px]),
        tuple(seen.tracks.tolist()),
        tuple(used),
    )
