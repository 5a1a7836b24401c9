"""Rival poses carried from image to image, until what they explain together decides.

A rival is a motion: a pose in each image, a turn from one to the next that a target may make, and
from the third on at about the same rate. What is claimed is the end of the best, if the others are
so much worse that it is hardly wrong; how hardly was counted on starts of its own, with the Sun's
direction off as told.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.pose import RigidTransform
from pipelines.acquisition.under_sun import UnderSun

ALONE_SIGMAS = 4.0  # what a sole candidate of an image leads by
RANGE_SIGMA, RANGE_SIGMAS = 0.01, (1e-4, 1.0)


class Laid(Protocol):
    """What rivals take of a candidate; see ``pipelines.acquisition.candidate.Candidate``."""

    @property
    def pose(self) -> RigidTransform:
        """``cam_from_target``."""

    @property
    def score(self) -> float:
        """How it fits."""

    @property
    def light(self) -> float:
        """Share of the image's light that it explains."""

    @property
    def steps(self) -> float:
        """Share found of the steps in brightness that are due."""

    @property
    def brightness(self) -> float | None:
        """Share of the image's brightness that it explains, if that is known."""

    @property
    def range_sigma(self) -> float:
        """Of the range, as a share of it."""


L = TypeVar("L", bound=Laid)


@dataclass(frozen=True)
class RivalOptions:
    """What motion is possible, and what is believed.

    Attributes
    ----------
    fastest_deg_s : float, deg/s
        That a target turns, and
    slack_deg : float, deg
        what two poses may be off besides.
    steady_share : float
        By how much of itself a turn may differ from that foreseen at the rate before.
    moved_share : float
        Of the range: how far the target goes from image to image at most.
    another_view_deg : float, deg
        A turn after which an image tells all anew;
    least_weight : float
        of one after no turn so much of it counts, for noise and light are alike but not the same.
    most_rivals : int
        Carried on.
    most_wrong : float
        Probability of being wrong with which a pose is still claimed: so of all starts that belief
        was fitted to, 1 in 500 is expected to be.
    """

    fastest_deg_s: float = 4.0
    slack_deg: float = 8.0
    steady_share: float = 0.3
    moved_share: float = 0.05
    another_view_deg: float = 10.0
    least_weight: float = 0.25
    most_rivals: int = 8
    most_wrong: float = 0.0175


@dataclass(frozen=True)
class Standing:
    """What speaks for the best rival.

    Attributes
    ----------
    lead : float
        Weighted score by which it leads over the next that is another pose.
    light, steps : float
        Means over its images of the shares that it explains.
    range_sigma : float
        Of its last pose; see ``Laid``.
    brightness : float
        Mean over its images, likewise; 0 where it is not known.
    """

    lead: float
    light: float
    steps: float
    range_sigma: float
    brightness: float = 0.0


@dataclass(frozen=True)
class Belief:
    """Log-odds that the best rival is wrong: a sum of what speaks for it and against.

    Weights of ``bench.suites.uncooperative_suns.calibration`` on 648 images of 216 starts of XMM
    and Hispasat (1024 px, seeds 1 and 20).

    Attributes
    ----------
    constant, by_lead, by_light, by_steps, by_range : float
        Weights of 1; of the logarithm of 1 and the lead (a large one says that others are bad, not
        that this is right); of the shares explained; and of the decimal logarithm of the range's
        sigma over 1 %.
    least : float
        No claim is told to be surer: so few were counted.
    by_brightness : float
        Weight of the share of the brightness that is explained.
    """

    constant: float = 7.8
    by_lead: float = -0.82
    by_light: float = -7.11
    by_steps: float = -2.96
    by_range: float = 1.48
    least: float = 5e-3
    by_brightness: float = 0.0

    def terms(self, standing: Standing) -> Floats:
        """Return what the weights multiply, (6,): 1 first, and brightness last."""
        sigma = float(np.clip(standing.range_sigma, *RANGE_SIGMAS))
        return np.array(
            [
                1.0,
                np.log1p(max(standing.lead, 0.0)),
                standing.light,
                standing.steps,
                np.log10(sigma / RANGE_SIGMA),
                standing.brightness,
            ]
        )

    @property
    def weights(self) -> Floats:
        """(6,) array, in the order of ``terms``."""
        plain = [self.constant, self.by_lead, self.by_light, self.by_steps, self.by_range]
        return np.array([*plain, self.by_brightness])

    def wrong_probability(self, standing: Standing) -> float:
        """Return the probability that the best rival is wrong."""
        odds = float(np.clip(self.terms(standing) @ self.weights, -50.0, 50.0))
        return max(1.0 / (1.0 + float(np.exp(-odds))), self.least)


def belief_by_brightness() -> Belief:
    """Return the belief where the brightness that a pose must show is known.

    Weights of ``bench.suites.uncooperative_suns.calibration`` on the images that ``Belief`` has its
    own of.
    """
    return Belief(9.18, -0.68, -0.1, -2.15, 1.08, by_brightness=-11.36)


