"""What ``make speed`` measured, as tables."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table

from bench.cycles.noise import Cost

if TYPE_CHECKING:
    from bench.cycles.speed_row import Row


def spread(values: list[float], digits: int = 1) -> str:
    """Return the middle of some values, and the least and the most of them."""
    low, middle, high = min(values), float(np.median(values)), max(values)
    if len(values) == 1:
        return f"{middle:.{digits}f}"
    return f"{middle:.{digits}f} ({low:.{digits}f} to {high:.{digits}f})"


def _seconds(costs: list[Cost]) -> list[str]:
    return [
        spread([cost.whole_s for cost in costs]),
        spread([cost.rest_s for cost in costs]),
        f"{float(np.median([cost.processor_s for cost in costs])):.1f}",
        f"{max(cost.peak_mib for cost in costs):.0f}",
    ]


def print_rows(console: Console, rows: list[Row], first: dict[str, Cost], folder: Path) -> None:
    """Print times and memory, then ratios beside their targets.

    Parameters
    ----------
    console : Console
    rows : list of Row
    first : dict of str to Cost
        What the first run of a scene took, kernels compiled, by what it was.
    folder : Path
        Of what was written.
    """
    costs = Table(title="What it took", box=box.SIMPLE, title_justify="left")
    for column in ("", "whole, s", "but light, s", "processor, s", "peak, MiB"):
        costs.add_column(column, justify="right" if column else "left")
    ratios = Table(title="Ratios of whole times", box=box.SIMPLE, title_justify="left")
    columns = ("", "equal noise", "of processor", "equal samples", "light alone", "noise", "target")
    for column in columns:
        ratios.add_column(column, justify="right" if column else "left")
    for row in rows:
        one, other = ("mitsuba", "rvbench") if row.bare else ("rvbench", "Cycles")
        costs.add_row(f"{row.what}: {one}", *_seconds(row.ours))
        costs.add_row(f"{row.what}: {other}", *_seconds(row.theirs))
        sign = "at most" if row.bare else "at least"
        word = "reached" if row.reached else "[bold red]missed[/]"
        ratios.add_row(
            f"{row.what}: {other} over {one}",
            spread(row.at_equal_noise, 2),
            spread(row.of_processor_at_equal_noise, 2),
            spread(row.at_equal_samples, 2),
            spread(row.of_light_alone, 2),
            f"{row.noise_ratio:.2f}, {row.whole_frame_noise_ratio:.2f}",
            f"{sign} {row.target:g}: {word}",
        )
    for what, cost in first.items():
        costs.add_row(f"{what}: rvbench's first, kernels compiled", *_seconds([cost]))
    console.print(costs)
    console.print(ratios)
    console.print(
        "The target is held against equal noise; for bare Mitsuba, against light alone. Of "
        "processor: equal noise in processor time. Noise: the second's relative squared error over "
        "the first's at equal samples, per pixel and over the "
        f"frame. Everything is in {folder}/speed.json"
    )
