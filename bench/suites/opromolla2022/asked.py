"""What is asked of ``best`` in each sequence, and whether the runs hold it, figure by figure."""

from __future__ import annotations

import math
from collections.abc import Sequence as Many
from dataclasses import dataclass

from bench.suites.opromolla2022.cases import FAR_OFF, TOGETHER, published
from bench.suites.opromolla2022.summaries import (
    PARAMETERS,
    OverPaper,
    PerFrame,
    Statistics,
)

ALLOWED_OVER_PAPER = 1.02
STANDARD_ERRORS = 3.0
OVER_EXACT = 1.1
INSIDE = 0.95
RATIO, MEAN, STD = "rms over paper's", "mean, in its errors", "std, cm and deg"
LOST, KEPT, WRONG = "frames lost", "frames lost that paper keeps", "wrong poses"
HONEST, CENTROIDS = "frames with NEES inside", "std of centroids, px"


@dataclass(frozen=True)
class Figure:
    """One figure and its limit.

    Attributes
    ----------
    of : str
        Parameter or axis; empty where the line has a single figure.
    found : float or None
        None where there is nothing to judge.
    limit : float
        In the figure's unit.
    holds : bool or None
    """

    of: str
    found: float | None
    limit: float
    holds: bool | None


@dataclass(frozen=True)
class AskedLine:
    """One thing that is asked of a sequence.

    Attributes
    ----------
    sequence, line : str
    figures : list of Figure
    holds : bool or None
        Whether all figures hold; None where one cannot be judged and none fails.
    """

    sequence: str
    line: str
    figures: list[Figure]
    holds: bool | None


def asked_of_table(
    name: str,
    told: Statistics | None,
    exact: Statistics | None,
    over: OverPaper | None,
    best: PerFrame,
) -> list[AskedLine]:
    """Judge a sequence that the paper has a table of.

    Parameters
    ----------
    name : str
        Of the sequence.
    told, exact : Statistics or None
        Of ``best``, and of exact centroids.
    over : OverPaper or None
        By frames.
    best : PerFrame

    Returns
    -------
    list of AskedLine
        Empty where the paper has no table of it.
    """
    printed = published()["results"].get(name)
    if printed is None:
        return []
    stds = [*printed["std_t_cm"], *printed["std_euler_deg"]]
    unknown = [math.nan] * len(PARAMETERS)
    means = unknown
    if told is not None:
        means = [
            abs(mean) / spread if spread > 0.0 else math.nan
            for mean, spread in zip(told.mean, told.spread, strict=True)
        ]
    peers = unknown if exact is None else exact.std
    limits = [max(std, OVER_EXACT * _or_zero(peer)) for std, peer in zip(stds, peers, strict=True)]
    found = [
        _ratios(name, over),
        _line(name, MEAN, PARAMETERS, means, [STANDARD_ERRORS] * len(PARAMETERS)),
        _line(name, STD, PARAMETERS, unknown if told is None else told.std, limits),
    ]
    if name.startswith("E-"):
        found.append(_line(name, LOST, ("",), [best.lost], [0.0]))
        seen = published()["centroids"].get(name)
        if seen is not None:
            found.append(
                _line(name, CENTROIDS, ("u", "v"), best.pooled_centroid_std_px, seen["std"])
            )
    return found


def asked_of_study(
    name: str, errors: str, over: OverPaper | None, best: PerFrame, lost_alone: int
) -> list[AskedLine]:
    """Judge a sequence under a set of errors.

    Parameters
    ----------
    name, errors : str
        Of the sequence and of the set.
    over : OverPaper or None
        By runs.
    best : PerFrame
    lost_alone : int
        Frames, over all runs, in which the published pipeline has a pose and ``best`` has none.
    """
    found = [_ratios(name, over)]
    if errors == TOGETHER:
        inside = math.nan if best.nees.inside is None else best.nees.inside
        holds = None if math.isnan(inside) else inside >= INSIDE
        figure = Figure("", _told(inside), INSIDE, holds)
        found.append(AskedLine(name, HONEST, [figure], holds))
    if errors in (TOGETHER, FAR_OFF):
        found.append(_line(name, KEPT, ("",), [lost_alone], [0.0]))
        found.append(_line(name, WRONG, ("",), [best.wrong], [0.0]))
    return found


def _ratios(name: str, over: OverPaper | None) -> AskedLine:
    high = [math.nan] * len(PARAMETERS) if over is None or not over.decides else over.high
    return _line(name, RATIO, PARAMETERS, high, [ALLOWED_OVER_PAPER] * len(PARAMETERS))


def _line(
    name: str, line: str, of: Many[str], found: Many[float], limits: Many[float]
) -> AskedLine:
    """Hold figures to what each may be at most."""
    figures = [
        Figure(which, _told(value), limit, None if math.isnan(value) else value <= limit)
        for which, value, limit in zip(of, found or [math.nan] * len(of), limits, strict=True)
    ]
    kept = {each.holds for each in figures}
    return AskedLine(
        name, line, figures, False if False in kept else None if None in kept else True
    )


def _told(value: float) -> float | None:
    return None if math.isnan(value) else float(value)


def _or_zero(value: float) -> float:
    return 0.0 if math.isnan(value) else value
