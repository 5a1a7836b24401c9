"""The tables of the suite's page: rows of text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from scipy.stats import chi2

from bench.report.numbers import NONE, count, number, share
from bench.report.run_table import RunTable, with_runs
from bench.report.table import TITLES, Table
from bench.suites.consistency import CONFIDENCE, Consistency
from bench.suites.pesce2019.cases import published
from bench.suites.pesce2019.comparison import Compared
from bench.suites.pesce2019.plan import VARIANTS, Cell
from bench.suites.pesce2019.results import AcquiredCase, Results, TrackedCell
from bench.suites.pesce2019.summaries import BoundSummary, TrackingSummary

SHOWN = tuple(reversed(VARIANTS))  # best first, as on every page
CELL_HEAD = [
    "", "the paper", "best", "best / paper's", "paper variant", "variant / paper's", "best is",
    "paper variant is",
]  # fmt: skip
CELL_OF_RUNS = {"best": 2, "paper": 4}  # columns of numbers that are of runs
ACQUIRED_OF_RUNS = (2, 4, 8, 9)
WINDOW_OF_RUNS = (3, 4, 5, 6)
WINDOWS = {"steady": "last 1000 s", "settled": "from 50 s on"}
BETWEEN = "between"


def cell_table(
    cells: Sequence[Compared],
    table: str,
    behind: Mapping[tuple[str, str], Mapping[str, RunTable]] = MappingProxyType({}),
) -> Table:
    """Set one of the paper's tables beside ours, cell by cell.

    Parameters
    ----------
    cells : sequence of Compared
    table : str
    behind : mapping of (str, str) to mapping of str to RunTable
        The runs that a table's row is of, by variant.
    """
    own = [cell for cell in cells if cell.table == table]
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    last = ""
    for cell in own:
        if cell.row != last:
            sections[len(rows)] = cell.row
            last = cell.row
        rows.append(
            [
                f"{cell.quantity}, {cell.unit}",
                number(cell.published),
                number(cell.best),
                number(cell.best_ratio, 2),
                number(cell.paper),
                number(cell.paper_ratio, 2),
                cell.best_verdict,
                cell.paper_verdict,
            ]
        )
    runs = [behind.get((cell.table, cell.row), {}) for cell in own]
    return with_runs(
        Table(CELL_HEAD, rows, {}, sections),
        [{column: by[name] for name, column in CELL_OF_RUNS.items() if name in by} for by in runs],
    )


def standing_table(cells: Sequence[Compared]) -> Table:
    """Return a line for each of the paper's tables: how its cells stand."""
    head = ["", "cells", "best at or below", "worst best", "paper within 2", "explained"]
    rows = []
    for table in dict.fromkeys(cell.table for cell in cells):
        own = [cell for cell in cells if cell.table == table and "std" not in cell.quantity]
        ratios = [cell.best_ratio for cell in own if cell.best_ratio is not None]
        rows.append(
            [
                table,
                count(len(own)),
                count(sum(cell.best_verdict == "at or below" for cell in own)),
                f"{number(max(ratios, default=None))} x",
                count(sum(cell.paper_verdict == "within two" for cell in own)),
                count(sum(cell.explanation is not None for cell in own)),
            ]
        )
    return Table(head, rows, {}, {})


def why_table(cells: Sequence[Compared]) -> Table:
    """Say of each cell where the variant is far from the paper's figure why it is."""
    rows = [
        [
            f"{cell.table.replace('table', 'Table ')}, {cell.row}: {cell.quantity}",
            number(cell.paper_ratio, 2),
            cell.explanation,
        ]
        for cell in cells
        if cell.explanation is not None
    ]
    return Table(["cell", "ours over the paper's", "why, as measured"], rows, {}, {})


def acquisition_table(cases: Iterable[AcquiredCase]) -> Table:
    """List all acquisitions: how many, how many wrong, how long they took."""
    head = [
        "", "runs", "acquired", "on the first image", "wrong", "of which symmetric", "wrong, share",
        "97.5 % sure below", "median, m", "median, deg", "time, mean s", "std s", "largest s",
        "the paper's mean s",
    ]  # fmt: skip
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    for own in cases:
        sections[len(rows)] = f"case {own.case.key}, {own.case.name}"
        theirs = published()["acquisition"][f"case{own.case.key}"]["time_s"][0]
        for variant in SHOWN:
            one = own.whole[variant]
            rows.append(
                [
                    TITLES[variant],
                    count(one.runs),
                    count(one.acquired),
                    share(one.first_image),
                    count(one.wrong),
                    count(one.confused),
                    share(one.wrong_share),
                    share(one.wrong_share_most),
                    number(one.median_position_m),
                    number(one.median_attitude_deg),
                    *(number(seconds) for seconds in own.seconds[variant]),
                    number(theirs),
                ]
            )
    return Table(head, rows, {}, sections)


