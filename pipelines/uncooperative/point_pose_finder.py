"""Poses of an uncooperative target from unnamed points: as printed, and at their best.

As printed: Algorithm 1 acquires, SoftPOSIT tracks and its own pose is the measurement (Pesce et
al. 2019, section III). At its best: landmark triples acquire; nearest matches track where the
prediction is good, SoftPOSIT where they do not convince; and the pose is the least-squares one of
the matches, at the Cramer-Rao bound.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Indices
from models.estimate import Detections, Estimate, PoseEstimate
from models.pose import RigidTransform
from models.wireframe.visibility import visible_landmarks
from pipelines.acquisition.hypothesize_and_test import hypothesize_and_test
from pipelines.acquisition.triple_search import TripleSearch
from pipelines.pnp.gauss_newton import linearised
from pipelines.tracking.point_fit import PointFit, covariance_of, fit_points
from pipelines.tracking.softposit import first_beta, softposit
from pipelines.uncooperative.knowledge import PointFrame, UncooperativeKnowledge
from pipelines.uncooperative.options import UncooperativeOptions

RAW_EXCESS_VARIANCE = 2.25  # of SoftPOSIT's own pose over the bound of its matches, measured
FURTHEST_GATE_PX = 60.0  # beyond it nearest matches mean nothing


class PointPoseFinder:
    """Finds poses in point frames; see ``pipelines.uncooperative.pose_finder``.

    Parameters
    ----------
    knowledge : UncooperativeKnowledge
    options : UncooperativeOptions
    """

    def __init__(self, knowledge: UncooperativeKnowledge, options: UncooperativeOptions) -> None:
        self._target = knowledge.target
        self._camera = knowledge.camera
        self._sigma_px = knowledge.sigma_px
        self._focal_px = 0.5 * (knowledge.camera.fx + knowledge.camera.fy)
        self._options = options
        self._range_m = knowledge.range_m
        self._search: TripleSearch | None = None

    def acquire(self, frame: PointFrame) -> Estimate:
        """Find the pose without any earlier one."""
        if self._options.acquisition == "triple_search":
            return self._by_triples(frame)
        found = hypothesize_and_test(
            frame.points_px,
            self._target,
            self._camera,
            self._sigma_px,
            frame.index,
            self._options.algorithm_1,
        )
        if isinstance(found, str):
            return self._none(frame, found)
        return self._raw_estimate(frame, found.pose, found.matched)

    def track(self, frame: PointFrame, predicted: RigidTransform, covariance: Floats) -> Estimate:
        """Find the pose near a predicted one.

        Parameters
        ----------
        frame : PointFrame
        predicted : RigidTransform
            ``cam_from_target``.
        covariance : (6, 6) array, rad and m
            Of the prediction: rotation first, as in ``RigidTransform.perturbed``.
        """
        if len(frame.points_px) < 4:
            return self._none(frame, f"{len(frame.points_px)} corners in the image, 4 are needed")
        landmarks = self._shown(predicted)
        if len(landmarks) < 4:
            return self._none(frame, "the predicted pose shows fewer than 4 landmarks")
        spread_px2 = self._reprojection_variance_px2(predicted, covariance, landmarks)
        if self._options.refine:
            return self._refined(frame, predicted, landmarks, spread_px2)
        return self._raw(frame, predicted, landmarks, spread_px2)

    @property
    def found_anew(self) -> bool:
        """Never: points are matched near the prediction."""
        return False

    def matched_share(self, frame: PointFrame, estimate: Estimate) -> float:
        """Return the share matched of the points or of the landmarks shown, the fewer of both."""
        if estimate.pose is None:
            return 0.0
        matched = sum(estimate.detected.used)
        shown = len(self._shown(estimate.pose.cam_from_target))
        return matched / max(min(len(frame.points_px), shown), 1)

    # Acquisition.

    def _by_triples(self, frame: PointFrame) -> Estimate:
        if self._search is None:
            target = self._target
            self._search = TripleSearch(
                target,
                self._camera,
                self._sigma_px,
                self._options.triple_search,
                self._range_m,
                (lambda pose: visible_landmarks(target, pose))
                if self._options.hidden_landmarks
                else None,
            )
        found = self._search.acquire(frame.points_px)
        return self._none(frame, found) if isinstance(found, str) else self._said(frame, found.fit)

    # Tracking.

    def _refined(
        self,
        frame: PointFrame,
        predicted: RigidTransform,
        landmarks: Indices,
        spread_px2: float,
    ) -> Estimate:
        near = self._fitted(frame, predicted, landmarks, spread_px2)
        if not isinstance(near, str) and self._sure(near, frame, landmarks):
            return self._said(frame, near)
        annealed = softposit(
            frame.points_px,
            self._target.points_in_target[landmarks],
            self._camera,
            predicted,
            self._sigma_px,
            first_beta(spread_px2 + 2.0 * self._sigma_px**2),
            self._options.softposit,
        )
        far: PointFit | str = "SoftPOSIT found no pose"
        if annealed.pose is not None:
            named = np.where(annealed.matched >= 0, landmarks[annealed.matched], -1)
            far = self._fitted(frame, annealed.pose, landmarks, 0.0, named)
        fits = [one for one in (near, far) if not isinstance(one, str)]
        if not fits:
            return self._none(frame, str(far))
        best = max(fits, key=lambda one: (one.matches, -one.residual_rms_px))
        doubt = self._doubt(best.matches, best.residual_rms_px, frame, landmarks)
        return self._none(frame, doubt) if doubt else self._said(frame, best)

    def _fitted(
        self,
        frame: PointFrame,
        start: RigidTransform,
        landmarks: Indices,
        spread_px2: float,
        named: Indices | None = None,
    ) -> PointFit | str:
        gate_px = self._options.gate_sigmas * self._sigma_px
        first_px = self._options.gate_sigmas * float(np.sqrt(0.5 * spread_px2 + self._sigma_px**2))
        return fit_points(
            frame.points_px,
            self._target.points_in_target,
            self._camera,
            start,
            self._sigma_px,
            min(first_px, FURTHEST_GATE_PX),
            gate_px,
            named,
            landmarks,
        )

    def _raw(
        self,
        frame: PointFrame,
        predicted: RigidTransform,
        landmarks: Indices,
        spread_px2: float,
    ) -> Estimate:
        annealed = softposit(
            frame.points_px,
            self._target.points_in_target[landmarks],
            self._camera,
            predicted,
            self._sigma_px,
            first_beta(spread_px2 + 2.0 * self._sigma_px**2),
            self._options.softposit,
        )
        if annealed.pose is None:
            return self._none(frame, "SoftPOSIT found no pose")
        matched = np.where(annealed.matched >= 0, landmarks[annealed.matched], -1)
        return self._raw_estimate(frame, annealed.pose, matched, landmarks)

    def _raw_estimate(
        self,
        frame: PointFrame,
        pose: RigidTransform,
        matched: Indices,
        landmarks: Indices | None = None,
    ) -> Estimate:
        """Say a pose that is not the least-squares one of its matches."""
        taken = matched >= 0
        points = self._target.points_in_target[matched[taken]]
        covariance = covariance_of(pose, points, self._focal_px, self._sigma_px)
        if covariance is None or taken.sum() < 4:
            return self._none(frame, f"{int(taken.sum())} matches do not determine a pose")
        left = frame.points_px[taken] - self._camera.project(pose @ points)
        if not np.isfinite(left).all():
            return self._none(frame, "the pose found puts matched landmarks out of sight")
        rms_px = float(np.sqrt(np.mean(left**2)))
        if landmarks is not None:
            doubt = self._doubt(int(taken.sum()), rms_px, frame, landmarks)
            if doubt:
                return self._none(frame, doubt)
        fit = PointFit(pose, RAW_EXCESS_VARIANCE * covariance, matched, rms_px, True)
        return self._said(frame, fit)

    # What is believed.

    def _sure(self, fit: PointFit, frame: PointFrame, landmarks: Indices) -> bool:
        options = self._options
        share = fit.matches / min(len(frame.points_px), len(landmarks))
        residual = fit.residual_rms_px / self._sigma_px
        return (
            fit.rested
            and share >= options.share_to_be_sure
            and residual < options.max_residual_sigmas
        )

    def _doubt(
        self, matches: int, rms_px: float, frame: PointFrame, landmarks: Indices
    ) -> str | None:
        options = self._options
        expected = min(len(frame.points_px), len(landmarks))
        if matches < max(options.share_to_believe * expected, 4):
            return (
                f"{matches} of {len(frame.points_px)} corners match one of {len(landmarks)} "
                f"landmarks; {100 * options.share_to_believe:.0f} % are needed"
            )
        limit_px = options.max_residual_sigmas * self._sigma_px
        if rms_px > limit_px:
            return f"{rms_px:.1f} px rms are left; {limit_px:.1f} px are allowed"
        return None

    def _shown(self, pose: RigidTransform) -> Indices:
        if not self._options.hidden_landmarks:
            return np.arange(len(self._target))
        return np.flatnonzero(visible_landmarks(self._target, pose))

    def _reprojection_variance_px2(
        self, predicted: RigidTransform, covariance: Floats, landmarks: Indices
    ) -> float:
        """Return the mean squared distance by which the prediction misses a landmark, px^2."""
        _, jacobian = linearised(
            predicted.rotation[None],
            predicted.translation[None],
            self._target.points_in_target[landmarks],
        )
        flat = jacobian[0].reshape(6, -1)
        total = float(np.einsum("im,ij,jm->", flat, covariance, flat, optimize=True))
        return self._focal_px**2 * total / len(landmarks)

    # What to say.

    def _said(self, frame: PointFrame, fit: PointFit) -> Estimate:
        return Estimate(
            frame=frame.index,
            time_s=frame.time_s,
            pose=PoseEstimate(fit.pose, fit.covariance, fit.residual_rms_px),
            detections=self._detections(frame, fit.matched),
        )

    def _none(self, frame: PointFrame, reason: str) -> Estimate:
        unmatched = np.full(len(frame.points_px), -1, dtype=np.int64)
        return Estimate(
            frame.index, frame.time_s, reason=reason, detections=self._detections(frame, unmatched)
        )

    def _detections(self, frame: PointFrame, matched: Indices) -> Detections:
        return Detections(
            points_px=frame.points_px,
            sigma_px=np.full(frame.points_px.shape, self._sigma_px),
            marker=tuple(matched.tolist()),
            used=tuple((matched >= 0).tolist()),
        )
