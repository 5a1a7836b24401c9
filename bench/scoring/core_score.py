"""The common core of a score: what is said of every pipeline of every chain, in the same words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.scoring.judgement import Judgement, without_numbers


@dataclass(frozen=True)
class Sizes:
    """Median, 95th percentile and root mean square of error sizes; None of none."""

    median: float | None
    p95: float | None
    rms: float | None


@dataclass(frozen=True)
class Lost:
    """Frames whose own readings gave no pose.

    Attributes
    ----------
    count : int
    missed : int
        Those that should have given one.
    reasons : dict
        The pipeline's words, numbers left out, and how often.
    frames : list of int
    """

    count: int
    missed: int
    reasons: dict[str, int]
    frames: list[int]


@dataclass(frozen=True)
class Wrong:
    """Poses beyond what their covariance allows, and beyond the case's limits.

    Attributes
    ----------
    count : int
    longest : int
        Most of them in a row.
    frames : list of int
    """

    count: int
    longest: int
    frames: list[int]


@dataclass(frozen=True)
class Runtime:
    """Time that a frame takes, ms: median and 95th percentile."""

    median: float | None
    p95: float | None


@dataclass(frozen=True)
class CoreScore:
    """One pipeline on one dataset; all of run 0 but ``pooled``.

    Attributes
    ----------
    frames, estimated : int
        All, and those with a pose that the pipeline stands by.
    lost : Lost
    wrong : Wrong
    position_error_mm : Sizes
        Length of estimate minus truth.
    attitude_error_deg : Sizes
        Angle of the turn between estimated and true attitude.
    runtime_ms : Runtime
    pooled : Pooled
    """

    frames: int
    estimated: int
    lost: Lost
    wrong: Wrong
    position_error_mm: Sizes
    attitude_error_deg: Sizes
    runtime_ms: Runtime
    pooled: Pooled


@dataclass(frozen=True)
class Pooled:
    """The same over all runs together."""

    runs: int
    frames: int
    estimated: int
    missed: int
    wrong: int
    position_error_mm: Sizes
    attitude_error_deg: Sizes


def core_score(judged: Sequence[Sequence[Judgement]], runtime_ms: Sequence[float]) -> CoreScore:
    """Summarise the runs of one pipeline.

    Parameters
    ----------
    judged : sequence of sequences of Judgement
        By run, run 0 first, then by frame.
    runtime_ms : sequence of float, ms
        Of the frames of run 0.
    """
    own = judged[0]
    pooled = [each for run in judged for each in run]
    lost = [each for each in own if each.lost]
    reasons = Counter(without_numbers(each.reason or "") for each in lost)
    return CoreScore(
        frames=len(own),
        estimated=_estimated(own),
        lost=Lost(
            count=len(lost),
            missed=sum(each.missed for each in own),
            reasons=dict(sorted(reasons.items(), key=lambda item: (-item[1], item[0]))),
            frames=[each.estimate.frame for each in lost],
        ),
        wrong=Wrong(
            count=sum(each.wrong for each in own),
            longest=longest_run([each.wrong for each in own]),
            frames=[each.estimate.frame for each in own if each.wrong],
        ),
        position_error_mm=_position_mm(own),
        attitude_error_deg=_attitude_deg(own),
        runtime_ms=_runtime(runtime_ms),
        pooled=Pooled(
            runs=len(judged),
            frames=len(pooled),
            estimated=_estimated(pooled),
            missed=sum(each.missed for each in pooled),
            wrong=sum(each.wrong for each in pooled),
            position_error_mm=_position_mm(pooled),
            attitude_error_deg=_attitude_deg(pooled),
        ),
    )


def sizes(values: Sequence[float | None]) -> Sizes:
    """Summarise the sizes that are neither None nor NaN."""
    there = np.sort([value for value in values if value is not None and not np.isnan(value)])
    if not there.size:
        return Sizes(None, None, None)
    return Sizes(
        float(np.median(there)),
        float(np.percentile(there, 95.0)),
        float(np.sqrt(np.mean(there**2))),
    )


def longest_run(flags: Sequence[bool]) -> int:
    """Return how many in a row are true, at most."""
    longest = now = 0
    for flag in flags:
        now = now + 1 if flag else 0
        longest = max(longest, now)
    return longest


def _estimated(judged: Sequence[Judgement]) -> int:
    return sum(each.position_m is not None for each in judged)


def _position_mm(judged: Sequence[Judgement]) -> Sizes:
    return sizes([None if e.position_m is None else 1e3 * e.position_m for e in judged])


def _attitude_deg(judged: Sequence[Judgement]) -> Sizes:
    return sizes([each.attitude_deg for each in judged])


def _runtime(runtime_ms: Sequence[float]) -> Runtime:
    if not runtime_ms:
        return Runtime(None, None)
    return Runtime(float(np.median(runtime_ms)), float(np.percentile(runtime_ms, 95.0)))
