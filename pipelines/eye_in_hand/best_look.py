"""One look at its best: circles, identification, rims, all poses that fit, the outline in need."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Image, Indices
from models.estimate import NO_STATES, Detections, NamedState, PoseEstimate
from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe
from pipelines.detection.disc_outline import disc_outlines
from pipelines.detection.dot_candidates import DotCandidates
from pipelines.detection.lit_disc import KnownDisc
from pipelines.detection.marker_search import PredictedMarkers, predict_markers
from pipelines.eye_in_hand.board_outline import pose_from_outline
from pipelines.eye_in_hand.circle_search import circles_near
from pipelines.eye_in_hand.dot_identification import rank_matches
from pipelines.eye_in_hand.dot_refinement import NO_CIRCLE_PX, FittedDots, fit_dots
from pipelines.eye_in_hand.options import EyeInHandOptions
from pipelines.eye_in_hand.sighting import Sighting, blind
from pipelines.pnp.flight_knowledge import FlightKnowledge
from pipelines.pnp.match import Match, Solution
from pipelines.pnp.predicted_pose import PredictedPose
from pipelines.pnp.robust_pose import residuals_px, solve_match
from pipelines.pnp.three_points import FittingPose, poses_of_three
from pipelines.pnp.told_errors import place_covariance_px2, with_common_errors

SETTLED_PX, SETTLED_SIZE = 0.5, 0.02  # a rim fitted nearer to its pose than this need not be anew
MOST_SIZE_ERROR = 0.05  # of a fitted dot, against the pose that the dots give
CIRCLE_PX, CIRCLE_SHARE = 1.0, 0.02  # 1-sigma of a circle's centre, and in its radii
CIRCLE_RADIUS_PX = 0.5  # 1-sigma of a circle's radius, at half the resolution
GROWTH, MOST_GROWTH = 0.5, 4.0
RADIUS_KEY, NORMAL_KEY = "markers.radius_m", "markers.normal_in_target_deg"
REFITS = 2
ROUGH_SIZE, ROUGH_SHAPE = 0.03, 0.01
CAPTURE_SIGMAS, CAPTURE_SHARE = 3.0, 0.25  # of a prediction, and in radii


@dataclass(frozen=True, eq=False)
class _Found:
    """A pose from dots, and what else fits them."""

    pose: RigidTransform
    covariance: Floats
    match: Match
    used: tuple[bool, ...]
    residual_rms_px: float
    rival: FittingPose | None = None
    lead: float = np.inf


class BestLook:
    """Looks at frames, and learns the lens's blur from them.

    Parameters
    ----------
    knowledge : FlightKnowledge
    options : EyeInHandOptions
    board : Wireframe or None
    blur_px : float, px
        Expected 1-sigma of the lens's blur.
    sigmas : mapping of str to float
        1-sigma of what is told otherwise than it is.
    """

    def __init__(
        self,
        knowledge: FlightKnowledge,
        options: EyeInHandOptions,
        board: Wireframe | None,
        blur_px: float,
        sigmas: Mapping[str, float],
    ) -> None:
        self._camera, self._detector = knowledge.camera, knowledge.detector
        self._markers, self._options = knowledge.markers, options
        self._board, self._blur_px, self._sigmas = board, blur_px, sigmas
        told = sigmas.get(RADIUS_KEY, 0.0) / knowledge.markers.radius_m
        self._size_sigma = float(np.hypot(0.003, told))

    def look(self, raw: Image, predicted: PredictedPose) -> Sighting:
        """Find a pose, or say why there is none.

        Parameters
        ----------
        raw : (height, width) uint16 array, DN
        predicted : PredictedPose
        """
        dots = predict_markers(self._camera, self._markers, predicted)
        if dots is None:
            return blind("no dot faces the camera in the predicted pose")
        followed = self._followed(raw, dots, predicted)
        if followed is not None:
            return self._said(DotCandidates.none(), followed)
        circles = self._circles(raw, dots, predicted)
        ranked = rank_matches(
            self._camera,
            self._markers,
            predicted,
            dots.outlines,
            circles,
            CIRCLE_PX + CIRCLE_SHARE * dots.radius_px,
            self._options.region_sigmas * self._growth(predicted),
        )
        reason, fitted = "", None
        for chosen in ranked:
            rough = self._fitted(raw, circles, chosen, predicted)
            outcome, last = self._posed(raw, rough, predicted)
            if not isinstance(outcome, str):
                return self._said(circles, outcome)
            reason = reason or outcome
            if fitted is None or len(last.match) > len(fitted.match):
                fitted = last
        assert fitted is not None  # one assignment is that no dot has a circle
        return self._by_outline(raw, circles, fitted, predicted, reason)

    # Dots.

    def _followed(
        self, raw: Image, dots: PredictedMarkers, predicted: PredictedPose
    ) -> _Found | None:
        """Fit all rims where the prediction has them, if it is good enough for that."""
        sigma = _largest_sigma_px(dots)
        least_px = float(np.nanmin(dots.outlines.radii_px))
        capture_px = CAPTURE_SIGMAS * sigma
        if not capture_px < CAPTURE_SHARE * least_px:
            return None
        known = KnownDisc(_size_sigma(predicted), ROUGH_SHAPE, capture_px)
        fitted = self._refitted(raw, predicted.pose, self._blur_px, known)
        if len(fitted.match) < len(self._markers):
            return None
        outcome, _ = self._posed(raw, fitted, predicted)
        return None if isinstance(outcome, str) else outcome

    def _refitted(
        self, raw: Image, pose: RigidTransform, blur_px: float, known: KnownDisc
    ) -> FittedDots:
        nowhere = np.full((len(self._markers), 2), np.nan)
        return fit_dots(
            raw, self._camera, self._detector, self._markers, pose, nowhere, blur_px, known
        )

    def _known(self, found: _Found) -> KnownDisc:
        """Return how well a pose tells the rims: an ellipse's small axis goes by a cosine."""
        outlines = disc_outlines(self._camera, found.pose, self._markers)
        small, large = np.linalg.eigvalsh(outlines.shapes_px2[outlines.facing]).T
        sine = float(np.sqrt(1.0 - np.min(small / large, initial=1.0)))
        turn = np.hypot(
            np.deg2rad(self._sigmas.get(NORMAL_KEY, 0.0)),
            np.sqrt(np.linalg.eigvalsh(found.covariance[:3, :3])[-1]),
        )
        shape = float(sine * turn + 0.5 * turn**2)
        return KnownDisc(self._size_sigma, min(shape, ROUGH_SHAPE))

    def _circles(
        self, raw: Image, dots: PredictedMarkers, predicted: PredictedPose
    ) -> DotCandidates:
        slack = self._growth(predicted) * self._options.region_sigmas * _largest_sigma_px(dots)
        return circles_near(raw, self._camera, self._detector, dots, slack, self._options)

    def _fitted(
        self, raw: Image, circles: DotCandidates, chosen: Indices, predicted: PredictedPose
    ) -> FittedDots:
        """Fit the rims of the circles that were chosen."""
        outlines = disc_outlines(self._camera, predicted.pose, self._markers)
        centres, sizes = np.full((len(chosen), 2), NO_CIRCLE_PX), np.ones(len(chosen))
        has_one = chosen >= 0
        centres[has_one] = circles.centres[chosen[has_one]]
        sizes[has_one] = circles.radii[chosen[has_one]] / outlines.radii_px[has_one]
        # Rough shapes do for rough centres: the size is left nearly free.
        seen = CIRCLE_RADIUS_PX / float(np.nanmin(outlines.radii_px))
        return fit_dots(
            raw, self._camera, self._detector, self._markers, predicted.pose, centres,
            self._blur_px, KnownDisc(max(_size_sigma(predicted), seen), ROUGH_SHAPE), sizes,
        )  # fmt: skip

    def _posed(
        self, raw: Image, rough: FittedDots, predicted: PredictedPose
    ) -> tuple[_Found | str, FittedDots]:
        """Solve for the pose of roughly fitted dots, fit all rims from there, and solve again.

        Returns the pose, or why there is none, and the dots as they were fitted last.
        """
        fitted, outcome = rough, self._solved(rough.match, predicted)
        for _ in range(REFITS):
            if isinstance(outcome, str):
                return self._told(outcome, fitted), fitted
            fitted = self._refitted(raw, outcome.pose, fitted.blur_px, self._known(outcome))
            outcome = self._solved(fitted.match, predicted)
            if fitted.furthest_px < SETTLED_PX and fitted.worst_size < SETTLED_SIZE:
                break
        if isinstance(outcome, str):
            return self._told(outcome, fitted), fitted
        if fitted.worst_size > MOST_SIZE_ERROR:
            off = 100.0 * fitted.worst_size
            return f"a dot is {off:.0f} % off the size that the pose gives it", fitted
        self._blur_px = fitted.blur_px
        return outcome, fitted

    @staticmethod
    def _told(reason: str, fitted: FittedDots) -> str:
        return reason + "".join(
            f"; dot {index + 1}: {why}" for index, why in sorted(fitted.refused.items())
        )

    def _solved(self, match: Match, predicted: PredictedPose) -> _Found | str:
        options, count = self._options, len(match)
        if count < options.min_markers:
            return f"{count} of the {len(self._markers)} dots found, {options.min_markers} needed"
        if count > 3:
            return self._solved_by_many(match, predicted)
        fits = poses_of_three(self._camera, self._markers, match, predicted, options.solver)
        if not fits:
            return "no pose fits the three dots"
        best, rival = fits[0], fits[1] if len(fits) > 1 else None
        if best.squared_distance > options.farthest_chi2:
            return "the three dots give a pose far from the predicted one"
        lead = np.inf if rival is None else rival.squared_distance - best.squared_distance
        if lead < options.decisive_chi2:
            return "the pose is ambiguous: two fit the three dots, and the prediction does not tell"
        left = residuals_px(self._camera, self._markers, match, best.pose)
        rms = float(np.sqrt(np.mean(left**2)))
        covariance = self._with_told_errors(match, best.pose)
        return _Found(best.pose, covariance, match, (True,) * count, rms, rival, float(lead))

    def _solved_by_many(self, match: Match, predicted: PredictedPose) -> _Found | str:
        radius = self._markers.radius_m * self._camera.fx / predicted.pose.translation[2]
        outcome = solve_match(
            self._camera, self._markers, match, predicted.pose, radius, self._options, predicted
        )
        if isinstance(outcome, str):
            return outcome
        if predicted.squared_distance(outcome.pose) > self._options.farthest_chi2:
            return "the dots give a pose far from the predicted one"
        return self._of(outcome)

    def _of(self, solution: Solution) -> _Found:
        kept = solution.match.kept(solution.used)
        covariance = self._with_told_errors(kept, solution.pose)
        used = tuple(bool(each) for each in solution.used)
        return _Found(solution.pose, covariance, solution.match, used, solution.residual_rms_px)

    def _with_told_errors(self, match: Match, pose: RigidTransform) -> Floats:
        points = self._markers.points_in_target[match.marker]
        return with_common_errors(self._camera, points, pose, match.covariance_px2, self._sigmas)

    # The outline.

    def _by_outline(
        self,
        raw: Image,
        circles: DotCandidates,
        fitted: FittedDots,
        predicted: PredictedPose,
        reason: str,
    ) -> Sighting:
        seen = self._detections(circles, fitted.match, (False,) * len(fitted.match))
        if self._board is None or len(fitted.match) > 2:
            return Sighting(None, reason, seen)
        dots = self._as_surveyed(fitted.match, predicted.pose)
        solved = pose_from_outline(
            raw, self._camera, self._detector, self._markers, self._board, dots, predicted.pose,
            predicted.covariance, fitted.blur_px, self._options.outline_sigma_m,
        )  # fmt: skip
        if isinstance(solved, str):
            return Sighting(None, f"{reason}, {solved}", seen)
        covariance = self._outline_covariance(solved.pose, solved.covariance)
        sigma = np.sqrt(np.diag(covariance))
        options = self._options
        if (
            sigma[3:].max() > options.most_sigma_m
            or np.rad2deg(sigma[:3].max()) > options.most_sigma_deg
        ):
            return Sighting(
                None,
                f"{reason}, and with the board's outline the pose is known to "
                f"{1e3 * sigma[3:].max():.0f} mm and {np.rad2deg(sigma[:3].max()):.1f} deg only",
                seen,
            )
        both = PredictedPose(predicted.pose, predicted.covariance + covariance, 0)
        if both.squared_distance(solved.pose) > options.farthest_chi2:
            return Sighting(
                None,
                f"{reason}, and the board's outline gives a pose far from the predicted one",
                seen,
            )
        seen = self._detections(circles, fitted.match, (True,) * len(fitted.match))
        pose = PoseEstimate(solved.pose, covariance, solved.residual_rms_px)
        return Sighting(pose, None, seen, "outline")

    def _as_surveyed(self, match: Match, pose: RigidTransform) -> Match:
        """Add what the dots' survey may be off by: beside edges they are not all there is."""
        points = self._markers.points_in_target[match.marker]
        own = place_covariance_px2(self._camera, points, pose, self._sigmas)
        return Match(match.points_px, match.covariance_px2 + own, match.marker)

    def _outline_covariance(self, pose: RigidTransform, own: Floats) -> Floats:
        """Add what the told errors do to the dots' part, as if the board's corners were points."""
        assert self._board is not None
        corners = self._board.points_in_target
        each = np.broadcast_to(np.eye(2), (len(corners), 2, 2))
        sigmas = {key: s for key, s in self._sigmas.items() if key.startswith("camera.")}
        with_errors = with_common_errors(self._camera, corners, pose, each, sigmas)
        without = with_common_errors(self._camera, corners, pose, each, {})
        return np.asarray(own + with_errors - without)

    # What to say.

    def _said(self, circles: DotCandidates, found: _Found) -> Sighting:
        states = NO_STATES
        if found.rival is not None:
            rival = found.rival.pose
            states = {
                "rival_pose": NamedState(
                    {
                        "R_cam_from_target": rival.rotation,
                        "t_cam_from_target_m": rival.translation,
                        "behind_chi2": np.array(found.lead),
                    }
                )
            }
        pose = PoseEstimate(found.pose, found.covariance, found.residual_rms_px)
        seen = self._detections(circles, found.match, found.used)
        return Sighting(pose, None, seen, "dots", states)

    def _detections(
        self, circles: DotCandidates, match: Match, used: tuple[bool, ...]
    ) -> Detections:
        """List the fitted dots, then the circles that are none of them."""
        points, sigma = [*match.points_px], [*match.sigma_px]
        marker, kept = [int(each) for each in match.marker], list(used)
        for centre, radius in zip(circles.centres, circles.radii, strict=True):
            if len(match) and np.linalg.norm(match.points_px - centre, axis=1).min() < radius:
                continue
            points.append(centre)
            sigma.append(np.full(2, CIRCLE_PX + CIRCLE_SHARE * radius))
            marker.append(-1)
            kept.append(False)
        return Detections(
            np.array(points).reshape(-1, 2),
            np.array(sigma).reshape(-1, 2),
            tuple(marker),
            tuple(kept),
        )

    @staticmethod
    def _growth(predicted: PredictedPose) -> float:
        return min(1.0 + GROWTH * predicted.lost_frames, MOST_GROWTH)


def _largest_sigma_px(dots: PredictedMarkers) -> float:
    return float(np.sqrt(np.nanmax(np.diagonal(dots.covariance_px2, axis1=1, axis2=2))))


def _size_sigma(predicted: PredictedPose) -> float:
    """Return the 1-sigma of the dots' sizes by a prediction of their distance, relative."""
    depth_m = float(predicted.pose.translation[2])
    return max(ROUGH_SIZE, 2.0 * float(np.sqrt(predicted.covariance[5, 5])) / depth_m)
