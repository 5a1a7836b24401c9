"""What the measures of one method come to: sizes, benchmark scores, recalls; lost frames count."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from bench.scoring.core_score import Sizes, sizes
from bench.scoring.judgement import without_numbers
from bench.scoring.metrics import bop, speed
from bench.scoring.metrics.recall import Errors, Recall, recalls
from bench.scoring.pose_measures import MethodMeasures
from bench.scoring.true_view import TrueView
from models.arrays import Floats


@dataclass(frozen=True)
class SpeedScore:
    """SPEED's score; a lost frame counts as 1 + pi.

    Attributes
    ----------
    score, score_floored : float
        Mean over all frames, without and with the floors of SPEED+.
    score_estimated, score_floored_estimated : float or None
        The same over the frames with a pose alone.
    position, attitude_rad : float or None
        Means of the two terms over those.
    """

    score: float
    score_floored: float
    score_estimated: float | None
    score_floored_estimated: float | None
    position: float | None
    attitude_rad: float | None


@dataclass(frozen=True)
class BopScore:
    """BOP's average recalls; a lost frame passes no threshold.

    Attributes
    ----------
    ar_vsd : float or None
        None where VSD was left out.
    ar_mssd, ar_mspd : float
    ar : float or None
        Their mean.
    """

    ar_vsd: float | None
    ar_mssd: float
    ar_mspd: float
    ar: float | None


@dataclass(frozen=True)
class PoseSummary:
    """One method.

    Attributes
    ----------
    frames, estimated : int
    lost : dict of str to int
        Reasons, numbers left out, and how often.
    wrong : int
    position_error_m, attitude_error_deg, position_over_range : Sizes
        Of frames with a pose.
    speed : SpeedScore
    add_m, add_s_m, mssd_m, mspd_px : Sizes or None
        Of frames with a pose, infinite ones too; None where the target's shape is not known.
    vsd : list of float or None
        Mean for each tolerance, of frames with a pose.
    bop : BopScore or None
    recall : list of Recall
        Of all frames.
    """

    frames: int
    estimated: int
    lost: dict[str, int]
    wrong: int
    position_error_m: Sizes
    attitude_error_deg: Sizes
    position_over_range: Sizes
    speed: SpeedScore
    add_m: Sizes | None
    add_s_m: Sizes | None
    mssd_m: Sizes | None
    mspd_px: Sizes | None
    vsd: list[float] | None
    bop: BopScore | None
    recall: list[Recall]


def pose_summary(view: TrueView, method: MethodMeasures) -> PoseSummary:
    """Sum up one method's frames."""
    frames = method.frames
    there = [each for each in frames if not each.lost]
    shapes = [each.shape for each in there if each.shape is not None]
    known = view.shape is not None
    reasons = Counter(without_numbers(each.reason or "") for each in frames if each.lost)
    vsd = [each.vsd for each in shapes if each.vsd is not None]

    def of_shape(name: str) -> Sizes | None:
        return _sizes([getattr(each, name) for each in shapes]) if known else None

    return PoseSummary(
        frames=len(frames),
        estimated=len(there),
        lost=dict(sorted(reasons.items(), key=lambda item: (-item[1], item[0]))),
        wrong=sum(each.wrong for each in frames),
        position_error_m=sizes([each.position_m for each in there]),
        attitude_error_deg=sizes([each.attitude_deg for each in there]),
        position_over_range=sizes([each.speed.position for each in there]),
        speed=_speed(method),
        add_m=of_shape("add_m"),
        add_s_m=of_shape("add_s_m"),
        mssd_m=of_shape("mssd_m"),
        mspd_px=of_shape("mspd_px"),
        vsd=np.mean(vsd, axis=0).tolist() if vsd else None,
        bop=_bop(view, method) if known else None,
        recall=recalls(errors_of(view, method)),
    )


def _sizes(values: list[float]) -> Sizes:
    """Summarise sizes of which some may be infinite; a number that is then infinite is None."""
    if np.isfinite(values).all():
        return sizes(values)
    ends = np.quantile(values, [0.5, 0.95], method="inverted_cdf")
    median, p95 = (float(end) if np.isfinite(end) else None for end in ends)
    return Sizes(median, p95, None)


def errors_of(view: TrueView, method: MethodMeasures) -> Errors:
    """Return a method's errors by frame, infinite where it has no pose."""
    frames, shapes = method.frames, [each.shape for each in method.frames]
    return Errors(
        position_m=_or_infinite([each.position_m for each in frames]),
        attitude_deg=_or_infinite([each.attitude_deg for each in frames]),
        range_m=np.array([each.range_m for each in frames]),
        add_m=_or_infinite([None if own is None else own.add_m for own in shapes]),
        add_s_m=_or_infinite([None if own is None else own.add_s_m for own in shapes]),
        mssd_m=_or_infinite([None if own is None else own.mssd_m for own in shapes]),
        diameter_m=None if view.shape is None else view.shape.diameter_m,
    )


def _or_infinite(values: list[float | None]) -> Floats:
    return np.array([np.inf if value is None else value for value in values])


def bop_recalls(view: TrueView, method: MethodMeasures) -> dict[str, Floats]:
    """Return each frame's share of BOP's thresholds passed, (n,) by name; 0 where it is lost.

    The mean over frames of ``ar_vsd``, ``ar_mssd``, ``ar_mspd`` is BOP's average recall; ``ar`` is
    that of the three. VSD, and ``ar`` with it, is absent where it was left out.
    """
    assert view.shape is not None
    diameter_m, width_px = view.shape.diameter_m, view.camera.width
    found: dict[str, list[float]] = {"ar_mssd": [], "ar_mspd": []}
    if view.grid is not None:
        found["ar_vsd"] = []
    for each in method.frames:
        own = each.shape
        found["ar_mssd"].append(0.0 if own is None else bop.mssd_recall(own.mssd_m, diameter_m))
        found["ar_mspd"].append(0.0 if own is None else bop.mspd_recall(own.mspd_px, width_px))
        if view.grid is not None:
            seen = None if own is None else own.vsd
            found["ar_vsd"].append(0.0 if seen is None else bop.vsd_recall(seen))
    shares = {name: np.array(values) for name, values in found.items()}
    if view.grid is not None:
        shares["ar"] = np.mean(list(shares.values()), axis=0)
    return shares


def _bop(view: TrueView, method: MethodMeasures) -> BopScore:
    means = {name: float(own.mean()) for name, own in bop_recalls(view, method).items()}
    return BopScore(means.get("ar_vsd"), means["ar_mssd"], means["ar_mspd"], means.get("ar"))


def _speed(method: MethodMeasures) -> SpeedScore:
    there = [each.speed for each in method.frames if not each.lost]
    lost = len(method.frames) - len(there)

    def mean(name: str, own: list[speed.SpeedError]) -> float | None:
        return float(np.mean([getattr(each, name) for each in own])) if own else None

    everyone = [*there, *([speed.LOST] * lost)]
    return SpeedScore(
        score=mean("score", everyone) or 0.0,
        score_floored=mean("score_floored", everyone) or 0.0,
        score_estimated=mean("score", there),
        score_floored_estimated=mean("score_floored", there),
        position=mean("position", there),
        attitude_rad=mean("attitude_rad", there),
    )
