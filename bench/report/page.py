"""Put the report together: one HTML file, everything in it, nothing fetched."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jinja2

from bench.estimating.runs import PREFERRED
from bench.pictures.frame_record import FrameRecords
from bench.report.filmstrip import HERO_WIDTH_PX, filmstrip, picture
from bench.report.parts import ReportInput, Section, TitledTable
from bench.report.scenario_tables import scenario_tables
from bench.report.table import TITLES, check_table, lost_table, title_of
from bench.scoring.score import read_score, shown_labels
from models.atomic_file import write_text
from models.errors import DatasetError

TEMPLATE = "page.html.jinja"


def write_report(folder: Path) -> Path:
    """Write ``report.html`` of a scored dataset.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    DatasetError
        If the dataset or its score is missing, they do not belong together, or a frame cannot be
        read.
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
    label = PREFERRED if PREFERRED in score["pipelines"] else shown_labels(score)[0]
    records = FrameRecords(folder, label)
    rows = score["pipelines"][label]["per_frame"]
    if [row["frame"] for row in rows] != records.dataset.indices:
        raise DatasetError(
            f"{folder}/score.json: expected a score of the {len(records.dataset.entries)} frames "
            f"that {folder}/frames.csv lists, got one of {len(rows)} others; "
            f"run `rvbench estimate {folder}`, then `rvbench score {folder}`"
        )
    info, chain = records.dataset.info, records.chain
    scenario = scenario_tables(folder)
    parts = chain.report(ReportInput(folder, info, score, label, records, scenario))
    checks = Section(
        "What was asked, and what came", tables=(TitledTable("asked", check_table(score)),)
    )
    lost = Section(
        "Frames without a pose",
        tables=(TitledTable("Frames without a pose", lost_table(score), wide=True),),
        nothing="None.",
    )
    return {
        "info": info,
        "score": score,
        "label": title_of(label),
        "parts": parts,
        "before": [*parts.before, *([] if checks.is_empty else [checks])],
        "later": [*parts.later, lost],
        "hero": picture(records, parts.hero, HERO_WIDTH_PX),
        "frames": filmstrip(records, parts.shown),
        "marks": ". ".join(each.capitalize() for each in (chain.legend, chain.greys) if each),
        "span_s": [rows[place]["time_s"] for place in (0, -1)],
        "camera": records.onboard.camera,
        "explained": set(TITLES) <= set(score["pipelines"]),
        "scenario": scenario,
        "fingerprint": records.dataset.fingerprint(),
    }
