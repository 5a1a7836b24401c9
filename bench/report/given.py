"""What a scored dataset gives to its chain's report."""

from __future__ import annotations

from pathlib import Path

from bench.estimating.runs import PREFERRED
from bench.pictures.frame_record import FrameRecords
from bench.report.parts import ReportInput
from bench.report.scenario_tables import scenario_tables
from bench.scoring.score import read_score, shown_labels
from models.errors import DatasetError


def report_input(folder: Path) -> ReportInput:
    """Return what a scored dataset gives to its chain's report.

    Parameters
    ----------
    folder : Path

    Raises
    ------
    DatasetError
        If the dataset or its score is missing, or they do not belong together.
    """
    score = read_score(folder)
    label = PREFERRED if PREFERRED in score["pipelines"] else shown_labels(score)[0]
    records = FrameRecords(folder, label)
    rows = score["pipelines"][label]["per_frame"]
    if [row["frame"] for row in rows] != records.dataset.indices:
        raise DatasetError(
            f"{folder}/score.json: expected a score of the {len(records.dataset.entries)} frames "
            f"that {folder}/frames.csv lists, got one of {len(rows)} others; "
            f"run `rvbench estimate {folder}`, then `rvbench score {folder}`"
        )
    info = records.dataset.info
    return ReportInput(folder, info, score, label, records, scenario_tables(folder))
