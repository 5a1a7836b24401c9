"""Who is better, by how much, and whether these frames can tell."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from bench.compare.bootstrap import (
    FEWEST_BLOCKS,
    Resampling,
    Statistic,
    interval,
    mean,
    median,
    resampled,
)
from bench.compare.conditions import Group
from bench.compare.options import RankBy
from bench.scoring.pose_measures import MethodMeasures
from bench.scoring.pose_summary import bop_recalls, errors_of
from bench.scoring.true_view import TrueView
from models.arrays import Floats


@dataclass(frozen=True)
class Measure:
    """One number by which methods are ranked.

    Attributes
    ----------
    title, unit : str
    statistic : callable
        Of its values by frame, lost frames among them.
    less_is_better : bool
    """

    title: str
    unit: str
    statistic: Statistic
    less_is_better: bool = True


MEASURES: dict[RankBy, Measure] = {
    "speed": Measure("SPEED score", "", mean),
    "position": Measure("position error, median", "m", median),
    "attitude": Measure("attitude error, median", "deg", median),
    "ar": Measure("BOP average recall", "", mean, less_is_better=False),
}


@dataclass(frozen=True)
class Value:
    """A number with its interval; None where it is infinite: half of the frames are lost."""

    value: float | None
    interval: tuple[float | None, float | None]


@dataclass(frozen=True)
class Standing:
    """One method's place.

    Attributes
    ----------
    label : str
    values : dict of str to Value
        By measure.
    tied_with_first : bool
        Whether its difference from the first may be chance.
    """

    label: str
    values: dict[str, Value]
    tied_with_first: bool


@dataclass(frozen=True)
class Pair:
    """Two methods, frame by frame.

    Attributes
    ----------
    one, other : str
    difference : Value
        Of the measure ranked by, one minus other.
    better_share : Value
        Share of the frames in which one is better; a frame in which both are alike counts half.
    told_apart : bool
        Whether the interval of the difference leaves out 0, of blocks enough to say so.
    blocks : int
        Into which the frames were cut.
    """

    one: str
    other: str
    difference: Value
    better_share: Value
    told_apart: bool
    blocks: int

    @property
    def verdict(self) -> str:
        """Whether they are told apart, and if not why."""
        if self.told_apart:
            return "yes"
        if self.blocks < FEWEST_BLOCKS:
            return (
                f"no: {self.blocks} block{'s' if self.blocks != 1 else ''}, {FEWEST_BLOCKS} needed"
            )
        return "no: the interval holds 0"


@dataclass(frozen=True)
class GroupStanding:
    """One method in one group of frames."""

    by: str
    group: str
    low: float
    high: float
    label: str
    frames: int
    lost: int
    values: dict[str, Value]


@dataclass(frozen=True)
class Leaderboard:
    """Standings, best first; pairs, each with the better one first; and groups."""

    rank_by: RankBy
    standings: list[Standing]
    pairs: list[Pair]
    groups: list[GroupStanding]


def frame_values(view: TrueView, method: MethodMeasures) -> dict[str, Floats]:
    """Return each measure's value by frame, (n,) each; a lost frame has the worst there is."""
    errors = errors_of(view, method)
    values = {
        "speed": np.array([each.speed.score for each in method.frames]),
        "position": errors.position_m,
        "attitude": errors.attitude_deg,
    }
    if view.shape is not None and view.grid is not None:
        values["ar"] = bop_recalls(view, method)["ar"]
    return values


def leaderboard(
    values: dict[str, dict[str, Floats]], rank_by: RankBy, grouped: list[Group], how: Resampling
) -> Leaderboard:
    """Rank methods.

    Parameters
    ----------
    values : dict of str to dict of str to (n,) array
        By label and measure.
    rank_by : str
    grouped : list of Group
    how : Resampling
    """
    measure = MEASURES[rank_by]
    sign = 1.0 if measure.less_is_better else -1.0
    whole = {label: float(_statistic(measure, own[rank_by])) for label, own in values.items()}
    order = sorted(values, key=lambda label: sign * whole[label])
    draws = {label: resampled(values[label][rank_by], measure.statistic, how) for label in order}
    pairs = [
        _pair(one, other, values, rank_by, draws, how) for one, other in combinations(order, 2)
    ]
    untold = {pair.other for pair in pairs if pair.one == order[0] and not pair.told_apart}
    return Leaderboard(
        rank_by=rank_by,
        standings=[
            Standing(label, _values(values[label], how), label in untold) for label in order
        ],
        pairs=pairs,
        groups=[
            GroupStanding(
                by=group.by,
                group=group.title,
                low=group.low,
                high=group.high,
                label=label,
                frames=int(group.frames.sum()),
                lost=int(np.isinf(values[label]["position"][group.frames]).sum()),
                values=_values(
                    {name: own[group.frames] for name, own in values[label].items()}, how
                ),
            )
            for group in grouped
            for label in order
        ],
    )


def _statistic(measure: Measure, values: Floats) -> float:
    return float(measure.statistic(values[None])[0])


def _values(values: dict[str, Floats], how: Resampling) -> dict[str, Value]:
    found = {}
    for name, measure in MEASURES.items():
        if name in values:
            own = values[name]
            ends = interval(resampled(own, measure.statistic, how))
            found[str(name)] = _value(_statistic(measure, own), ends)
    return found


def _pair(
    one: str,
    other: str,
    values: dict[str, dict[str, Floats]],
    rank_by: RankBy,
    draws: dict[str, Floats],
    how: Resampling,
) -> Pair:
    measure = MEASURES[rank_by]
    first, second = values[one][rank_by], values[other][rank_by]
    with np.errstate(invalid="ignore"):  # infinite minus infinite: both have lost half
        whole = _statistic(measure, first) - _statistic(measure, second)
        drawn = draws[one] - draws[other]
    ends = interval(np.nan_to_num(drawn, nan=0.0, posinf=np.inf, neginf=-np.inf))
    better = first < second if measure.less_is_better else first > second
    wins = np.where(better, 1.0, np.where(first == second, 0.5, 0.0))
    return Pair(
        one=one,
        other=other,
        difference=_value(whole, ends),
        better_share=_value(float(wins.mean()), interval(resampled(wins, mean, how))),
        told_apart=how.decides(len(first)) and not ends[0] <= 0.0 <= ends[1],
        blocks=len(first) // how.block(len(first)),
    )


def _value(value: float, ends: tuple[float, float]) -> Value:
    low, high = (end if np.isfinite(end) else None for end in ends)
    return Value(value if np.isfinite(value) else None, (low, high))
