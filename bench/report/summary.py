"""A score in the terminal: the pipelines side by side, and what was asked of them."""

from __future__ import annotations

from typing import Any

from rich import box
from rich.console import Console
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
    """Print a table under a title.

    Parameters
    ----------
    console : Console
    shown : Table
    title : str
    """
    table = TextTable(title=title, title_justify="left", box=box.SIMPLE_HEAD)
    for place, head in enumerate(shown.head):
        first = place == 0
        table.add_column(head, justify="left" if first else "right", no_wrap=first)
    for row in shown.rows:
        table.add_row(*row)
    console.print(table)
