"""Put the report together: one HTML file, everything in it, nothing fetched."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jinja2

from bench.estimating.runs import dataset_fingerprint
from bench.pictures.frame_record import PREFERRED, FrameRecords
from bench.pictures.marker_overlay import LEGEND
from bench.pictures.stretch import STRETCH
from bench.report import figures, tables
from bench.report.filmstrip import HERO_WIDTH_PX, Picture, filmstrip, picture
from bench.report.numbers import number
from bench.report.pairs.published import published_case
from bench.report.scenario_tables import scenario_tables
from bench.scoring.score import read_score
from models.atomic_file import write_text
from models.dataset.dataset import read_info
from models.errors import DatasetError

TEMPLATE = "page.html.jinja"


@dataclass(frozen=True)
class Card:
    """One of the numbers at the top."""

    value: str
    unit: str
    label: str
    note: str


def write_report(folder: Path) -> Path:
    """Write ``report.html`` of a scored dataset.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    DatasetError
        If the dataset or its score is missing, or a frame cannot be read.
    """
    score = read_score(folder)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    path = folder / "report.html"
    write_text(path, environment.get_template(TEMPLATE).render(_context(folder, score)))
    return path


def _context(folder: Path, score: dict[str, Any]) -> dict[str, Any]:
    info = read_info(folder)
    chosen = PREFERRED if PREFERRED in score["pipelines"] else next(iter(score["pipelines"]))
    records = FrameRecords(folder, chosen)
    headline = score["pipelines"][chosen]
    if [row["frame"] for row in headline["per_frame"]] != list(records.entries):
        raise DatasetError(
            f"{folder}/score.json: expected a score of the {len(records.entries)} frames that "
            f"{folder}/frames.csv lists, got one of {len(headline['per_frame'])} others; "
            f"run `rvbench estimate {folder}`, then `rvbench score {folder}`"
        )
    published = published_case(info.target, info.sun)
    std_px = None if published is None else published.centroid_std_px
    variants = tables.variants_of(score)
    scenario = scenario_tables(folder)
    ranges = [row["range_m"] for row in headline["per_frame"]]
    return {
        "info": info,
        "score": score,
        "variant": chosen,
        "cards": _cards(headline),
        "hero": _hero(records, headline),
        "frames": filmstrip(records, headline["lost"]["frames"]),
        "legend": LEGEND,
        "stretch": STRETCH,
        "range_m": (number(max(ranges)), number(min(ranges))),
        "span_s": [headline["per_frame"][place]["time_s"] for place in (0, -1)],
        "camera": records.knowledge.camera,
        "detector": records.knowledge.detector,
        "published": published,
        "headline": tables.headline_table(score),
        "beside": tables.published_table(score, published),
        "ranges": {variant: tables.range_table(score, variant) for variant in variants},
        "lost": tables.lost_table(score),
        "figures": {
            "pose": figures.svg_address(figures.pose_error_figure(score)),
            "centroid": figures.svg_address(figures.centroid_figure(score, std_px)),
            "markers": figures.svg_address(figures.markers_figure(score)),
        },
        "scenario": scenario,
        "calibration": _calibration(scenario),
        "fingerprint": dataset_fingerprint(folder),
        "folder": folder.name,
    }


def _hero(records: FrameRecords, headline: dict[str, Any]) -> Picture:
    """Draw the frame in the middle of those with a pose, large."""
    rows = [row for row in headline["per_frame"] if row["reason"] is None]
    rows = rows or headline["per_frame"]
    return picture(records.record(rows[len(rows) // 2]["frame"]), HERO_WIDTH_PX)


def _cards(headline: dict[str, Any]) -> list[Card]:
    position, attitude = headline["position_error_mm"], headline["attitude_error_deg"]
    std_px = headline["centroid_error_px"]["std"]
    efficiency = headline["efficiency"]["position"]
    lost = headline["lost"]
    found = f"{headline['estimated']} of {headline['frames']}"
    return [
        Card(number(position["median"]), "mm", "position error, median",
             f"95 % below {number(position['p95'])} mm"),
        Card(number(attitude["median"]), "deg", "attitude error, median",
             f"95 % below {number(attitude['p95'])} deg"),
        Card(number(max(std_px)) if std_px else number(None), "px", "centroid noise, worse axis",
             f"{headline['centroid_error_px']['count']} centroids"),
        Card(number(efficiency), "× bound", "position, over Cramér–Rao",
             "1 is the best there is"),
        Card(found, "frames", "with a pose", f"{lost['missed'] or 'none'} missed"),
    ]  # fmt: skip


def _calibration(scenario: dict[str, dict[str, Any]]) -> str:
    """Say how far the camera was calibrated wrong."""
    table = scenario.get("calibration")
    if table is None:
        return "what ours carry is not on record"
    focal, centre = table["sigma_focal_px"], table["sigma_principal_point_px"]
    if focal == 0.0 and centre == 0.0:
        return "ours are calibrated exactly"
    return f"ours carry {focal:g} px in focal length and {centre:g} px in principal point"
