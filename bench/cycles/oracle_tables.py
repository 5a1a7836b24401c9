"""What ``make oracle`` found, as tables."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console
from rich.table import Table

from bench.cycles.regions import FEWEST_PIXELS, TOLERANCE, RegionMeans
from bench.cycles.shadow_edges import TOLERANCE_PX

if TYPE_CHECKING:
    from bench.cycles.oracle import PlateVerdict, SunVerdict


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, box=box.SIMPLE, title_justify="left")
    table.add_column(columns[0], overflow="fold")
    for column in columns[1:]:
        table.add_column(column, justify="right")
    return table


def _word(agrees: bool) -> str:
    return "agrees" if agrees else "[bold red]differs[/]"


def _region_word(region: RegionMeans) -> str:
    return _word(region.agrees) if region.telling else "too noisy"


def print_plate(console: Console, plate: list[PlateVerdict]) -> None:
    """Print the closed form of the Lambertian plate beside both renderers."""
    table = _table(
        "Lambertian plate, W m-2 sr-1", "Sun off normal", "E rho cos / pi", "rvbench", "Cycles", ""
    )
    for row in plate:
        table.add_row(
            f"{row.angle_deg:g} deg",
            f"{row.expected:.4f}",
            f"{row.ours:.4f}",
            f"{row.theirs:.4f}",
            _word(row.agrees),
        )
    console.print(table)


def print_regions(console: Console, sun: SunVerdict) -> None:
    """Print one Sun: the whole, kinds of material, regions, shadow edges."""
    columns = ("region", "pixels", "rvbench", "Cycles", "ratio", "+-", f"to {TOLERANCE:.0%}")
    table = _table(f"Sun {sun.sun}: mean radiance, W m-2 sr-1", *columns)

    def add(row: RegionMeans, word: str) -> None:
        table.add_row(
            row.name,
            f"{row.pixels}",
            f"{row.ours:.4g}",
            f"{row.theirs:.4g}",
            f"{row.ratio:.4f}",
            f"{row.ratio_error:.4f}",
            word,
        )

    add(sun.whole, "")
    for kind in sun.kinds:
        add(kind, _region_word(kind))
    table.add_section()
    shown = [region for region in sun.regions if region.pixels >= FEWEST_PIXELS]
    for region in sorted(shown, key=lambda region: -region.pixels):
        add(region, _region_word(region))
    console.print(table)
    edges = sun.edges
    console.print(
        f"{edges.edges} shadow edges: mean shift {edges.mean_px:+.3f} px, median size "
        f"{edges.median_abs_px:.3f} px, 95 of 100 within {edges.worst_of_95_percent_px:.3f} px "
        f"(allowed {TOLERANCE_PX:g}): {_word(edges.agrees)}\n"
    )


def print_verdict(console: Console, agreed: bool, folder: Path) -> None:
    """Print the outcome and where the pictures lie.

    Parameters
    ----------
    console : Console
    agreed : bool
        Whether everything lies within its tolerance.
    folder : Path
        Of what was written.
    """
    word = "rvbench and Cycles agree" if agreed else "[bold red]rvbench and Cycles differ[/]"
    console.print(f"{word}; numbers in {folder}/oracle.json, pictures in {folder}/maxar/")
