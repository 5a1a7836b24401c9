"""The chaser-fixed camera's pipeline: image pairs in, poses or reasons out (section 3.1).

Follow a frame: the last poses predict this one (``tracking``), detection finds candidates,
identification says which marker each is, the solver finds the pose, and in the best variant every
disc is fitted where that pose says it is and the pose is solved again. What each variant does is
told by ``options``; none of it raises on what an image shows.

Source: Opromolla, Vela, Nocerino and Lombardi 2022, Remote Sensing 14(18), 4483.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from models.arrays import Floats, Indices, Mask
from models.errors import DatasetError
from models.estimate import Detections, Estimate, PoseEstimate
from models.frame import Frame
from models.pose import RigidTransform
from pipelines.chaser_fixed.options import VARIANTS, ChaserFixedOptions, options_for
from pipelines.chaser_fixed.refinement import fit_markers
from pipelines.detection.area_opening import expected_radius_px
from pipelines.detection.candidates import Candidates
from pipelines.detection.disc_fit import ExpectedBlur
from pipelines.detection.global_threshold import detect_by_global_threshold
from pipelines.detection.image_difference import Region, shines_swapped, swapped
from pipelines.detection.image_pair import ImagePair, image_pair
from pipelines.detection.marker_search import (
    PredictedMarkers,
    marker_regions,
    pair_costs,
    predict_markers,
    search,
    within_gate,
)
from pipelines.pnp.chance_match import MOST_FALSE_ALARMS, false_alarms
from pipelines.pnp.flight_knowledge import FlightKnowledge
from pipelines.pnp.hypotheses import FAR_CHI2, propose_match
from pipelines.pnp.identification import (
    identification_gate_px,
    nearest_neighbour,
    one_to_one,
)
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.match import Match, Solution
from pipelines.pnp.motion_prediction import MotionPrediction
from pipelines.pnp.predicted_pose import PredictedPose
from pipelines.pnp.problem import PnpProblem
from pipelines.pnp.robust_pose import solve_match
from pipelines.pnp.told_errors import (
    calibration_errors_px,
    place_covariance_px2,
    stamp_sigma_s,
    with_common_errors,
)

__all__ = ["VARIANTS", "ChaserFixed", "ChaserFixedOptions", "options_for"]

COARSE_SIGMA_PX = 0.1  # of a blob's centroid before its disc is fitted,
COARSE_SIGMA_RADII = 0.05  # and what brightness ramps and survey errors add, in radii
MOST_GROWTH = 4.0
FARTHEST_M = 1e6  # beyond it no marker is a pixel, in any camera


@dataclass(frozen=True, eq=False)
class _Sighting:
    """What one look at a frame came to: candidates, and a pose or why none."""

    candidates: Candidates
    outcome: Solution | str


class ChaserFixed:
    """Tracks a target's pose through a run of frames.

    Parameters
    ----------
    knowledge : FlightKnowledge
        What is loaded on board.
    options : ChaserFixedOptions
        See ``options_for``.
    sigmas : mapping of str to float, optional
        1-sigma of what is told otherwise than it is; the best variant weighs markers by how well
        they were surveyed, and states a covariance that has calibration and clock in it.
    """

    def __init__(
        self,
        knowledge: FlightKnowledge,
        options: ChaserFixedOptions,
        sigmas: Mapping[str, float] | None = None,
    ) -> None:
        self._camera = knowledge.camera
        self._detector = knowledge.detector
        self._markers = knowledge.markers
        self._options = options
        self._sigmas = dict(sigmas or {})
        self._calibration = {k: each for k, each in self._sigmas.items() if k.startswith("camera.")}
        self._motion = MotionPrediction(knowledge, options)
        self._focal_px = 0.5 * (knowledge.camera.fx + knowledge.camera.fy)
        self._blur = ExpectedBlur(
            options.psf_sigma_px, options.psf_tolerance_px, options.psf_sigma_px
        )

    def process(self, frame: Frame) -> Estimate:
        """Estimate the pose at one frame.

        Parameters
        ----------
        frame : Frame
            The first is matched from the prior, the next ones from the poses found before.

        Returns
        -------
        Estimate
            A pose with its covariance, or a reason for none; never a state.

        Raises
        ------
        DatasetError
            If the frame holds no pair, or it is not of the camera's size.
        """
        pair = image_pair(frame)
        self._require_size(frame.index, pair)
        predicted = self._motion.predict(frame.time_s)
        sighting = self._look(pair, predicted)
        if isinstance(sighting.outcome, str):
            self._motion.lost()
            return Estimate(
                frame.index,
                frame.time_s,
                reason=self._explained(pair, predicted, sighting.outcome),
                detections=self._unmatched(sighting.candidates),
            )
        solution = sighting.outcome
        if self._options.centroiding != "weighted_blob":
            solution = self._refined(pair, frame.time_s, solution, predicted)
        if self._options.calibration == "stated":
            solution = self._by_own_noise(solution)
        covariance = solution.covariance
        if self._options.calibration != "unknown":
            sigma_s = stamp_sigma_s(self._sigmas, frame.time_s)
            covariance = self._motion.with_stamp_error(
                frame.time_s, solution.pose, covariance, sigma_s
            )
        # The next pose errs alike by calibration and clock: what predicts it does without.
        self._motion.found(frame.time_s, solution.pose, solution.scatter)
        return Estimate(
            frame=frame.index,
            time_s=frame.time_s,
            pose=PoseEstimate(solution.pose, covariance, solution.residual_rms_px),
            detections=self._detections(sighting, solution),
        )

    # Where to look, and for what.

    def _look(self, pair: ImagePair, predicted: PredictedPose) -> _Sighting:
        depth_m = float(predicted.pose.translation[2])
        if not self._markers.radius_m < depth_m < FARTHEST_M:
            reason = f"the predicted target is {depth_m:.3g} m ahead of the camera, out of sight"
            return _Sighting(Candidates.none(), reason)
        if self._options.threshold_rule != "per_blob":
            return self._look_by_global_threshold(pair, predicted)
        markers = predict_markers(self._camera, self._markers, predicted)
        if markers is None:
            return _Sighting(Candidates.none(), "no marker faces the camera in the predicted pose")
        growth = self._growth(predicted)
        if self._options.search_regions:
            regions = marker_regions(self._camera, markers, self._options, growth)
            if regions:
                sighting = self._look_in(pair, predicted, markers, regions)
                if not isinstance(sighting.outcome, str):
                    return sighting
        return self._look_in(pair, predicted, markers, [Region.whole(pair.image_850)])

    def _look_by_global_threshold(self, pair: ImagePair, predicted: PredictedPose) -> _Sighting:
        range_m = float(np.linalg.norm(predicted.pose.translation))
        radius = expected_radius_px(self._markers.radius_m, range_m, self._focal_px)
        candidates = detect_by_global_threshold(
            pair, self._camera, self._detector, radius, self._options
        )
        reprojected = self._camera.project(predicted.pose @ self._markers.points_in_target)
        gate = self._gate_px(predicted)
        if self._options.identification == "nearest_neighbour":
            matched = nearest_neighbour(candidates.points_px, reprojected, gate)
        else:
            gap = np.linalg.norm(candidates.points_px[:, None] - reprojected[None], axis=-1)
            gap = np.nan_to_num(gap, nan=np.inf)
            matched = one_to_one(gap**2 / gate**2, gap < gate)
        sigma = self._options.centroid_sigma_px
        match = self._match(candidates, matched, sigma)
        return _Sighting(candidates, self._solved(match, predicted.pose, radius, predicted))

    def _look_in(
        self,
        pair: ImagePair,
        predicted: PredictedPose,
        markers: PredictedMarkers,
        regions: list[Region],
    ) -> _Sighting:
        candidates = search(pair, self._camera, self._detector, markers, regions, self._options)
        points, radius = candidates.points_px, markers.radius_px
        sigma = self._coarse_sigma_px(radius)
        cost = pair_costs(points, markers, sigma)
        near = within_gate(points, markers, self._gate_px(predicted))
        allowed = near | (cost < self._options.region_sigmas**2)
        searched_px = float(sum(region.pixels for region in regions))
        matched = one_to_one(cost, allowed)
        match = self._match(candidates, matched, sigma)
        outcome = self._solved(match, predicted.pose, radius, predicted)
        outcome = self._plausible(outcome, predicted, markers, candidates, allowed, searched_px)
        if isinstance(outcome, str) and self._options.verify and len(candidates) >= 4:
            proposed = propose_match(
                self._camera, self._markers, points, allowed, predicted, max(3.0, 0.5 * radius)
            )
            if proposed is not None:
                pose, voted = proposed
                match = self._match(candidates, voted, sigma)
                outcome = self._solved(match, pose, radius, predicted)
                outcome = self._plausible(
                    outcome, predicted, markers, candidates, allowed, searched_px
                )
        return _Sighting(candidates, outcome)

    # From matches to a pose.

    def _solved(
        self, match: Match, start: RigidTransform, radius_px: float, predicted: PredictedPose
    ) -> Solution | str:
        if self._options.calibration != "unknown":
            ideal = self._camera.normalise(match.points_px)
            shared = calibration_errors_px(self._camera, ideal, self._sigmas)
            match = replace(match, common_px=shared)
        return solve_match(
            self._camera, self._markers, match, start, radius_px, self._options, predicted
        )

    def _plausible(
        self,
        outcome: Solution | str,
        predicted: PredictedPose,
        markers: PredictedMarkers,
        candidates: Candidates,
        allowed: Mask,
        searched_px: float,
    ) -> Solution | str:
        """Refuse a pose that chance could have made, or far off with next to no match to spare."""
        if isinstance(outcome, str) or not self._options.verify:
            return outcome
        agreeing = int(outcome.used.sum())
        reach_px = self._options.outlier_sigmas * self._coarse_sigma_px(markers.radius_px)
        expected = false_alarms(
            agreeing,
            int(markers.outlines.facing.sum()),
            int(allowed.sum()) - agreeing,
            len(candidates) - agreeing,
            searched_px,
            reach_px,
        )
        if expected > MOST_FALSE_ALARMS:
            return (
                f"{agreeing} of {len(candidates)} candidates agree with a pose, as chance could "
                "have it where so little is foreseen"
            )
        if agreeing > self._options.min_markers:
            return outcome
        if predicted.squared_distance(outcome.pose) < FAR_CHI2:
            return outcome
        return f"{agreeing} matched markers give a pose far from the predicted one"

    def _refined(
        self, pair: ImagePair, time_s: float, coarse: Solution, predicted: PredictedPose
    ) -> Solution:
        """Fit the discs and solve again; where too few can be fitted, the coarse pose stands."""
        before = self._motion.shortly_before(time_s, coarse.pose, self._options.pair_gap_s)
        fitted = fit_markers(
            pair,
            self._camera,
            self._detector,
            self._markers,
            coarse.pose,
            before,
            self._blur,
            self._options,
        )
        range_m = float(np.linalg.norm(coarse.pose.translation))
        radius = expected_radius_px(self._markers.radius_m, range_m, self._focal_px)
        match = self._as_surveyed(fitted.match, coarse.pose)
        refined = self._solved(match, coarse.pose, radius, predicted)
        if isinstance(refined, str):
            return coarse
        self._blur = ExpectedBlur(
            self._options.psf_sigma_px,
            self._options.psf_tolerance_px,
            fitted.blur_px,
            fitted.crosstalk,
        )
        return refined

    def _by_own_noise(self, solution: Solution) -> Solution:
        """Solve again without what the calibration may be wrong by, which is only stated."""
        kept = solution.match.kept(solution.used)
        points = self._markers.points_in_target[kept.marker]
        problem = PnpProblem.weighted(self._camera, points, kept.points_px, kept.covariance_px2)
        pose = solve_pose(problem, solution.pose, self._options.solver).pose
        stated, scatter = (
            with_common_errors(self._camera, points, pose, kept.covariance_px2, told)
            for told in (self._calibration, {})
        )
        return replace(solution, pose=pose, covariance=stated, scatter=scatter)

    def _as_surveyed(self, match: Match, pose: RigidTransform) -> Match:
        """Widen each point's covariance by what its marker's survey may be wrong by."""
        points = self._markers.points_in_target[match.marker]
        wider = place_covariance_px2(self._camera, points, pose, self._sigmas)
        return Match(match.points_px, match.covariance_px2 + wider, match.marker)

    # What to say.

    def _detections(self, sighting: _Sighting, solution: Solution) -> Detections:
        """List the solution's points, then the candidates that are none of them."""
        match = solution.match
        points, sigma = [*match.points_px], [*match.sigma_px]
        marker, used = match.marker.tolist(), solution.used.tolist()
        reprojected = self._camera.project(solution.pose @ self._markers.points_in_target)
        depth = float(solution.pose.translation[2])
        reach = max(1.5, 0.5 * self._markers.radius_m * self._focal_px / max(depth, 1e-3))
        coarse = self._coarse_sigma_px(2.0 * reach)
        for point in sighting.candidates.points_px:
            if len(match) and np.linalg.norm(match.points_px - point, axis=1).min() < reach:
                continue
            gap = np.nan_to_num(np.linalg.norm(reprojected - point, axis=1), nan=np.inf)
            nearest = int(np.argmin(gap))
            refused = gap[nearest] < reach and nearest not in marker
            points.append(point)
            sigma.append(np.full(2, coarse))
            marker.append(nearest if refused else -1)
            used.append(False)
        return Detections(
            points_px=np.array(points).reshape(-1, 2),
            sigma_px=np.array(sigma).reshape(-1, 2),
            marker=tuple(int(index) for index in marker),
            used=tuple(bool(kept) for kept in used),
        )

    def _unmatched(self, candidates: Candidates) -> Detections:
        count = len(candidates)
        return Detections(
            points_px=candidates.points_px,
            sigma_px=np.full((count, 2), self._options.centroid_sigma_px),
            marker=(-1,) * count,
            used=(False,) * count,
        )

    def _explained(self, pair: ImagePair, predicted: PredictedPose, reason: str) -> str:
        """Say so if the pair makes sense the other way round."""
        if not shines_swapped(pair):
            return reason
        if not isinstance(self._look(swapped(pair), predicted).outcome, str):
            return (
                "the markers shine in the 800 nm image, not in the 850 nm one: "
                "the two images are swapped"
            )
        return reason

    # Sizes.

    def _growth(self, predicted: PredictedPose) -> float:
        return min(1.0 + self._options.gate_growth * predicted.lost_frames, MOST_GROWTH)

    def _gate_px(self, predicted: PredictedPose) -> float:
        range_m = float(np.linalg.norm(predicted.pose.translation))
        separation = self._markers.min_separation_m
        gate = identification_gate_px(separation, range_m, self._focal_px, self._options.s_id)
        return gate * self._growth(predicted)

    @staticmethod
    def _coarse_sigma_px(radius_px: float) -> float:
        return float(np.hypot(COARSE_SIGMA_PX, COARSE_SIGMA_RADII * radius_px))

    @staticmethod
    def _match(candidates: Candidates, matched: Indices, sigma_px: float) -> Match:
        taken = matched >= 0
        points: Floats = candidates.points_px[taken]
        each = np.broadcast_to(sigma_px**2 * np.eye(2), (len(points), 2, 2))
        return Match(points, each, matched[taken])

    def _require_size(self, frame: int, pair: ImagePair) -> None:
        expected = (self._camera.height, self._camera.width)
        if pair.image_850.shape != expected:
            raise DatasetError(
                f"frame {frame}: expected images of {expected[1]} x {expected[0]} pixels, "
                f"as the camera's, got {pair.image_850.shape[1]} x {pair.image_850.shape[0]}; "
                "give the camera that took them"
            )
