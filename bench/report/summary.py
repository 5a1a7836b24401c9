"""A score in the terminal: the pipelines side by side, and what was asked of them."""

from __future__ import annotations

import textwrap
from typing import Any

from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table as TextTable

from bench.report.table import (
    CORE_TERMS,
    TIME_TERMS,
    Table,
    check_table,
    core_cells,
    headline,
    time_cells,
)
from bench.scoring.score import shown_labels

NARROW = 12  # characters: no heading is broken into shorter lines
LONGEST_NAME = 28  # of a row, on one line of a table that must be narrow
WIDEST = 10_000


def print_summary(console: Console, score: dict[str, Any], table: Table | None = None) -> None:
    """Print the headline numbers of a score.

    Parameters
    ----------
    console : Console
    score : dict
    table : Table, optional
        The chain's own headline table; the common core unless given.
    """
    shown = core_table(score) if table is None else table
    runs = f"{score['runs']} run" + ("s" if score["runs"] > 1 else "")
    title = f"{score['case']}, Sun {score['sun']}, {runs}"
    print_table(console, shown, title)
    checks = check_table(score)
    if checks.rows:
        print_table(console, checks, "asked")


def core_table(score: dict[str, Any]) -> Table:
    """Compare the pipelines by what every chain says of them."""
    columns = {
        label: [*core_cells(own["core"]), *time_cells(own["core"])]
        for label, own in ((label, score["pipelines"][label]) for label in shown_labels(score))
    }
    return headline(score, (*CORE_TERMS, *TIME_TERMS), columns)


def print_table(console: Console, shown: Table, title: str) -> None:
    """Print a table under a title; numbers that belong together stay on one line.

    Where all columns are too wide for the terminal, those that fit come first, and the others in
    tables of their own below, with the same rows. A column that is too wide by itself is wrapped.

    Parameters
    ----------
    console : Console
    shown : Table
    title : str
    """
    whole = _part(shown, range(1, len(shown.head)), title, dense=False)
    if _fits(console, whole):
        console.print(whole)
        return
    first = 1
    while first < len(shown.head):
        last = len(shown.head)
        while last > first + 1 and not _fits(console, _part(shown, range(first, last), title)):
            last -= 1
        part = _part(shown, range(first, last), title)
        if not _fits(console, part):
            part = _part(shown, range(first, last), title, wrapped=True)
        console.print(part)
        first, title = last, ""


def _part(
    shown: Table, columns: range, title: str, *, dense: bool = True, wrapped: bool = False
) -> TextTable:
    """Return some columns beside the names of the rows."""
    table = TextTable(
        title=title or None,
        title_justify="left",
        box=box.SIMPLE_HEAD,
        pad_edge=not dense,
        collapse_padding=dense,
    )
    table.add_column(shown.head[0], no_wrap=not wrapped)
    for place in columns:
        head = shown.head[place]
        if dense:
            widest = max((cell_len(row[place]) for row in shown.rows), default=0)
            head = textwrap.fill(head, max(widest, NARROW), break_long_words=False)
        table.add_column(head, justify="right", no_wrap=not wrapped)
    for row in shown.rows:
        name = textwrap.fill(row[0], LONGEST_NAME) if dense else row[0]
        table.add_row(name, *(row[place] for place in columns))
    return table


def _fits(console: Console, table: TextTable) -> bool:
    options = console.options.update(width=WIDEST)
    return Measurement.get(console, options, table).maximum <= console.width
