"""What came of the starts: found, refused or wrong, and how honest the pipeline was about it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.stats import beta

from bench.scoring.judgement import without_numbers
from bench.scoring.tumble.navigation_errors import symmetric_attitude_deg
from bench.suites.uncooperative_suns.cases import SUNS, MotionTask, draw_motion
from bench.suites.uncooperative_suns.frames import known_of
from bench.suites.uncooperative_suns.plan import Plan
from bench.suites.units import done_outcome
from models.arrays import Floats, Indices, Mask
from models.pose import RigidTransform

WRONG_DEG, WRONG_SHARE = 10.0, 0.05  # of attitude, and of the range: beyond either a pose is wrong
LIT_ENOUGH = 0.3  # of the silhouette above three sigmas
CONFIDENCE = 0.95
PHASE_EDGES_DEG = (0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 170.0)
SHARE_EDGES = (0.05, 0.075, 0.11, 0.17, 0.25)
LIT_EDGES = (0.0, 0.1, 0.3, 0.6, 1.0)
DOUBT_EDGES = (0.0, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0)


@dataclass(frozen=True, eq=False)
class Starts:
    """The starts of one target by one variant, one number each.

    Attributes
    ----------
    phase_deg, share, lit : (n,) arrays
        Phase angle; share of the field across; mean share of the silhouette that is lit.
    attitude : (n, 3, 3) array
        True, of the first image.
    images : (n,) array of int
        Looked at until one gave a pose, 0 without any.
    attitude_deg, range_share : (n,) arrays
        Errors of the pose; NaN without.
    doubt : (n,) array
        Probability that the pose is wrong, as the pipeline says; NaN where it does not.
    seconds : (n,) array
        Of one core. Never the same twice.
    reasons : tuple of str
    """

    phase_deg: Floats
    share: Floats
    lit: Floats
    attitude: Floats
    images: Indices
    attitude_deg: Floats
    range_share: Floats
    doubt: Floats
    seconds: Floats
    reasons: tuple[str, ...]

    @cached_property
    def claimed(self) -> Mask:
        """Whether there is a pose."""
        return self.images > 0

    @cached_property
    def wrong(self) -> Mask:
        """Whether the pose is wrong."""
        off = (self.attitude_deg > WRONG_DEG) | (self.range_share > WRONG_SHARE)
        return self.claimed & off

    @property
    def right(self) -> Mask:
        """Whether the pose is right."""
        return self.claimed & ~self.wrong

    def __len__(self) -> int:
        return len(self.images)


@dataclass(frozen=True)
class Counts:
    """How some starts ended.

    Attributes
    ----------
    starts, found, wrong, refused : int
    """

    starts: int
    found: int
    wrong: int
    refused: int


@dataclass(frozen=True)
class Claim:
    """Claims of about one probability of being wrong, and how many were.

    Attributes
    ----------
    least, most : float
        Of the probability told.
    claims, wrong : int
    told : float
        Mean of the probabilities.
    low, high : float
        95 % interval of the share that is wrong (Clopper and Pearson).
    """

    least: float
    most: float
    claims: int
    wrong: int
    told: float
    low: float
    high: float

    @property
    def holds(self) -> bool:
        """Whether what was told lies within the interval."""
        return self.low <= self.told <= self.high


@dataclass(frozen=True)
class Summary:
    """One target by one variant.

    Attributes
    ----------
    every, lit : Counts
        All starts, and those with enough light.
    first_image : int
        Found at the first image.
    phase, share, lit_share : list of Counts
        By the bins of each.
    median_attitude_deg, median_range_share : float or None
        Of the poses that are right.
    claims : list of Claim
    reasons : dict of str to int
    seconds : (float, float)
        Mean and longest of a start.
    """

    every: Counts
    lit: Counts
    first_image: int
    phase: list[Counts]
    share: list[Counts]
    lit_share: list[Counts]
    median_attitude_deg: float | None
    median_range_share: float | None
    claims: list[Claim]
    reasons: dict[str, int]
    seconds: tuple[float, float]


def starts_of(plan: Plan, target: str, variant: str) -> Starts:
    """Judge the starts of a target by a variant.

    Parameters
    ----------
    plan : Plan
    target, variant : str

    Raises
    ------
    DatasetError
        If one is not done.
    """
    rows: dict[str, list[object]] = {}
    reasons: list[str] = []
    folder = plan.units_folder
    for unit, frames in zip(plan.starts(target, variant), plan.frames(target), strict=False):
        outcome = done_outcome(folder, unit)
        lit = done_outcome(plan.frames_folder, frames).values["lit"].mean(axis=1)
        for number, row in enumerate(_judged(frames.task, outcome.values)):
            row |= {"lit": lit[number], "seconds": outcome.seconds[number]}
            for key, value in row.items():
                rows.setdefault(key, []).append(value)
        reasons += outcome.values["reason"].tolist()
    return Starts(**{key: np.array(value) for key, value in rows.items()}, reasons=tuple(reasons))


def _judged(task: MotionTask, values: dict[str, Floats]) -> list[dict[str, object]]:
    camera, _, wireframe = known_of(task)
    drawn = draw_motion(task, camera, wireframe.radius_m)
    rows = []
    for number in range(SUNS):
        image = int(values["image"][number])
        attitude_deg = range_share = np.nan
        if image >= 0:
            matrix, truth = values["cam_from_target"][number], drawn.poses[image]
            pose = RigidTransform(matrix[:, :3], matrix[:, 3])
            attitude_deg = symmetric_attitude_deg(pose, truth, wireframe.symmetries)
            off = pose.translation - truth.translation
            range_share = float(np.linalg.norm(off) / np.linalg.norm(truth.translation))
        rows.append(
            {
                "phase_deg": drawn.phases_deg[number],
                "share": drawn.share,
                "attitude": drawn.poses[0].rotation,
                "images": image + 1,
                "attitude_deg": attitude_deg,
                "range_share": range_share,
                "doubt": values["wrong_probability"][number],
            }
        )
    return rows


def summary_of(starts: Starts) -> Summary:
    """Summarise the starts of one target by one variant."""
    right = starts.right
    told = Counter(
        without_numbers(reason)
        for reason, claimed in zip(starts.reasons, starts.claimed, strict=True)
        if not claimed
    )
    return Summary(
        every=counts(starts, np.ones(len(starts), dtype=bool)),
        lit=counts(starts, starts.lit >= LIT_ENOUGH),
        first_image=int((right & (starts.images == 1)).sum()),
        phase=_binned(starts, starts.phase_deg, PHASE_EDGES_DEG),
        share=_binned(starts, starts.share, SHARE_EDGES),
        lit_share=_binned(starts, starts.lit, LIT_EDGES),
        median_attitude_deg=_median(starts.attitude_deg[right]),
        median_range_share=_median(starts.range_share[right]),
        claims=claims_of(starts),
        reasons=dict(told.most_common()),
        seconds=(float(starts.seconds.mean()), float(starts.seconds.max())),
    )


def counts(starts: Starts, chosen: Mask) -> Counts:
    """Count how chosen starts, (n,) array of bool, ended."""
    return Counts(
        int(chosen.sum()),
        int((chosen & starts.right).sum()),
        int((chosen & starts.wrong).sum()),
        int((chosen & ~starts.claimed).sum()),
    )


def claims_of(starts: Starts) -> list[Claim]:
    """Hold the probabilities told against what was wrong, by bins that hold any."""
    found = []
    for least, most in pairwise(DOUBT_EDGES):
        with np.errstate(invalid="ignore"):
            own = starts.claimed & (starts.doubt >= least) & (starts.doubt < most)
        claims, wrong = int(own.sum()), int((own & starts.wrong).sum())
        if claims:
            low, high = interval(wrong, claims)
            told = float(starts.doubt[own].mean())
            found.append(Claim(least, most, claims, wrong, told, low, high))
    return found


def interval(wrong: int, claims: int) -> tuple[float, float]:
    """Return the 95 % interval of a share by Clopper and Pearson.

    Parameters
    ----------
    wrong, claims : int
    """
    tail = 0.5 * (1.0 - CONFIDENCE)
    low = float(beta.ppf(tail, wrong, claims - wrong + 1)) if wrong else 0.0
    high = float(beta.ppf(1.0 - tail, wrong + 1, claims - wrong)) if wrong < claims else 1.0
    return low, high


def bin_places(values: Floats, edges: Sequence[float]) -> Indices:
    """Return which bin each value lies in, (n,); the first and last hold what is beyond.

    Parameters
    ----------
    values : (n,) array
    edges : sequence of float
        One more than there are bins.
    """
    return np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)


def _binned(starts: Starts, values: Floats, edges: Sequence[float]) -> list[Counts]:
    place = bin_places(values, edges)
    return [counts(starts, place == k) for k in range(len(edges) - 1)]


def _median(values: Floats) -> float | None:
    return float(np.median(values)) if values.size else None
