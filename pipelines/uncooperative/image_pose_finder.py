"""Poses of an uncooperative target from images: its drawn edges laid on those of the image.

At its best: acquired among all views, tracked from the prediction, both on edges; the corners that
lie on landmarks are named beside it. As printed: the image's corners go the paper's way, as points.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.estimate import Detections, Estimate, PoseEstimate
from models.pose import RigidTransform
from models.wireframe.visibility import visible_landmarks
from pipelines.acquisition.daylight import Daylight
from pipelines.acquisition.from_image import (
    ImageAcquirer,
    ImageAcquisition,
    ImageAcquisitionOptions,
    edge_image,
)
from pipelines.acquisition.sunlit_start import SunlitStart, SunlitStartOptions
from pipelines.acquisition.under_sun import UnderSun
from pipelines.acquisition.under_sun_options import UnderSunOptions
from pipelines.detection.corners import Corners, corners_of, find_corners
from pipelines.tracking.edge_fit import EdgeFit, EdgeImage
from pipelines.tracking.from_image import (
    ImageTrackingOptions,
    fit_covariance,
    spread_px,
    track_in_image,
)
from pipelines.tracking.model_edges import ModelEdges
from pipelines.tracking.pose_check import PoseCheck
from pipelines.uncooperative.knowledge import ImageFrame, PointFrame, UncooperativeKnowledge
from pipelines.uncooperative.options import UncooperativeOptions
from pipelines.uncooperative.point_pose_finder import PointPoseFinder

NAMED_WITHIN_PX = 3.0  # of 1024 columns: a corner this near to a landmark is it
SECOND_OPINION_EVERY = 3
CLEARLY_BETTER = 0.04
FAR_SPREAD_PX = 12.0  # a prediction that may miss by more is good for little
WITHIN = 27.9  # chi2 of six: what a prediction allows for, but once in ten thousand
NO_LIGHT = "no light: the target is in the Earth's shadow"
POINTS_AS_PRINTED = 25  # the most distinct corners; Algorithm 1 takes no clutter


class ImagePoseFinder:
    """Finds poses in images; see ``pipelines.uncooperative.pose_finder``.

    Parameters
    ----------
    knowledge : UncooperativeKnowledge
    options : UncooperativeOptions
        Of which the variant decides between edges and the paper's corners.
    acquisition : ImageAcquisitionOptions, optional
    tracking : ImageTrackingOptions, optional
    """

    def __init__(
        self,
        knowledge: UncooperativeKnowledge,
        options: UncooperativeOptions,
        acquisition: ImageAcquisitionOptions | None = None,
        tracking: ImageTrackingOptions | None = None,
    ) -> None:
        self._knowledge = knowledge
        self._by_points = (
            # What an image shows is what the target does not hide.
            PointPoseFinder(knowledge, replace(options, hidden_landmarks=True))
            if options.variant == "paper"
            else None
        )
        self._acquisition = acquisition or ImageAcquisitionOptions()
        self._tracking = tracking or ImageTrackingOptions()
        self._edges = ModelEdges(knowledge.target)
        self._acquirer = ImageAcquirer(
            knowledge.target,
            knowledge.camera,
            knowledge.detector,
            knowledge.range_m,
            self._acquisition,
        )
        self._start_options = SunlitStartOptions()
        self._under_sun: UnderSun | None = None
        self._start: SunlitStart | None = None
        self._share = 0.0
        self._unsure_frames = 0
        self._anew = False

    def acquire(self, frame: ImageFrame) -> Estimate:
        """Find the pose without any earlier one.

        Where it is known where the Sun stands, images that follow each other without a pose are
        one start: what one leaves open, the next may decide.
        """
        if self._is_dark(frame):
            return self._none(frame, NO_LIGHT)
        if self._by_points is not None:
            return self._by_points.acquire(self._points(frame))
        daylight = self._knowledge.daylight(frame.chaser, frame.exposure_ms, frame.mount)
        if daylight is not None:
            return self._acquired_under(daylight, frame)
        outcome = self._acquirer.acquire(frame.image)
        if outcome.found is None:
            return self._none(frame, outcome.reason)
        image = self._edge_image(frame)
        return self._said(frame, image, outcome.found.fit, outcome.found.check)

    def track(self, frame: ImageFrame, predicted: RigidTransform, covariance: Floats) -> Estimate:
        """Find the pose near a predicted one.

        Parameters
        ----------
        frame : ImageFrame
        predicted : RigidTransform
            ``cam_from_target``.
        covariance : (6, 6) array, rad and m
            Of the prediction: rotation first, as in ``RigidTransform.perturbed``.
        """
        if self._is_dark(frame):
            return self._none(frame, NO_LIGHT)
        if self._by_points is not None:
            return self._by_points.track(self._points(frame), predicted, covariance)
        self._anew = False
        image = self._edge_image(frame)
        tracked = track_in_image(image, self._edges, predicted, covariance, self._tracking)
        score = 0.0 if isinstance(tracked, str) else tracked.check.score
        wide = spread_px(image.camera, self._edges, predicted, covariance)
        sure = score >= self._tracking.sure_score
        self._unsure_frames = 0 if sure else self._unsure_frames + 1
        if wide > FAR_SPREAD_PX or self._unsure_frames % SECOND_OPINION_EVERY == 1:
            outcome = self._acquirer.acquire(frame.image)
            better = outcome.found
            if better is not None and better.check.score >= score + CLEARLY_BETTER:
                estimate = self._said(frame, image, better.fit, better.check)
                self._anew = better.check.score >= self._tracking.sure_score
                if wide < FAR_SPREAD_PX:
                    self._share = 0.0
                return estimate
            if wide > FAR_SPREAD_PX and undecided(outcome, predicted, covariance):
                return self._none(frame, outcome.reason, image)
        if isinstance(tracked, str):
            return self._none(frame, tracked, image)
        if tracked.doubt:
            return self._none(frame, tracked.doubt, image)
        return self._said(frame, image, tracked.fit, tracked.check)

    @property
    def found_anew(self) -> bool:
        """Whether the last pose tracked was found as if nothing were known, and surely fits.

        Such a look takes as long as ten tracked frames, so it is had only where the prediction is
        good for little, and at the first and then every third of frames in a row that fit poorly.
        A clearly better pose than the one near a sure prediction puts all of late in doubt: its
        share is none. Where the prediction is good for little and allows for several poses that
        fit alike, it does not decide between them, and nor does where tracking ends.
        """
        return self._anew

    def matched_share(self, frame: ImageFrame, estimate: Estimate) -> float:
        """Return the share of the visible edges in any light that the last pose has found."""
        if estimate.pose is None:
            return 0.0
        if self._by_points is not None:
            return self._by_points.matched_share(self._points(frame), estimate)
        return self._share

    def _is_dark(self, frame: ImageFrame) -> bool:
        """Tell whether the Sun is hidden, as the orbit has it, and no lamp shows the target."""
        if self._knowledge.sunlit_share(frame.chaser) > 0.0:
            return False
        return not self._edge_image(frame).target

    def _acquired_under(self, daylight: Daylight, frame: ImageFrame) -> Estimate:
        start = self._start
        if start is None or frame.time_s - start.last_s > self._start_options.longest_gap_s:
            self._start = start = self._begun()
        found = start.take(frame.image, frame.time_s, daylight)
        if found.over:
            self._start = None
        if found.pose is None or found.image is None:
            return self._none(frame, found.reason, found.image)
        estimate = self._said(frame, found.image, found.pose.fit, found.pose.check)
        if estimate.pose is None:
            return estimate
        doubted = replace(estimate.pose, wrong_probability=found.wrong_probability)
        return replace(estimate, pose=doubted)

    def _begun(self) -> SunlitStart:
        """Begin a start; what looks is kept from one to the next."""
        if self._under_sun is None:
            knowledge = self._knowledge
            self._under_sun = UnderSun(
                knowledge.target,
                knowledge.camera,
                knowledge.detector,
                UnderSunOptions(),
                knowledge.range_m,
            )
        return SunlitStart(self._under_sun, self._start_options)

    def _edge_image(self, frame: ImageFrame) -> EdgeImage:
        knowledge = self._knowledge
        width = self._acquisition.fine_width
        return edge_image(frame.image, knowledge.camera, knowledge.detector, width)

    def _points(self, frame: ImageFrame) -> PointFrame:
        """Reduce an image to its most distinct corners."""
        corners = find_corners(frame.image, self._knowledge.detector)
        points = corners.points_px[:POINTS_AS_PRINTED]
        return PointFrame(frame.index, frame.time_s, points, frame.chaser)

    # What to say.

    def _said(
        self, frame: ImageFrame, image: EdgeImage, fit: EdgeFit, check: PoseCheck
    ) -> Estimate:
        covariance = fit_covariance(fit, image.camera, check)
        if covariance is None:
            return self._none(frame, "the edges found do not determine a pose", image)
        self._share = check.supported
        scale = self._knowledge.camera.fx / image.camera.fx
        return Estimate(
            frame=frame.index,
            time_s=frame.time_s,
            pose=PoseEstimate(fit.cam_from_target, covariance, scale * fit.rms_px),
            detections=self._named(image, fit.cam_from_target),
        )

    def _none(self, frame: ImageFrame, reason: str, image: EdgeImage | None = None) -> Estimate:
        self._share = 0.0
        detections = self._named(image or self._edge_image(frame), None)
        return Estimate(frame.index, frame.time_s, reason=reason, detections=detections)

    def _named(self, image: EdgeImage, pose: RigidTransform | None) -> Detections:
        """Name the image's corners after the visible landmarks that they lie on, one to one."""
        knowledge = self._knowledge
        corners = corners_of(image.target, knowledge.detector)
        marker = np.full(len(corners), -1, dtype=np.int64)
        if pose is not None and len(corners):
            shown = np.flatnonzero(visible_landmarks(knowledge.target, pose))
            places = image.camera.project(pose @ knowledge.target.points_in_target[shown])
            gap = np.linalg.norm(corners.points_px[:, None] - places[None], axis=2)
            limit = NAMED_WITHIN_PX * max(image.camera.width / 1024.0, 0.5)
            gap = np.where(gap < limit, gap, 1e3)
            row, column = linear_sum_assignment(gap)
            near = gap[row, column] < limit
            marker[row[near]] = shown[column[near]]
        points, sigma = self._in_full(corners, image)
        return Detections(
            points_px=points,
            sigma_px=sigma,
            marker=tuple(marker.tolist()),
            used=tuple((marker >= 0).tolist()),
        )

    def _in_full(self, corners: Corners, image: EdgeImage) -> tuple[Floats, Floats]:
        """Return corners and their sigmas in the pixels of the frame."""
        camera = self._knowledge.camera
        scale = camera.fx / image.camera.fx
        middle = np.array([image.camera.cx, image.camera.cy])
        whole = (corners.points_px - middle) * scale + np.array([camera.cx, camera.cy])
        return whole, corners.sigma_px * scale


def undecided(outcome: ImageAcquisition, predicted: RigidTransform, covariance: Floats) -> bool:
    """Tell whether a prediction allows for more than one of the poses that fit alike.

    Parameters
    ----------
    outcome : ImageAcquisition
    predicted : RigidTransform
        ``cam_from_target``.
    covariance : (6, 6) array, rad and m
        Of the prediction, rotation first.
    """
    allowed = 0
    for rival in outcome.rivals:
        pose = rival.fit.cam_from_target
        turn = Rotation.from_matrix(pose.rotation @ predicted.rotation.T).as_rotvec()
        away = np.concatenate([turn, pose.translation - predicted.translation])
        allowed += bool(away @ np.linalg.solve(covariance, away) < WITHIN)
    return allowed > 1