def filter_table(cells: Sequence[TrackedCell], window: str) -> Table:
    """Set each filter between the poses it takes and the bound of any filter."""
    head = [
        "", "pose alone, m", "filtered, m", "bound of any filter, m", "pose / its bound",
        "filtered is", "pose alone, deg", "filtered, deg", "bound of any filter, deg",
        "pose / its bound", "filtered is",
    ]  # fmt: skip
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    for tracked in cells:
        sections[len(rows)] = cell_title(tracked.cell)
        summaries, bound = _of(tracked, window)
        for variant in SHOWN:
            one = summaries[variant]
            rows.append(
                [
                    TITLES[variant],
                    *_between(one.raw_position_m, one.position_m, bound.raw_position_m,
                              bound.position_m, one.runs),
                    *_between(one.raw_attitude_deg, one.attitude_deg, bound.raw_attitude_deg,
                              bound.attitude_deg, one.runs),
                ]
            )  # fmt: skip
    return Table(head, rows, {}, sections)


def _between(
    raw: float | None, filtered: float | None, single: float, bound: float, runs: int
) -> tuple[str, str, str, str, str]:
    return (
        number(raw),
        number(filtered),
        number(bound),
        number(None if raw is None else raw / single),
        standing(raw, filtered, bound, runs),
    )


def standing(raw: float | None, filtered: float | None, bound: float, runs: int) -> str:
    """Say where a filter stands: it should beat the poses it takes, and cannot beat its bound.

    The errors of a run hang together, so that its root mean square is one draw of three numbers:
    of few runs it may fall below the bound by chance, as far as 97.5 of 100 times it does not.

    Parameters
    ----------
    raw : float or None
        Root mean square error of the poses.
    filtered : float or None
        That of the filter, in the same unit.
    bound : float
        What no filter beats on average, in the same unit.
    runs : int
        That the errors are of.
    """
    if raw is None or filtered is None:
        return NONE
    if filtered >= raw:
        return "no better than the pose"
    by_chance = float(np.sqrt(chi2.ppf(0.5 * (1.0 - CONFIDENCE), 3 * runs) / (3 * runs)))
    if filtered >= bound:
        return BETWEEN
    return "at its bound" if filtered >= by_chance * bound else "below its bound"


def window_table(cells: Sequence[TrackedCell]) -> Table:
    """List all errors in both windows."""
    head = [
        "", "window", "runs", "position, m", "attitude, deg", "velocity, mm/s", "rate, deg/s",
        "run 0, m", "run 0, deg", "median run, m", "median run, deg", "largest, deg", "no pose",
        "no state", "frame, ms",
    ]  # fmt: skip
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    for tracked in cells:
        sections[len(rows)] = cell_title(tracked.cell)
        for variant in SHOWN:
            for window, title in WINDOWS.items():
                one = _of(tracked, window)[0][variant]
                velocity = None if one.velocity_m_s is None else 1e3 * one.velocity_m_s
                rows.append(
                    [
                        TITLES[variant],
                        title,
                        count(one.runs),
                        number(one.position_m),
                        number(one.attitude_deg),
                        number(velocity),
                        number(one.rate_deg_s),
                        number(one.first_run_position_m),
                        number(one.first_run_attitude_deg),
                        number(one.median_run_position_m),
                        number(one.median_run_attitude_deg),
                        number(one.largest_attitude_deg),
                        share(one.no_pose),
                        share(one.no_state),
                        number(tracked.frame_ms[variant], 2),
                    ]
                )
    return Table(head, rows, {}, sections)


def consistency_table(cells: Sequence[TrackedCell], window: str) -> Table:
    """List whether what filters state fits what they do."""
    head = [
        "", "NEES, translation", "inside", "NEES, rotation", "inside", "NIS, translation",
        "inside", "NIS, rotation", "inside", "95 % of an honest one",
    ]  # fmt: skip
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    for tracked in cells:
        sections[len(rows)] = cell_title(tracked.cell)
        for variant in SHOWN:
            one = _of(tracked, window)[0][variant]
            pairs = (
                one.nees_translation,
                one.nees_rotation,
                one.nis_translation,
                one.nis_rotation,
            )
            texts = [text for pair in pairs for text in _consistent(pair)]
            low, high = one.nees_translation.bounds
            rows.append([TITLES[variant], *texts, f"{number(low)} to {number(high)}"])
    return Table(head, rows, {}, sections)


def _consistent(one: Consistency) -> tuple[str, str]:
    return number(one.mean), share(one.inside)


def failure_table(results: Results) -> Table:
    """List why frames gave no pose, by cell and variant."""
    rows = []
    for tracked in every_cell(results):
        for variant in SHOWN:
            one = tracked.settled[variant]
            rows += [
                [cell_title(tracked.cell), TITLES[variant], count(times), reason]
                for reason, times in one.reasons.items()
            ]
    return Table(["cell", "variant", "frames", "reason"], rows, {}, {})


def every_cell(results: Results) -> list[TrackedCell]:
    """Return every tracking cell once, whichever tables ask for it."""
    listed = [*results.table6, *results.table7, *results.table8]
    if results.vinag is not None:
        listed.append(results.vinag)
    return list({cell_title(tracked.cell): tracked for tracked in reversed(listed)}.values())[::-1]


def cell_title(cell: Cell) -> str:
    """Return a cell in words."""
    kind = cell.noise
    return (
        f"case {cell.case.key}, {cell.case.name}, {cell.case.target}; {kind.sigma_px:g} px, "
        f"{kind.outliers} outlier{'' if kind.outliers == 1 else 's'}"
    )


def _of(tracked: TrackedCell, window: str) -> tuple[dict[str, TrackingSummary], BoundSummary]:
    if window == "steady":
        return tracked.steady, tracked.bound_steady
    return tracked.settled, tracked.bound_settled
