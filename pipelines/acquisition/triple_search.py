"""Acquisition at its best: every landmark triple is tried on a few image triples.

Three image points that are landmarks belong to some ordered triple of landmarks. There are few
enough of those (12,144 for 24 landmarks) to try them all at once, so that nothing is left to
chance but whether the three points are landmarks. The poses are voted for by all landmarks, the
best are refined, and a pose is believed that explains the image and that no other pose rivals.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from models.arrays import Floats, Indices, Mask
from models.camera import Camera
from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe
from pipelines.acquisition.acquisition_options import TripleSearchOptions
from pipelines.acquisition.pca_classes import pca_classes
from pipelines.acquisition.pose_refinement import RefinedPoses, refined_poses
from pipelines.acquisition.three_point_poses import LandmarkTriples, three_point_poses
from pipelines.acquisition.vote_map import VoteMap
from pipelines.tracking.point_fit import PointFit, fit_points

OUTERMOST = 14  # image points of which triples are made
USED_AGAIN = 0.5  # worth of a triple for each earlier use of one of its points
MOST_LANDMARKS = 40  # of which every triple is tried; of more, those that lie furthest out
SAME_SHARE = 0.02  # of the target's radius: poses that move no landmark further are one
KEPT = 24  # poses of each image triple that are remembered as candidates


@dataclass(frozen=True, eq=False)
class Acquisition:
    """A pose found without any earlier one.

    Attributes
    ----------
    fit : PointFit
    share_of_points, share_of_landmarks : float
        Of the image points, and of the landmarks that the pose shows, that are matched.
    margin : float
        Log-likelihood above the best other pose.
    equivalent : tuple of RigidTransform
        Poses that the target's symmetries make as good; no image of its edges tells them apart.
    image_triples : int
        How many were tried.
    """

    fit: PointFit
    share_of_points: float
    share_of_landmarks: float
    margin: float
    equivalent: tuple[RigidTransform, ...]
    image_triples: int


@dataclass(frozen=True, eq=False)
class _Candidate:
    rotation: Floats
    translation: Floats
    log_likelihood: float
    matches: int


class TripleSearch:
    """The search for one target and one camera; its tables are made once.

    Parameters
    ----------
    target : Wireframe
    camera : Camera
    sigma_px : float, px
        1-sigma of an image point, per axis.
    options : TripleSearchOptions, optional
    range_m : (float, float), optional, m
        Nearest and farthest range, if known; without it, any range that has the whole target in
        front of the camera.
    visible : callable, optional
        Takes ``cam_from_target`` and returns which landmarks show, (m,) bool; without it, all.
    """

    def __init__(
        self,
        target: Wireframe,
        camera: Camera,
        sigma_px: float,
        options: TripleSearchOptions | None = None,
        range_m: tuple[float, float] | None = None,
        visible: Callable[[RigidTransform], Mask] | None = None,
    ) -> None:
        self._target = target
        self._camera = camera
        self._sigma_px = sigma_px
        self._focal_px = 0.5 * (camera.fx + camera.fy)
        self._options = options or TripleSearchOptions()
        self._range_m = range_m or (target.radius_m, np.inf)
        self._visible = visible
        points = target.points_in_target
        outermost = np.argsort(-np.linalg.norm(points, axis=1), kind="stable")[:MOST_LANDMARKS]
        self._appendages = LandmarkTriples.among(points, np.flatnonzero(target.appendage))
        self._every = LandmarkTriples.among(points, np.sort(outermost))

    def acquire(self, points_px: Floats) -> Acquisition | str:
        """Find the pose from the points of one image.

        Parameters
        ----------
        points_px : (n, 2) array, px

        Returns
        -------
        Acquisition or str
            In words, why there is none.
        """
        options = self._options
        if len(points_px) < options.least_matches:
            return (
                f"{len(points_px)} corners in the image, at least {options.least_matches} are "
                "needed to find a pose from one image alone"
            )
        normalised = self._camera.normalise(points_px)
        votes = VoteMap(self._focal_px * normalised, options.vote_sigmas * self._sigma_px)
        candidates: list[_Candidate] = []
        outcome: Acquisition | str = "no three image points gave a pose"
        tried = 0
        for chosen, triples in self._proposals(points_px):
            candidates += self._candidates(normalised, chosen, triples, votes)
            tried += 1
            if tried < options.confirming_triples or not candidates:
                continue
            outcome = self._judged(points_px, candidates, tried)
            if not isinstance(outcome, str):
                return outcome
        return outcome

    def _proposals(self, points_px: Floats) -> Iterator[tuple[Indices, LandmarkTriples]]:
        """Yield image triples with the landmark triples to try on them, the likeliest first."""
        far = pca_classes(points_px).either
        if len(far) >= 3 and len(self._appendages):
            for chosen in wide_triples(points_px, far, self._options.appendage_triples):
                yield chosen, self._appendages
        every = np.arange(len(points_px))
        for chosen in wide_triples(points_px, every, self._options.whole_triples):
            yield chosen, self._every

    def _candidates(
        self, normalised: Floats, chosen: Indices, triples: LandmarkTriples, votes: VoteMap
    ) -> list[_Candidate]:
        points = self._target.points_in_target
        rays = np.column_stack([normalised[chosen], np.ones(3)])
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        rotations, translations, _ = three_point_poses(rays, triples)
        away = np.linalg.norm(translations, axis=1)
        reachable = (away > self._range_m[0]) & (away < self._range_m[1])
        reachable &= translations[:, 2] > 0.0
        rotations, translations = rotations[reachable], translations[reachable]
        if not len(rotations):
            return []
        score = votes.votes_for(rotations, translations, points, self._focal_px)
        pool = min(self._options.pool, len(score))
        best = np.sort(np.argpartition(-score, pool - 1)[:pool])
        refined = refined_poses(
            rotations[best],
            translations[best],
            points,
            normalised,
            self._sigma_px / self._focal_px,
            self._options.gate_sigmas,
        )
        return _best_of(refined)

    def _judged(
        self, points_px: Floats, candidates: list[_Candidate], tried: int
    ) -> Acquisition | str:
        """Believe the best candidate, or say why not."""
        options = self._options
        ordered = sorted(candidates, key=lambda one: -one.log_likelihood)
        first = ordered[0]
        if first.matches < 4:
            return "no pose matches four landmarks"
        fit = self._fitted(points_px, first)
        if isinstance(fit, str):
            return fit
        shown = np.ones(len(self._target), dtype=np.bool_)
        if self._visible is not None:
            shown = self._visible(fit.pose)
        of_points = fit.matches / len(points_px)
        of_landmarks = fit.matches / max(int(shown.sum()), 1)
        if (
            fit.matches < options.least_matches
            or of_points < options.share_of_points
            or of_landmarks < options.share_of_landmarks
        ):
            return (
                f"the best pose matches {fit.matches} of {len(points_px)} corners and of "
                f"{int(shown.sum())} landmarks; at least {100 * options.share_of_points:.0f} % and "
                f"{100 * options.share_of_landmarks:.0f} % are needed"
            )
        rival = next(
            (one for one in ordered[1:] if not self._same(fit.pose, one)),
            None,
        )
        margin = np.inf if rival is None else first.log_likelihood - rival.log_likelihood
        if margin < options.margin:
            assert rival is not None
            return (
                f"two poses explain the image: {first.matches} and {rival.matches} landmarks "
                "matched; the next image may tell"
            )
        symmetries = self._target.symmetries
        equivalent = tuple(
            RigidTransform(fit.pose.rotation @ turn, fit.pose.translation) for turn in symmetries
        )
        return Acquisition(fit, of_points, of_landmarks, float(margin), equivalent, tried)

    def _fitted(self, points_px: Floats, candidate: _Candidate) -> PointFit | str:
        points = self._target.points_in_target
        start = RigidTransform(candidate.rotation, candidate.translation)
        gate_px = self._options.gate_sigmas * self._sigma_px
        shown = None if self._visible is None else np.flatnonzero(self._visible(start))
        return fit_points(
            points_px,
            points,
            self._camera,
            start,
            self._sigma_px,
            gate_px,
            gate_px,
            shown=shown,
        )

    def _same(self, pose: RigidTransform, other: _Candidate) -> bool:
        """Tell whether two poses move no landmark apart, but for a symmetry."""
        points = self._target.points_in_target
        limit = SAME_SHARE * self._target.radius_m
        seen = points @ other.rotation.T + other.translation
        # Depth is the least certain direction: what counts is where the landmarks are seen.
        seen = seen[:, :2] / np.maximum(seen[:, 2:], 1e-3)
        for turn in (np.eye(3), *self._target.symmetries):
            in_cam = points @ (pose.rotation @ turn).T + pose.translation
            gap = np.abs(in_cam[:, :2] / in_cam[:, 2:] - seen) * in_cam[:, 2:]
            if gap.max() < limit:
                return True
        return False


def _best_of(refined: RefinedPoses) -> list[_Candidate]:
    order = np.argsort(-refined.log_likelihood, kind="stable")[:KEPT]
    matches = refined.matches
    return [
        _Candidate(
            refined.rotations[index],
            refined.translations[index],
            float(refined.log_likelihood[index]),
            int(matches[index]),
        )
        for index in order
    ]


def wide_triples(points_px: Floats, chosen: Indices, count: int) -> list[Indices]:
    """Pick wide triangles among image points, without leaning on one point too often.

    Parameters
    ----------
    points_px : (n, 2) array, px
    chosen : (k,) int array
        Points that may be picked.
    count : int
        Triples wanted.

    Returns
    -------
    list of (3,) int arrays
        No more than ``count``; which points, the widest triangle first.
    """
    away = np.linalg.norm(points_px - np.median(points_px, axis=0), axis=1)
    outer = chosen[np.argsort(-away[chosen], kind="stable")[:OUTERMOST]]
    triples = np.array(list(combinations(outer, 3)), dtype=np.int64).reshape(-1, 3)
    if not len(triples):
        return []
    first, second, third = (points_px[triples[:, n]] for n in range(3))
    one, two = second - first, third - first
    worth = np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    picked = []
    for _ in range(min(count, len(triples))):
        best = int(worth.argmax())
        picked.append(triples[best])
        uses = (triples[:, :, None] == triples[best]).any(axis=2).sum(axis=1)
        worth = worth * USED_AGAIN**uses
        worth[best] = -1.0
    return picked
