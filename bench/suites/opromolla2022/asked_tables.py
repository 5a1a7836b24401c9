"""What is asked and whether it holds, as tables of the suite's page."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

from bench.report.numbers import NONE, number, share
from bench.report.table import Table
from bench.suites.opromolla2022.asked import (
    CENTROIDS,
    HONEST,
    KEPT,
    LOST,
    MEAN,
    RATIO,
    STD,
    WRONG,
    AskedLine,
    Figure,
)
from bench.suites.opromolla2022.results import FlownSequence, Results
from bench.suites.opromolla2022.summaries import PARAMETERS

VERDICTS = {True: "holds", False: "does not hold", None: "not judged"}
BY_PARAMETER = (RATIO, MEAN, STD)
TERMS = {
    RATIO: "Where the rms of best over that of paper ends, 95 times in 100, by a paired bootstrap: "
    "over frames in blocks, or over runs where errors are studied. More than 1.02 is to be "
    "excluded.",
    MEAN: "The mean over runs and frames, over its standard error from the runs' own spread.",
    STD: "Of the mean over the runs, from frame to frame: at most the printed one, or 1.1 of what "
    "exact centroids give.",
    LOST: "Of all runs.",
    KEPT: "Frames of all runs with a pose by the published pipeline and none by best.",
    WRONG: "Beyond the case's limits and beyond what their covariance allows.",
    HONEST: "Share of the frames whose mean NEES over the runs is where an honest covariance's is "
    "95 times in 100.",
    CENTROIDS: "Of all markers, frames and runs; the paper's section 5.2.1.",
}
Named: TypeAlias = tuple[str, AskedLine]


def asked_lines(results: Results) -> list[AskedLine]:
    """Return everything that is asked of what was flown, in the page's order.

    Parameters
    ----------
    results : Results
    """
    return [line for own in _flown(results) for line in own.asked]


def parameters_asked(results: Results) -> Table:
    """List what is asked of each pose parameter.

    Parameters
    ----------
    results : Results
    """
    head = ["", *PARAMETERS, ""]
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    for title, lines in _titled(results):
        chosen = [(name, line) for name, line in lines if line.line in BY_PARAMETER]
        if chosen:
            sections[len(rows)] = title
        rows += [[name, *map(_held, line.figures), VERDICTS[line.holds]] for name, line in chosen]
    return Table(head, rows, TERMS, sections)


def counts_asked(results: Results) -> Table:
    """List what is asked of frames, centroids and covariances.

    Parameters
    ----------
    results : Results
    """
    rows = [
        [
            line.line,
            f"{line.sequence} {each.of}".strip(),
            _held(each, line.line),
            VERDICTS[each.holds],
        ]
        for line in asked_lines(results)
        if line.line not in BY_PARAMETER
        for each in line.figures
    ]
    return Table(["", "of", "found", ""], rows, TERMS, {})


def tally(results: Results) -> tuple[int, int]:
    """Return how many lines hold, and how many could be judged.

    Parameters
    ----------
    results : Results
    """
    judged = [line.holds for line in asked_lines(results) if line.holds is not None]
    return sum(judged), len(judged)


def _flown(results: Results) -> list[FlownSequence]:
    return [*results.sequences, *(own for each in results.studies.values() for own in each)]


def _titled(results: Results) -> Iterable[tuple[str, list[Named]]]:
    for own in results.sequences:
        one = own.per_frame["best"]
        title = f"{own.sequence.name}: {one.runs} runs of {one.frames} frames"
        yield title, [(line.line, line) for line in own.asked]
    for name, studied in results.studies.items():
        named = [
            (f"{own.sequence.errors.replace('_', ' ')}, {own.per_frame['best'].runs} runs", line)
            for own in studied
            for line in own.asked
        ]
        yield f"{name} under each error: {RATIO}", named


def _held(figure: Figure, line: str = "") -> str:
    """Write a figure beside its limit."""
    if figure.found is None:
        return NONE
    if line == HONEST:
        relation = "≥" if figure.holds else "<"
        return f"{share(figure.found)} {relation} {share(figure.limit)}"
    relation = "≤" if figure.holds else ">"
    limit = f"{figure.limit:.3g}"
    close = number(figure.found) in (limit, number(figure.limit))
    return f"{number(figure.found, 5 if close else 3)} {relation} {limit}"
