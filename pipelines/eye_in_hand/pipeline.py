"""The eye-in-hand camera's pipeline: colour images in, poses or reasons out (section 3.2).

As printed: a region round the predicted dots, an adaptive threshold, blobs, centroids, nearest
neighbours and Levenberg-Marquardt. At its best: circles found among the blobs are matched all
together, every dot's rim is fitted in the raw image, all poses that three dots allow are looked for
and the prediction decides, and where dots fail the board's outline helps if both together suffice.
None of it raises on what an image shows.

Source: Opromolla, Vela, Nocerino and Lombardi 2022, Remote Sensing 14(18), 4483.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from models.arrays import Floats, Image, Indices
from models.errors import DatasetError
from models.estimate import Detections, Estimate, PoseEstimate
from models.frame import IMAGE, Frame
from models.wireframe.wireframe import Wireframe
from pipelines.detection.area_opening import expected_radius_px
from pipelines.eye_in_hand.best_look import BestLook
from pipelines.eye_in_hand.options import VARIANTS, EyeInHandOptions, options_for
from pipelines.eye_in_hand.printed_detection import detect_as_printed
from pipelines.eye_in_hand.sighting import FARTHEST_M, Sighting, blind
from pipelines.pnp.flight_knowledge import FlightKnowledge
from pipelines.pnp.identification import identification_gate_px, nearest_neighbour
from pipelines.pnp.match import Match
from pipelines.pnp.motion_prediction import MotionPrediction
from pipelines.pnp.predicted_pose import PredictedPose
from pipelines.pnp.robust_pose import solve_match
from pipelines.pnp.told_errors import stamp_sigma_s

__all__ = ["VARIANTS", "EyeInHand", "EyeInHandOptions", "options_for"]


class EyeInHand:
    """Tracks the pose of a grasping point through a run of frames.

    Parameters
    ----------
    knowledge : FlightKnowledge
        What is loaded on board.
    options : EyeInHandOptions
        See ``options_for``.
    board : Wireframe, optional
        What carries the dots.
    psf_sigma_px : float, optional, px
        Blur of the lens, if it was measured.
    sigmas : mapping of str to float, optional
        1-sigma of what is told otherwise than it is.
    """

    def __init__(
        self,
        knowledge: FlightKnowledge,
        options: EyeInHandOptions,
        board: Wireframe | None = None,
        psf_sigma_px: float | None = None,
        sigmas: Mapping[str, float] | None = None,
    ) -> None:
        self._knowledge, self._options = knowledge, options
        self._camera, self._markers = knowledge.camera, knowledge.markers
        self._motion = MotionPrediction(knowledge, options)
        self._focal_px = 0.5 * (knowledge.camera.fx + knowledge.camera.fy)
        blur_px = options.psf_sigma_px if psf_sigma_px is None else psf_sigma_px
        self._sigmas = dict(sigmas or {})
        self._best = BestLook(knowledge, options, board, blur_px, self._sigmas)

    def process(self, frame: Frame) -> Estimate:
        """Estimate the pose at one frame.

        Parameters
        ----------
        frame : Frame
            The first is matched from the prior, the next ones from the poses found before.

        Returns
        -------
        Estimate
            A pose with its covariance, or a reason for none. Where another pose fits the dots as
            well, it is kept as the state ``rival_pose``, with how much further from the prediction
            it lies.

        Raises
        ------
        DatasetError
            If the frame holds no image, or one of another size than the camera's.
        """
        raw = frame.image(IMAGE).image
        self._require_size(frame.index, raw)
        predicted = self._motion.predict(frame.time_s)
        depth_m = float(predicted.pose.translation[2])
        if not self._markers.radius_m < depth_m < FARTHEST_M:
            sighting = blind(
                f"the predicted target is {depth_m:.3g} m ahead of the camera, out of sight"
            )
        elif self._options.fits_rims:
            sighting = self._best.look(raw, predicted)
        else:
            sighting = self._look_as_printed(raw, predicted)
        pose = sighting.pose
        if pose is None:
            self._motion.lost()
        else:
            seen, covariance = pose.cam_from_target, pose.stated_covariance
            if self._options.fits_rims:
                sigma_s = stamp_sigma_s(self._sigmas, frame.time_s)
                wider = self._motion.with_stamp_error(frame.time_s, seen, covariance, sigma_s)
                pose = replace(pose, covariance=wider)
            # The next pose is stamped by the same clock: what predicts it does without.
            self._motion.found(frame.time_s, seen, covariance)
        return Estimate(
            frame=frame.index,
            time_s=frame.time_s,
            pose=pose,
            reason=sighting.reason,
            detections=sighting.detections,
            mode=sighting.mode,
            states=sighting.states,
        )

    def _look_as_printed(self, raw: Image, predicted: PredictedPose) -> Sighting:
        options, markers = self._options, self._markers
        range_m = float(np.linalg.norm(predicted.pose.translation))
        radius = expected_radius_px(markers.radius_m, range_m, self._focal_px)
        reprojected = self._camera.project(predicted.pose @ markers.points_in_target)
        candidates = detect_as_printed(
            raw, self._camera, self._knowledge.detector, reprojected, radius, options
        )
        gate = identification_gate_px(
            markers.min_separation_m, range_m, self._focal_px, options.s_id
        )
        points = candidates.points_px
        matched = nearest_neighbour(points, reprojected, gate)
        taken = matched >= 0
        sigma = options.centroid_sigma_px
        each = np.broadcast_to(sigma**2 * np.eye(2), (int(taken.sum()), 2, 2))
        match = Match(points[taken], each, matched[taken])
        outcome = solve_match(self._camera, markers, match, predicted.pose, radius, options)
        detections = _detections(points, matched, sigma, not isinstance(outcome, str))
        if isinstance(outcome, str):
            return Sighting(None, outcome, detections)
        pose = PoseEstimate(outcome.pose, outcome.covariance, outcome.residual_rms_px)
        return Sighting(pose, None, detections, "dots")

    def _require_size(self, frame: int, raw: Image) -> None:
        expected = (self._camera.height, self._camera.width)
        if raw.shape != expected:
            raise DatasetError(
                f"frame {frame}: expected images of {expected[1]} x {expected[0]} pixels, "
                f"as the camera's, got {raw.shape[1]} x {raw.shape[0]}; "
                "give the camera that took them"
            )


def _detections(points: Floats, matched: Indices, sigma_px: float, solved: bool) -> Detections:
    return Detections(
        points_px=points,
        sigma_px=np.full((len(points), 2), sigma_px),
        marker=tuple(int(marker) for marker in matched),
        used=tuple(bool(solved and marker >= 0) for marker in matched),
    )
