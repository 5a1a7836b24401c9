"""The pipeline for an uncooperative, known target: frames in, the filtered relative state out.

Follow a frame: without a state the pose is acquired from this image alone and the filters start
from it; with one the filters predict the pose, it is tracked near the prediction, and the filters
take it in or refuse it. A target lost for some frames, or whose pose explains the images less and
less, is acquired anew. None of it raises on what a frame shows.

Source: Pesce, Opromolla, Sarno, Lavagna and Grassi 2019, Aerospace Science and Technology 84.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal, TypeAlias

from models.errors import DatasetError
from models.estimate import Detections, Estimate
from models.frame import BRACKET, Frame, ImageReading
from models.motion.relative_state import RelativeState
from models.onboard import needed
from models.pose import RigidTransform
from pipelines.detection.exposure_fusion import fused_exposures
from pipelines.filters.covariance_fault import covariance_fault
from pipelines.filters.lasting_errors import WHITE
from pipelines.filters.relative_navigation import FilteredState, RelativeNavigation
from pipelines.uncooperative.image_pose_finder import NO_LIGHT, ImagePoseFinder
from pipelines.uncooperative.knowledge import (
    NAME,
    ImageFrame,
    PointFrame,
    Seen,
    UncooperativeKnowledge,
    seen,
)
from pipelines.uncooperative.options import VARIANTS, UncooperativeOptions, options_for
from pipelines.uncooperative.point_pose_finder import PointPoseFinder
from pipelines.uncooperative.pose_finder import PoseFinder

__all__ = ["VARIANTS", "Uncooperative", "UncooperativeOptions", "options_for"]

Mode: TypeAlias = Literal["searching", "acquired", "tracked", "predicted"]
DOUBTED_FRAMES = 2  # a frame whose pose is doubted counts as this many without one


class Uncooperative:
    """Follows one target through a run of frames.

    Parameters
    ----------
    knowledge : UncooperativeKnowledge
        What is loaded on board.
    options : UncooperativeOptions
        See ``options_for``.
    start : RelativeState, optional
        Not later than the first frame; without it the target is acquired. How good it is, the
        filters' options say (``start_sigma_m`` and the like).
    images : PoseFinder of ImageFrame, optional
        Finds poses in images; without it, ours.
    """

    def __init__(
        self,
        knowledge: UncooperativeKnowledge,
        options: UncooperativeOptions,
        start: RelativeState | None = None,
        images: PoseFinder[ImageFrame] | None = None,
    ) -> None:
        self._knowledge = knowledge
        self._options = options
        self._start = start
        self._points = PointPoseFinder(knowledge, options)
        self._images = images
        self._detector = knowledge.detector
        self._brackets: bool | None = None
        self._navigation: RelativeNavigation | None = None
        self._lost_frames = 0
        self._share = 1.0

    def process(self, frame: Frame) -> Estimate:
        """Estimate the state at one frame.

        Parameters
        ----------
        frame : Frame
            An image or points, and the chaser's orbit; later than the frame before.

        Returns
        -------
        Estimate
            The image's own pose or why it gave none, and the two states of the relative motion
            (``models.motion.relative_state``) once there are any. Its mode is ``searching``: no
            state yet; ``acquired``: a pose from this image alone; ``tracked``: a pose near the
            predicted one; ``predicted``: no pose from this image, the filters go on.

        Raises
        ------
        DatasetError
            If the frame lacks a stream.
        ValueError
            If time runs backwards.
        """
        return self.process_seen(seen(frame))

    def process_seen(self, frame: Seen) -> Estimate:
        """Estimate the state at one frame, as ``process`` does, of what it shows."""
        if isinstance(frame, ImageFrame):
            frame = self._as_one(frame)
        finder = self._finder(frame)
        if self._start is not None:
            self._navigation = self._filters(frame)
            self._navigation.start(self._start, frame.chaser)
            self._start = None
        if self._navigation is None:
            return self._acquired(finder, frame)
        predicted = self._navigation.predict(frame.time_s, frame.chaser)
        return self._tracked(finder, frame, self._navigation, predicted)

    def _acquired(self, finder: PoseFinder[Any], frame: Seen, keep: bool = False) -> Estimate:
        """Start from this image alone; where that fails there is no state, but one to keep."""
        return self._started(finder.acquire(frame), frame, keep)

    def _started(self, found: Estimate, frame: Seen, keep: bool = False) -> Estimate:
        """Start from a pose that owes nothing to the filters, if there is one."""
        if found.pose is not None and (fault := covariance_fault(found.pose.stated_covariance)):
            found = _refused(found, f"the pose acquired has {fault}")
        if found.pose is None:
            self._navigation = self._navigation if keep else None
            return _said(found, None, "searching")
        self._navigation = self._filters(frame)
        self._lost_frames, self._share = 0, 1.0
        started = self._navigation.start_from_pose(found, frame.chaser, frame.mount)
        return _said(found, started, "acquired")

    def _tracked(
        self,
        finder: PoseFinder[Any],
        frame: Seen,
        navigation: RelativeNavigation,
        predicted: FilteredState,
    ) -> Estimate:
        mount = self._mount(frame)
        guess = predicted.state.cam_from_target(mount)
        found = self._found(finder, frame, guess, predicted)
        if found.pose is not None:
            self._remember(finder.matched_share(frame, found))
            if self._share < self._least_share(frame):
                return self._doubted(finder, frame, found, predicted)
            predicted = navigation.update(found, frame.mount)
            if predicted.used_pose:
                self._lost_frames = 0
                return _said(found, predicted, "tracked")
            if finder.found_anew:
                return self._started(found, frame)
            found = _refused(found, f"the filters refuse the pose: {predicted.reason}")
        if found.reason == NO_LIGHT:  # which speaks neither for the state nor against it
            return _said(found, predicted, "predicted")
        self._lost_frames += 1
        refused = predicted.refused_in_row >= self._options.refused_frames
        if refused or self._lost_frames >= self._options.lost_frames:
            return self._acquired(finder, frame)
        return _said(found, predicted, "predicted")

    def _doubted(
        self,
        finder: PoseFinder[Any],
        frame: Seen,
        found: Estimate,
        predicted: FilteredState,
    ) -> Estimate:
        """Acquire anew beside a state that explains the images less and less; it has not long."""
        self._lost_frames += DOUBTED_FRAMES
        anew = self._acquired(finder, frame, keep=self._lost_frames < self._options.lost_frames)
        if anew or self._navigation is None:
            return anew
        reason = (
            f"the poses of late match {100.0 * self._share:.0f} % of what they should, "
            f"{100.0 * self._least_share(frame):.0f} % are needed"
        )
        return _said(_refused(found, reason), predicted, "predicted")

    def _found(
        self,
        finder: PoseFinder[Any],
        frame: Seen,
        guess: RigidTransform,
        predicted: FilteredState,
    ) -> Estimate:
        if not guess.translation[2] > 0.0:
            reason = "the predicted target is behind the camera"
            return Estimate(frame.index, frame.time_s, reason=reason, detections=Detections.none())
        covariance = predicted.pose_covariance(self._mount(frame))
        return finder.track(frame, guess, covariance)

    def _as_one(self, frame: ImageFrame) -> ImageFrame:
        """Return a frame whose exposures are one, as the camera's detector is then taken to be.

        Raises
        ------
        DatasetError
            If a run's frames have further exposures here and none there, or no detector is known.
        """
        if self._brackets is None:
            self._brackets = bool(frame.bracket)
        if self._brackets is not bool(frame.bracket):
            raise DatasetError(
                f"frame {frame.index}: expected further exposures ({BRACKET}0 and on) in all "
                f"frames of a run or in none, got {len(frame.bracket)} after others"
            )
        if not frame.bracket:
            return frame
        detector = needed(self._detector, "detector.toml", NAME)
        metered = ImageReading(frame.image, frame.time_s, frame.exposure_ms or 0.0)
        fused = fused_exposures((metered, *frame.bracket), detector)
        self._knowledge = replace(self._knowledge, detector=fused.detector)
        return replace(frame, image=fused.image, exposure_ms=fused.exposure_ms, bracket=())

    def _mount(self, frame: Seen) -> RigidTransform:
        return self._knowledge.cam_from_lvlh if frame.mount is None else frame.mount.cam_from_lvlh

    def _remember(self, share: float) -> None:
        weight = 1.0 / self._options.share_memory_frames
        self._share += weight * (share - self._share)

    def _least_share(self, frame: Seen) -> float:
        if isinstance(frame, PointFrame):
            return self._options.share_to_doubt
        return self._options.image_share_to_doubt

    def _filters(self, frame: Seen) -> RelativeNavigation:
        points = isinstance(frame, PointFrame)
        return RelativeNavigation(
            self._options.navigation,
            self._knowledge.cam_from_lvlh,
            chaser_sigma_m=self._knowledge.chaser_sigma_m,
            chaser_sigma_m_s=self._knowledge.chaser_sigma_m_s,
            inertia_kg_m2=self._knowledge.inertia_kg_m2,
            errors=WHITE if points else self._options.image_errors,
        )

    def _finder(self, frame: Seen) -> PoseFinder[Any]:
        if isinstance(frame, PointFrame):
            return self._points
        if self._images is None:
            self._images = ImagePoseFinder(self._knowledge, self._options)
        return self._images


def _said(found: Estimate, filtered: FilteredState | None, mode: Mode) -> Estimate:
    """Say what the image gave with the state that the filters made of it."""
    if filtered is None:
        return replace(found, mode=mode)
    states = filtered.state.named(filtered.translation_covariance, filtered.rotation_covariance)
    return replace(found, mode=mode, states=states)


def _refused(found: Estimate, reason: str) -> Estimate:
    """Turn a pose down: its matches stand, none of them used."""
    detections = found.detected
    turned_down = replace(detections, used=(False,) * len(detections.used))
    return replace(found, pose=None, reason=reason, detections=turned_down)
