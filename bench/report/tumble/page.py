"""The report of a run on rendered frames: one HTML file, everything in it, nothing fetched."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from models.dataset.image_dataset import read_image_info

from bench.estimating.runs import dataset_fingerprint
from bench.pictures.frame_record import PREFERRED
from bench.pictures.image_records import ImageRecord, ImageRecords
from bench.pictures.stretch import STRETCH
from bench.pictures.wireframe_overlay import LEGEND, window_around, wireframe_overlay
from bench.report.tumble import figures as tumble_figures
from bench.report.tumble import tables as tumble_tables
from bench.report.figures import svg_address
from bench.report.filmstrip import HERO_WIDTH_PX, Picture, chosen, jpeg
from bench.report.numbers import count, number, share
from bench.report.page import Card
from bench.report.scenario_tables import scenario_tables
from bench.report.tables import variants_of
from bench.scoring.tumble.parts import read_tumble_score
from models.atomic_file import write_text
from models.errors import DatasetError

TEMPLATE = "tumble_page.html.jinja"
STYLES = Path(__file__).parent.parent / "report"
FRAME_WIDTH_PX = 620


def write_tumble_report(folder: Path) -> Path:
    """Write ``report.html`` of a scored dataset of single images.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    DatasetError
        If the dataset or its score is missing, or an image cannot be read.
    """
    score = read_tumble_score(folder)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([Path(__file__).parent, STYLES]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    path = folder / "report.html"
    write_text(path, environment.get_template(TEMPLATE).render(_context(folder, score)))
    return path


def _context(folder: Path, score: dict[str, Any]) -> dict[str, Any]:
    variants = variants_of(score)
    variant = PREFERRED if PREFERRED in variants else variants[0]
    records = ImageRecords(folder, variant)
    headline = score["pipelines"][variant]
    if [row["frame"] for row in headline["per_frame"]] != list(records.entries):
        raise DatasetError(
            f"{folder}/score.json: expected a score of the {len(records.entries)} frames that "
            f"{folder}/frames.csv lists, got one of {len(headline['per_frame'])} others; "
            f"run `rvbench estimate {folder}`, then `rvbench score {folder}`"
        )
    missed = [row["frame"] for row in headline["per_frame"] if row["wrong"] or row["reason"]]
    frames = [_picture(records.record(i)) for i in chosen(list(records.entries), missed)]
    return {
        "info": read_image_info(folder),
        "score": score,
        "variant": variant,
        "cards": _cards(headline),
        "hero": _hero(records, headline),
        "frames": frames,
        "legend": LEGEND,
        "stretch": STRETCH,
        "camera": records.knowledge.camera,
        "target": records.knowledge.target,
        "span_s": [headline["per_frame"][place]["time_s"] for place in (0, -1)],
        "headline": tumble_tables.headline_table(score),
        "checks": tumble_tables.check_table(score),
        "starts": tumble_tables.starts_table(score),
        "limits": {each: tumble_tables.limit_table(score, each) for each in variants},
        "reasons": tumble_tables.reason_table(score),
        "figures": {
            "errors": svg_address(tumble_figures.error_figure(score)),
            "corners": svg_address(tumble_figures.corner_figure(score, variant)),
        },
        "scenario": scenario_tables(folder),
        "fingerprint": dataset_fingerprint(folder),
        "folder": folder.name,
    }


def _hero(records: ImageRecords, headline: dict[str, Any]) -> Picture:
    """Draw, close and large, the frame whose pose error is the median one."""
    rows = [row for row in headline["per_frame"] if row["error"]["attitude_deg"] is not None]
    rows.sort(key=lambda row: row["error"]["attitude_deg"])
    shown = rows[len(rows) // 2] if rows else headline["per_frame"][0]
    return _picture(records.record(shown["frame"]), HERO_WIDTH_PX, truth=False)


def _picture(record: ImageRecord, width_px: int = FRAME_WIDTH_PX, truth: bool = True) -> Picture:
    pose = record.best_known_pose
    words = [f"frame {record.frame.index}", f"{record.frame.time_s:.1f} s"]
    if record.truth is not None:
        words.append(f"{np.linalg.norm(record.truth.cam_from_target.translation):.1f} m")
    drawn = wireframe_overlay(
        record.frame,
        record.knowledge,
        width_px,
        estimate=record.estimate,
        truth=record.truth if truth else None,
        window=None if pose is None else window_around(record.knowledge, pose),
    )
    said = record.estimate
    return Picture(jpeg(drawn), " · ".join(words), record.verdict, said is None or not said)


def _cards(headline: dict[str, Any]) -> list[Card]:
    position, attitude = headline["position_m"], headline["attitude_deg"]
    starts = headline["starts"]
    cards = [
        Card(number(position["median"]), "m", "position error, median",
             f"95 % below {number(position['p95'])} m"),
        Card(number(attitude["median"]), "deg", "attitude error, median",
             f"95 % below {number(attitude['p95'])} deg"),
    ]  # fmt: skip
    if starts is not None:
        cards.append(
            Card(f"{starts['within']} of {starts['starts']}", "starts",
                 "acquired rightly without a prior",
                 f"{starts['first_image']} on the first image, {starts['wrong']} wrong")
        )  # fmt: skip
    return [
        *cards,
        Card(share(headline["lost_share"]), "", "of the images lost once acquired",
             f"longest run of wrong states: {count(headline['longest_wrong'])} frames"),
        Card(share(headline["corners"]["repeatability"]), "", "of the visible landmarks found",
             f"within 3 px, rms {number(headline['corners']['rms_px'])} px"),
    ]  # fmt: skip
