"""The pipeline for an uncooperative, known target: frames in, the filtered relative state out.

Follow a frame: without a state the pose is acquired from this image alone and the filters start
from it; with one the filters predict the pose, it is tracked near the prediction, and the filters
take it in or refuse it. A target lost for some frames, or whose pose explains the images less and
less, is acquired anew. None of it raises on what a frame shows.

Source: Pesce, Opromolla, Sarno, Lavagna and Grassi 2019, Aerospace Science and Technology 84.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from models.estimate import Detections, Estimate, NoPose, PoseEstimate
from models.motion.relative_state import RelativeState
from models.pose import RigidTransform
from models.uncooperative import (
    ImageFrame,
    Mode,
    NavigationEstimate,
    PointFrame,
    UncooperativeKnowledge,
)
from pipelines.filters.covariance_fault import covariance_fault
from pipelines.filters.relative_navigation import FilteredState, RelativeNavigation
from pipelines.uncooperative.image_pose_finder import ImagePoseFinder
from pipelines.uncooperative.options import VARIANTS, UncooperativeOptions, options_for
from pipelines.uncooperative.point_pose_finder import PointPoseFinder
from pipelines.uncooperative.pose_finder import PoseFinder

__all__ = ["VARIANTS", "Uncooperative", "UncooperativeOptions", "options_for"]

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
        self._navigation: RelativeNavigation | None = None
        self._lost_frames = 0
        self._share = 1.0

    def process(self, frame: PointFrame | ImageFrame) -> NavigationEstimate:
        """Estimate the state at one frame.

        Parameters
        ----------
        frame : PointFrame or ImageFrame
            Later than the frame before.

        Returns
        -------
        NavigationEstimate

        Raises
        ------
        ValueError
            If time runs backwards.
        """
        finder = self._finder(frame)
        if self._start is not None:
            self._navigation = self._filters()
            self._navigation.start(self._start, frame.chaser)
            self._start = None
        if self._navigation is None:
            return self._acquired(finder, frame)
        predicted = self._navigation.predict(frame.time_s, frame.chaser)
        return self._tracked(finder, frame, self._navigation, predicted)

    def _acquired(
        self, finder: PoseFinder[Any], frame: PointFrame | ImageFrame, keep: bool = False
    ) -> NavigationEstimate:
        """Start from this image alone; where that fails there is no state, but one to keep."""
        pose = finder.acquire(frame)
        if isinstance(pose, PoseEstimate) and (fault := covariance_fault(pose.covariance)):
            pose = _refused(pose, f"the pose acquired has {fault}")
        if isinstance(pose, NoPose):
            self._navigation = self._navigation if keep else None
            return self._said(frame, pose, None, "searching")
        self._navigation = self._filters()
        self._lost_frames, self._share = 0, 1.0
        started = self._navigation.start_from_pose(pose, frame.chaser)
        return self._said(frame, pose, started, "acquired")

    def _tracked(
        self,
        finder: PoseFinder[Any],
        frame: PointFrame | ImageFrame,
        navigation: RelativeNavigation,
        predicted: FilteredState,
    ) -> NavigationEstimate:
        mount = self._knowledge.cam_from_lvlh
        guess = predicted.state.cam_from_target(mount)
        pose = self._found(finder, frame, guess, predicted)
        if isinstance(pose, PoseEstimate):
            self._remember(finder.matched_share(frame, pose))
            if self._share < self._least_share(frame):
                return self._doubted(finder, frame, pose, predicted)
            predicted = navigation.update(pose)
            if predicted.used_pose:
                self._lost_frames = 0
                return self._said(frame, pose, predicted, "tracked")
            pose = _refused(pose, f"the filters refuse the pose: {predicted.reason}")
        self._lost_frames += 1
        if self._lost_frames >= self._options.lost_frames:
            return self._acquired(finder, frame)
        return self._said(frame, pose, predicted, "predicted")

    def _doubted(
        self,
        finder: PoseFinder[Any],
        frame: PointFrame | ImageFrame,
        pose: PoseEstimate,
        predicted: FilteredState,
    ) -> NavigationEstimate:
        """Acquire anew beside a state that explains the images less and less; it has not long."""
        self._lost_frames += DOUBTED_FRAMES
        anew = self._acquired(finder, frame, keep=self._lost_frames < self._options.lost_frames)
        if anew or self._navigation is None:
            return anew
        reason = (
            f"the poses of late match {100.0 * self._share:.0f} % of what they should, "
            f"{100.0 * self._least_share(frame):.0f} % are needed"
        )
        return self._said(frame, _refused(pose, reason), predicted, "predicted")

    def _found(
        self,
        finder: PoseFinder[Any],
        frame: PointFrame | ImageFrame,
        guess: RigidTransform,
        predicted: FilteredState,
    ) -> Estimate:
        if not guess.translation[2] > 0.0:
            reason = "the predicted target is behind the camera"
            nothing = Detections(np.zeros((0, 2)), np.zeros((0, 2)), (), ())
            return NoPose(frame.index, frame.time_s, reason, nothing)
        covariance = predicted.pose_covariance(self._knowledge.cam_from_lvlh)
        return finder.track(frame, guess, covariance)

    def _remember(self, share: float) -> None:
        weight = 1.0 / self._options.share_memory_frames
        self._share += weight * (share - self._share)

    def _least_share(self, frame: PointFrame | ImageFrame) -> float:
        if isinstance(frame, PointFrame):
            return self._options.share_to_doubt
        return self._options.image_share_to_doubt

    def _filters(self) -> RelativeNavigation:
        return RelativeNavigation(
            self._options.navigation,
            self._knowledge.cam_from_lvlh,
            chaser_sigma_m=self._knowledge.chaser_sigma_m,
            chaser_sigma_m_s=self._knowledge.chaser_sigma_m_s,
            inertia_kg_m2=self._knowledge.inertia_kg_m2,
        )

    def _finder(self, frame: PointFrame | ImageFrame) -> PoseFinder[Any]:
        if isinstance(frame, PointFrame):
            return self._points
        if self._images is None:
            # What an image shows is what the target does not hide.
            seen = replace(self._options, hidden_landmarks=True)
            self._images = ImagePoseFinder(self._knowledge, seen)
        return self._images

    @staticmethod
    def _said(
        frame: PointFrame | ImageFrame, pose: Estimate, filtered: FilteredState | None, mode: Mode
    ) -> NavigationEstimate:
        return NavigationEstimate(
            frame=frame.index,
            time_s=frame.time_s,
            mode=mode,
            pose=pose,
            state=None if filtered is None else filtered.state,
            translation_covariance=None if filtered is None else filtered.translation_covariance,
            rotation_covariance=None if filtered is None else filtered.rotation_covariance,
        )


def _refused(pose: PoseEstimate, reason: str) -> NoPose:
    """Turn a pose down: its matches stand, none of them used."""
    found = pose.detections
    return NoPose(pose.frame, pose.time_s, reason, replace(found, used=(False,) * len(found.used)))
