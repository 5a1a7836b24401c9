"""A score in the terminal: the two variants side by side."""

from __future__ import annotations

from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

from bench.report.tables import headline_table


def print_summary(console: Console, score: dict[str, Any]) -> None:
    """Print the headline numbers of a score."""
    rows = headline_table(score)
    table = Table(
        title=f"{score['case']}, Sun {score['sun']}, {score['runs']} run"
        + ("s" if score["runs"] > 1 else ""),
        title_justify="left",
        box=box.SIMPLE_HEAD,
    )
    table.add_column("", no_wrap=True)
    for title in rows.head[1:]:
        table.add_column(title, justify="right")
    for row in rows.rows:
        table.add_row(*row)
    console.print(table)