@dataclass(frozen=True, eq=False)
class Rival(Generic[L]):
    """A motion that the images so far allow.

    Attributes
    ----------
    times_s : tuple of float, s
        Of its images.
    poses : tuple of RigidTransform
    last : Laid
        Of the last image.
    score, weight : float
        Sums over all images, each weighted.
    explained, light, steps, brightness : float
        Sums over its own.
    """

    times_s: tuple[float, ...]
    poses: tuple[RigidTransform, ...]
    last: L
    score: float
    weight: float
    explained: float
    light: float
    steps: float
    brightness: float

    def foreseen(self, time_s: float) -> RigidTransform:
        """Return where its last rate takes it; where it was, from a single image."""
        if len(self.poses) < 2:
            return self.poses[-1]
        (before, last), (early, late) = self.poses[-2:], self.times_s[-2:]
        share = (time_s - late) / (late - early)
        turn = Rotation.from_matrix(before.rotation.T @ last.rotation).as_rotvec()
        rotation = last.rotation @ Rotation.from_rotvec(share * turn).as_matrix()
        place = last.translation + share * (last.translation - before.translation)
        return RigidTransform(rotation, place if place[2] > 0.0 else last.translation)


@dataclass(frozen=True, eq=False)
class Verdict(Generic[L]):
    """What the images so far come to.

    Attributes
    ----------
    best : Laid
    wrong_probability : float
    standing : Standing
        Of the best.
    other : RigidTransform or None
        The next one's pose in the last image.
    """

    best: L
    wrong_probability: float
    standing: Standing
    other: RigidTransform | None


class Rivals(Generic[L]):
    """Rivals over some images of one target.

    Parameters
    ----------
    looking : UnderSun
        Knows which poses are the same.
    options : RivalOptions
    belief : Belief
    by_brightness : Belief, optional
        In its place, where the brightness that a pose must show is known.
    """

    def __init__(
        self,
        looking: UnderSun,
        options: RivalOptions,
        belief: Belief,
        by_brightness: Belief | None = None,
    ) -> None:
        self._looking, self._options = looking, options
        self._belief, self._by_brightness = belief, by_brightness or belief
        self.carried: list[Rival[L]] = []
        self._weight = 0.0
        self._worst = 0.0

    def foreseen(self, time_s: float, most: int = 3) -> tuple[RigidTransform, ...]:
        """Return where the best rivals go, to be tried in the next image.

        Parameters
        ----------
        time_s : float, s
        most : int
            Of them.
        """
        return tuple(rival.foreseen(time_s) for rival in self.carried[:most])

    def add(self, time_s: float, candidates: tuple[L, ...]) -> Verdict[L]:
        """Take an image's candidates.

        Parameters
        ----------
        time_s : float, s
            Later than before.
        candidates : tuple of Laid
            One or more.
        """
        weight = self._weight_of(time_s, candidates)
        grown = [self._grown(time_s, candidate, weight) for candidate in candidates]
        self._weight += weight
        self._worst += weight * min(one.score for one in candidates)
        self.carried = sorted(grown, key=lambda rival: -rival.score)[: self._options.most_rivals]
        return self._verdict()

    def _weight_of(self, time_s: float, candidates: tuple[L, ...]) -> float:
        """Return what an image counts: little, if it shows the best rivals from where they were."""
        if not self.carried:
            return 1.0
        turn = _turn_deg(self.carried[0].poses[-1], candidates[0].pose)
        share = min(1.0, turn / self._options.another_view_deg)
        return max(self._options.least_weight, share)

    def _grown(self, time_s: float, candidate: L, weight: float) -> Rival[L]:
        """Return the best motion that ends in a candidate."""
        before = [rival for rival in self.carried if self._goes_on(rival, time_s, candidate.pose)]
        if not before:  # it explains nothing of the images before, as the worst of them did
            nothing = Rival((), (), candidate, self._worst, self._weight, 0.0, 0.0, 0.0, 0.0)
            return self._with(nothing, time_s, candidate, weight)
        best = max(before, key=lambda rival: rival.score)
        return self._with(best, time_s, candidate, weight)

    @staticmethod
    def _with(rival: Rival[L], time_s: float, candidate: L, weight: float) -> Rival[L]:
        return Rival(
            times_s=(*rival.times_s, time_s),
            poses=(*rival.poses, candidate.pose),
            last=candidate,
            score=rival.score + weight * candidate.score,
            weight=rival.weight + weight,
            explained=rival.explained + weight,
            light=rival.light + weight * candidate.light,
            steps=rival.steps + weight * candidate.steps,
            brightness=rival.brightness + weight * (candidate.brightness or 0.0),
        )

    def _goes_on(self, rival: Rival[L], time_s: float, pose: RigidTransform) -> bool:
        options, last = self._options, rival.poses[-1]
        away = float(np.linalg.norm(pose.translation - last.translation))
        if away > options.moved_share * last.translation[2]:
            return False
        turn = _turn_deg(last, pose)
        if turn > options.fastest_deg_s * (time_s - rival.times_s[-1]) + options.slack_deg:
            return False
        if len(rival.poses) < 2:
            return True
        off = _turn_deg(rival.foreseen(time_s), pose)
        return off <= options.slack_deg + options.steady_share * turn

    def _verdict(self) -> Verdict[L]:
        best = self.carried[0]
        others = [
            rival
            for rival in self.carried[1:]
            if not self._looking.same(rival.poses[-1], best.poses[-1])
        ]
        lead = best.score - others[0].score if others else ALONE_SIGMAS * best.weight
        light, steps, brightness = (
            each / best.explained for each in (best.light, best.steps, best.brightness)
        )
        standing = Standing(lead, light, steps, best.last.range_sigma, brightness)
        known = best.last.brightness is not None
        belief = self._by_brightness if known else self._belief
        wrong = belief.wrong_probability(standing)
        return Verdict(best.last, wrong, standing, others[0].poses[-1] if others else None)


def _turn_deg(pose: RigidTransform, other: RigidTransform) -> float:
    cosine = 0.5 * (float(np.trace(pose.rotation.T @ other.rotation)) - 1.0)
    return float(np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0))))
