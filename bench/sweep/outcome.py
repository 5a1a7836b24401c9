"""What a sweep leaves in its folder: table, maps, extremes, page; and a summary in the terminal."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table

from bench.report.numbers import NONE, number
from bench.sweep.extremes import OF_EACH, extremes, ranked, told, write_extremes
from bench.sweep.page import MapOnPage, write_page
from bench.sweep.run import SweepResult, about
from bench.sweep.shots import read_shot
from bench.sweep.sun_map import sun_map
from bench.sweep.table import VERDICTS, Row, Setting, setting_of, to_csv, to_json
from models.atomic_file import write_bytes, write_text

OUR_PICTURE = re.compile(r"(sun_map(_\d+)?|(best|harshest)_\d+)\.png")


@dataclass(frozen=True)
class SweepFiles:
    """Where it all lies; the maps in the order of the settings."""

    maps: list[Path]
    csv: Path
    json: Path
    page: Path
    extremes: list[Path]


def write_outcome(result: SweepResult) -> SweepFiles:
    """Write everything that is made from the results.

    Raises
    ------
    StorageError
        If the folder cannot be written; the results themselves are kept.
    """
    out = result.plan.request.out
    csv, json = out / "sweep.csv", out / "sweep.json"
    write_text(csv, to_csv(result.rows))
    write_text(json, to_json(result.rows, about(result)))
    _sweep_away(out)
    maps = []
    for place, setting in enumerate(result.settings, start=1):
        name = "sun_map.png" if len(result.settings) == 1 else f"sun_map_{place}.png"
        rows = rows_of(result, setting, result.map_pipeline)
        thumbnails = _thumbnails(result, setting, rows)
        drawn = sun_map(title(result), setting, rows, thumbnails)
        write_bytes(out / name, drawn.png)
        maps.append(MapOnPage(setting, out / name, drawn, rows, thumbnails))
    shown = extremes(result, result.settings[0])
    pictures = write_extremes(out, shown)
    page = write_page(out / "sweep.html", result, title(result), maps, shown)
    return SweepFiles([each.path for each in maps], csv, json, page, pictures)


def title(result: SweepResult) -> str:
    """Return what was swept."""
    count = len(result.plan.suns)
    return f"{result.plan.scenario.name} under {count} Sun{'s' if count > 1 else ''}"


def rows_of(result: SweepResult, setting: Setting, pipeline: str) -> list[Row]:
    """Return the rows of one map, a row for each Sun.

    Parameters
    ----------
    result : SweepResult
    setting : Setting
    pipeline : str
    """
    return [row for row in result.rows if row.pipeline == pipeline and setting_of(row) == setting]


def print_sweep(console: Console, result: SweepResult) -> None:
    """Print counts and position errors of every setting and pipeline, and the extremes' names."""
    for setting in result.settings:
        table = Table(
            title=f"{title(result)}: {setting.title}", title_justify="left", box=box.SIMPLE_HEAD
        )
        table.add_column("pipeline", no_wrap=True)
        for head in (*VERDICTS, "median, mm", "worst, mm"):
            table.add_column(head, justify="right")
        for pipeline in (each.label for each in result.plan.pipelines):
            rows = rows_of(result, setting, pipeline)
            counts = [str(sum(row.verdict == verdict for row in rows)) for verdict in VERDICTS]
            table.add_row(pipeline, *counts, *_errors(rows))
        console.print(table)
    best, harshest = ranked(rows_of(result, result.settings[0], result.map_pipeline))
    for name, rows in (("kindest", best), ("harshest", harshest)):
        for row in rows[:OF_EACH]:
            line = f"{name}: Sun {row.sun}: {told(row)}"
            console.print(line, soft_wrap=True, highlight=False, markup=False)


def _errors(rows: list[Row]) -> tuple[str, str]:
    errors = [row.position_error_mm for row in rows if row.position_error_mm is not None]
    if not errors:
        return NONE, NONE
    return number(float(np.median(errors))), number(max(errors))


def _thumbnails(result: SweepResult, setting: Setting, rows: list[Row]) -> list[np.ndarray]:
    records = (read_shot(result.plan.request.out, result.shots[setting, r.sun_text]) for r in rows)
    return [each.thumbnail for each in records if each is not None and each.thumbnail is not None]


def _sweep_away(out: Path) -> None:
    """Delete the pictures of the last time, which may have been of other settings."""
    for path in (*out.glob("sun_map*.png"), *(out / "extremes").glob("*.png")):
        if OUR_PICTURE.fullmatch(path.name):
            path.unlink()
