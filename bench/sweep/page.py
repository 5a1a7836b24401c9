"""The page of a sweep: maps, table and extremes in one HTML file, nothing fetched."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import jinja2
import numpy as np
from numpy.typing import NDArray

from bench.pictures.stretch import STRETCH
from bench.report.explorer.inlined import policy
from bench.report.filmstrip import jpeg
from bench.report.numbers import number
from bench.sweep.extremes import Extreme, told
from bench.sweep.run import SweepResult
from bench.sweep.sun_map import FRAME_COLOURS, MEANINGS, SunMap
from bench.sweep.table import VERDICTS, Row, Setting, saturated, setting_of
from models.atomic_file import write_text

TEMPLATE, GLOBE = "page.html.jinja", "globe.js"
STYLES = Path(__file__).parent.parent / "report"
OTHER_MAPS_PX = 1100  # width of all maps but the first, which lie at full size beside the page
MOST_FRAMES = 600  # small frames on the page, beyond those of the first map
MOST_ROWS = 1000  # of the table on the page; the CSV has them all
HEAD = (
    "Sun, az/el deg", "verdict", "found", "in the Sun", "position, mm", "x", "y", "z",
    "attitude, deg", "saturated, %", "draws: position, mm rms", "least", "most", "without pose",
    "wrong", "reason",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class MapOnPage:
    """One setting's map: where it lies, itself, and the rows and frames on it."""

    setting: Setting
    path: Path
    drawn: SunMap
    rows: Sequence[Row]
    thumbnails: Sequence[NDArray[np.uint8]]


def write_page(
    path: Path, result: SweepResult, title: str, maps: Sequence[MapOnPage], shown: Sequence[Extreme]
) -> Path:
    """Write ``sweep.html``.

    Parameters
    ----------
    path : Path
    result : SweepResult
    title : str
    maps : sequence of MapOnPage
        In the order of the settings; the first is embedded at full size.
    shown : sequence of Extreme
        Of the first setting.

    Returns
    -------
    Path
        The file.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([Path(__file__).parent, STYLES]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    text = environment.get_template(TEMPLATE).render(_context(result, title, maps, shown))
    write_text(path, text)
    return path


def _context(
    result: SweepResult, title: str, maps: Sequence[MapOnPage], shown: Sequence[Extreme]
) -> dict[str, Any]:
    scenario = result.plan.scenario
    own = [row for row in result.rows if row.pipeline == result.map_pipeline]
    tables = [
        (setting.title, [_cells(row) for row in own if setting_of(row) == setting])
        for setting in result.settings
    ]
    frames = np.cumsum([len(each.rows) for each in maps])
    globe = (Path(__file__).parent / GLOBE).read_text()
    with_frames = set(np.flatnonzero(frames <= MOST_FRAMES).tolist()) | {0}
    return {
        "title": title,
        "policy": policy((globe,)),
        "script": globe,
        "draws": max(row.draws for row in own),
        "scenario": scenario,
        "camera": scenario.simulated_camera,
        "pipeline": result.map_pipeline,
        "maps": [
            {
                "title": each.setting.title,
                "alt": _alt(each),
                "file": each.path.name,
                "source": _png(each.drawn.png) if place == 0 else _smaller(each.drawn.png),
                "tiles": _tiles(each) if place in with_frames else [],
            }
            for place, each in enumerate(maps)
        ],
        "meanings": [MEANINGS[verdict] for verdict in VERDICTS],
        "counts": _counts(result),
        "extremes": [
            {
                "title": each.title,
                "verdict": each.verdict,
                "lost": each.row.verdict == "no pose",
                "source": jpeg(_rgb(each.picture)),
            }
            for each in shown
        ],
        "head": HEAD,
        "tables": tables if len(own) <= MOST_ROWS else tables[:1],
        "rows_in_all": len(result.rows),
        "stretch": STRETCH,
        "provenance": result.provenance,
    }


def _alt(own: MapOnPage) -> str:
    """Say what is seen on a map."""
    counts = {verdict: sum(row.verdict == verdict for row in own.rows) for verdict in VERDICTS}
    told = ", ".join(f"{MEANINGS[verdict]}: {count}" for verdict, count in counts.items() if count)
    return f"Map of {len(own.rows)} Sun directions, each with its frame; {told}"


def _tiles(own: MapOnPage) -> list[dict[str, Any]]:
    """Return each direction's frame with its place on the map."""
    return [
        {
            "sun": f"Sun at azimuth {row.azimuth_deg:.4g}, elevation {row.elevation_deg:.4g} deg",
            "verdict": f"{row.verdict}: {told(row)}",
            "lost": row.verdict == "no pose",
            "box": box,
            "azimuth_deg": f"{row.azimuth_deg:.4f}",
            "elevation_deg": f"{row.elevation_deg:.4f}",
            "colour": FRAME_COLOURS[row.verdict],
            "source": jpeg(_rgb(thumbnail)),
        }
        for row, thumbnail, box in zip(own.rows, own.thumbnails, own.drawn.boxes, strict=True)
    ]


def _counts(result: SweepResult) -> list[list[str]]:
    """Return, for each setting and pipeline, how many directions came to what, and the errors."""
    table = []
    for setting in result.settings:
        for pipeline in (each.label for each in result.plan.pipelines):
            rows = [
                row
                for row in result.rows
                if row.pipeline == pipeline and setting_of(row) == setting
            ]
            errors = [row.position_error_mm for row in rows if row.position_error_mm is not None]
            turns = [row.attitude_error_deg for row in rows if row.attitude_error_deg is not None]
            table.append(
                [
                    f"{setting.title}, {pipeline}",
                    *(str(sum(row.verdict == verdict for row in rows)) for verdict in VERDICTS),
                    *(
                        number(float(statistic(values)) if values else None)
                        for values in (errors, turns)
                        for statistic in (np.median, np.max)
                    ),
                ]
            )
    return table


def _cells(row: Row) -> list[str]:
    signed = (row.error_x_mm, row.error_y_mm, row.error_z_mm)
    return [
        row.sun,
        row.verdict,
        f"{row.found}/{row.expected}",
        str(row.in_sun),
        number(row.position_error_mm),
        *(number(value, signed=True) for value in signed),
        number(row.attitude_error_deg),
        number(saturated(row)),
        *(number(mm) for mm in (row.position_rms_mm, row.position_least_mm, row.position_most_mm)),
        f"{row.draws_without_pose} of {row.draws}",
        f"{row.draws_wrong} of {row.draws}",
        row.reason,
    ]


def _rgb(grey: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.repeat(grey[:, :, None], 3, axis=2)


def _png(data: bytes) -> str:
    return "data:image/png;base64," + base64.b64encode(data).decode()


def _smaller(data: bytes) -> str:
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    assert image is not None, "a map that matplotlib has just encoded"
    height_px = round(image.shape[0] * OTHER_MAPS_PX / image.shape[1])
    small = cv2.resize(image, (OTHER_MAPS_PX, height_px), interpolation=cv2.INTER_AREA)
    return jpeg(np.asarray(small[:, :, ::-1], dtype=np.uint8))
