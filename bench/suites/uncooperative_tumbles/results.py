"""What came of the tumbles: when a state was right, how long a wrong one was held, how honest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.suites.uncooperative_suns.cases import MotionTask
from bench.suites.uncooperative_suns.results import LIT_ENOUGH, WRONG_DEG, WRONG_SHARE
from bench.suites.uncooperative_tumbles.cases import DrawnTumble, drawn_scenario
from bench.suites.uncooperative_tumbles.following import ERRORS
from bench.suites.uncooperative_tumbles.plan import Plan
from bench.suites.units import done_outcome
from models.arrays import Floats, Mask

STATE_DOF = 6
MOST_HELD = 3  # images in a row with a wrong state
HONEST_NEES = (0.7, 1.4)  # of the normalised square over its degrees of freedom


@dataclass(frozen=True, eq=False)
class Followed:
    """One tumble by one variant, image by image; NaN where there is nothing to judge.

    Attributes
    ----------
    drawn : DrawnTumble
    lit : (n,) array
        Share of the silhouette above three sigmas.
    range_m, alike_deg : (n,) arrays
        True range; attitude error of the state up to the target's symmetries.
    position_m, attitude_deg, raw_position_m, raw_attitude_deg : (n,) arrays
        Errors of the state, and of the pose of the image alone.
    nees_translation, nees_rotation : (n,) arrays
    seconds : (n,) array, s
        Of one core. Never the same twice.
    reasons : tuple of str
        Why an image gave no pose.
    """

    drawn: DrawnTumble
    lit: Floats
    range_m: Floats
    alike_deg: Floats
    position_m: Floats
    attitude_deg: Floats
    raw_position_m: Floats
    raw_attitude_deg: Floats
    nees_translation: Floats
    nees_rotation: Floats
    seconds: Floats
    reasons: tuple[str, ...]

    @cached_property
    def stands(self) -> Mask:
        """Whether there is a state, (n,)."""
        return np.isfinite(self.position_m)

    @cached_property
    def wrong(self) -> Mask:
        """Whether the state is wrong, (n,)."""
        with np.errstate(invalid="ignore"):
            far = self.position_m > WRONG_SHARE * self.range_m
            return self.stands & ((self.alike_deg > WRONG_DEG) | far)

    @cached_property
    def right(self) -> Mask:
        """Whether the state is right, (n,)."""
        return self.stands & ~self.wrong

    @property
    def first_right(self) -> int | None:
        """The first image with a right state, counted from 1."""
        return int(self.right.argmax()) + 1 if self.right.any() else None

    @property
    def longest_wrong(self) -> int:
        """Most images in a row with a wrong state."""
        return longest_run(self.wrong)

    def nees(self, what: str) -> float | None:
        """Return the mean NEES over its degrees of freedom, of right states.

        Parameters
        ----------
        what : str
            ``translation`` or ``rotation``.
        """
        values = getattr(self, f"nees_{what}")[self.right]
        values = values[np.isfinite(values)]
        return float(values.mean()) / STATE_DOF if values.size else None

    def root_mean_square(self, what: str) -> tuple[float, float] | None:
        """Return those of the state's and of the pose's error, over images with both, right.

        Parameters
        ----------
        what : str
            ``position_m`` or ``attitude_deg``.
        """
        state, raw = getattr(self, what), getattr(self, f"raw_{what}")
        both = self.right & np.isfinite(raw)
        with np.errstate(invalid="ignore"):
            both &= (self.raw_position_m <= WRONG_SHARE * self.range_m) & (
                self.raw_attitude_deg <= WRONG_DEG
            )
        if not both.any():
            return None
        return (
            float(np.sqrt(np.mean(state[both] ** 2))),
            float(np.sqrt(np.mean(raw[both] ** 2))),
        )


@dataclass(frozen=True)
class Summary:
    """One target by one variant.

    Attributes
    ----------
    tumbles, lit : int
        All, and those whose silhouette is lit enough over half of the images.
    acquired, acquired_lit : int
        With a right state at some image.
    images, right, wrong, without : int
        Images; with a right state, a wrong one, none.
    longest_wrong : int
        Most images in a row with a wrong state, in any tumble.
    held : int
        Tumbles that held one for more than three.
    nees_translation, nees_rotation : float or None
        Over their degrees of freedom, mean over tumbles that have one.
    filter_worse : dict of str to list of int
        By quantity: in how many tumbles the state is worse than the pose, of how many.
    median_position_m, median_attitude_deg : float or None
        Of right states.
    seconds : (float, float)
        Mean and longest of an image.
    """

    tumbles: int
    lit: int
    acquired: int
    acquired_lit: int
    images: int
    right: int
    wrong: int
    without: int
    longest_wrong: int
    held: int
    nees_translation: float | None
    nees_rotation: float | None
    filter_worse: dict[str, list[int]]
    median_position_m: float | None
    median_attitude_deg: float | None
    seconds: tuple[float, float]


def longest_run(flags: Mask) -> int:
    """Return the most flags, (n,) array of bool, in a row that are set."""
    longest = here = 0
    for flag in flags.tolist():
        here = here + 1 if flag else 0
        longest = max(longest, here)
    return longest


def followed_of(plan: Plan, target: str, variant: str) -> list[Followed]:
    """Return a target's tumbles as a variant followed them.

    Parameters
    ----------
    plan : Plan
    target, variant : str

    Raises
    ------
    DatasetError
        If one is not done.
    """
    found = []
    for unit, frames in zip(plan.starts(target, variant), plan.frames(target), strict=False):
        outcome = done_outcome(plan.units_folder, unit)
        task: MotionTask = frames.task
        found.append(
            Followed(
                drawn=drawn_scenario(task)[0],
                lit=done_outcome(plan.frames_folder, frames).values["lit"],
                seconds=outcome.seconds,
                reasons=tuple(outcome.values["reason"].tolist()),
                **{name: outcome.values[name] for name in (*ERRORS, "alike_deg", "range_m")},
            )
        )
    return found


def summary_of(tumbles: Sequence[Followed]) -> Summary:
    """Summarise the tumbles of one target by one variant."""
    lit = [bool((each.lit >= LIT_ENOUGH).mean() >= 0.5) for each in tumbles]
    acquired = [each.first_right is not None for each in tumbles]
    worse = {}
    for what in ("position_m", "attitude_deg"):
        sizes = [both for each in tumbles if (both := each.root_mean_square(what)) is not None]
        worse[what] = [sum(state > raw for state, raw in sizes), len(sizes)]
    seconds = np.concatenate([each.seconds for each in tumbles])
    images = sum(len(each.lit) for each in tumbles)
    right = sum(int(each.right.sum()) for each in tumbles)
    wrong = sum(int(each.wrong.sum()) for each in tumbles)
    return Summary(
        tumbles=len(tumbles),
        lit=sum(lit),
        acquired=sum(acquired),
        acquired_lit=sum(one and other for one, other in zip(lit, acquired, strict=True)),
        images=images,
        right=right,
        wrong=wrong,
        without=images - right - wrong,
        longest_wrong=max(each.longest_wrong for each in tumbles),
        held=sum(each.longest_wrong > MOST_HELD for each in tumbles),
        nees_translation=_mean([each.nees("translation") for each in tumbles]),
        nees_rotation=_mean([each.nees("rotation") for each in tumbles]),
        filter_worse=worse,
        median_position_m=_median([each.position_m[each.right] for each in tumbles]),
        median_attitude_deg=_median([each.attitude_deg[each.right] for each in tumbles]),
        seconds=(float(seconds.mean()), float(seconds.max())),
    )


def _mean(values: Sequence[float | None]) -> float | None:
    there = [value for value in values if value is not None]
    return float(np.mean(there)) if there else None


def _median(values: Sequence[Floats]) -> float | None:
    every = np.concatenate(values)
    return float(np.median(every)) if every.size else None
