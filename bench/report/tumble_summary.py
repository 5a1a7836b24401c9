"""A tumble's score in a terminal: the main numbers of every variant."""

from __future__ import annotations

from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

from bench.report.tumble.tables import check_table, headline_table

SHOWN = (
    "frames", "with a state", "lost", "position error, median", "position error, p95",
    "attitude error, median", "attitude error, p95", "wrong states", "longest wrong",
    "repeatability", "corner error",
)  # fmt: skip


def print_tumble_summary(console: Console, score: dict[str, Any]) -> None:
    """Print what a run on rendered frames came to, and what was asked of it."""
    headline = headline_table(score)
    table = Table(title=f"{score['case']}, {score['target']}", box=box.SIMPLE)
    for place, title in enumerate(headline.head):
        table.add_column(title, justify="left" if place == 0 else "right")
    for row in headline.rows:
        if row[0] in SHOWN:
            table.add_row(*row)
    console.print(table)
    checks = check_table(score)
    asked = Table(box=box.SIMPLE)
    for title in checks.head:
        asked.add_column(title)
    for row in checks.rows:
        asked.add_row(*row)
    console.print(asked)
