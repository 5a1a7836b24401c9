"""Score a dataset: every pipeline variant that has spoken, against the truth, into score.json.

The truth of a frame is that of its 850 nm exposure, to whose middle the estimate is stamped. A
frame without a pose is never dropped: it counts in ``frames`` and is listed in ``lost``. The same
estimates and truth give the same bytes, ``runtime_ms`` apart. What each number means is told by
the dataclasses of ``bench.scoring.score_card``.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from bench.estimating.runs import found_runs, found_variants, read_run
from bench.scoring.judged_frames import read_true_dataset
from bench.scoring.score_card import SCORE_FORMAT, SCORE_VERSION, Score
from bench.scoring.variant_score import score_variant
from models.atomic_file import write_text
from models.dataset.dataset import read_info
from models.errors import DatasetError, UnreadableError, cause
from models.reading.json_file import read_json

SIGNIFICANT_DIGITS = 9  # far below any error, far above what differs between processors


def score_dataset(folder: Path) -> dict[str, Any]:
    """Score the estimates of a dataset and write ``score.json``.

    Returns
    -------
    dict
        What the file holds.

    Raises
    ------
    DatasetError
        If the dataset, its truth half or its estimates are missing or do not belong together.
    """
    info = read_info(folder)
    dataset = read_true_dataset(folder)
    if not dataset.frames:
        raise DatasetError(f"{folder}/frames.csv: expected at least one frame, found none")
    pipelines = {}
    for variant in found_variants(folder):
        numbers = found_runs(folder, variant)
        runs = [read_run(folder, number, variant, dataset.entries) for number in numbers]
        pipelines[variant] = score_variant(runs, dataset)
    score = Score(
        format=SCORE_FORMAT,
        version=SCORE_VERSION,
        case=info.case,
        sun=info.sun,
        target=info.target,
        frames=len(dataset.frames),
        runs=max(variant.pooled.runs for variant in pipelines.values()),
        pipelines=pipelines,
    )
    table: dict[str, Any] = _rounded(asdict(score))
    write_text(folder / "score.json", json.dumps(table, indent=1, allow_nan=False) + "\n")
    return table


def read_score(folder: Path) -> dict[str, Any]:
    """Read ``score.json`` back.

    Raises
    ------
    DatasetError
        If it is missing, broken, or of another version.
    """
    path = folder / "score.json"
    try:
        table = read_json(path)
    except UnreadableError as error:
        raise DatasetError(
            f"expected a score at {path}, got: {cause(error)}; run `rvbench score {folder}` first"
        ) from error
    known = isinstance(table, dict) and table.get("format") == SCORE_FORMAT
    if not known or table.get("version") != SCORE_VERSION:
        raise DatasetError(
            f"{path}: expected {SCORE_FORMAT} version {SCORE_VERSION}, got another; "
            f"run `rvbench score {folder}` again"
        )
    if broken := _what_is_broken(table):
        raise DatasetError(
            f"{path}: expected a whole score, but {broken}; run `rvbench score {folder}` again"
        )
    return dict(table)


def _what_is_broken(table: dict[str, Any]) -> str:
    """Say what keeps a table from being a ``Score``; nothing if it is one."""
    try:
        score = TypeAdapter(Score).validate_python(table)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        return f"at {place}: {first['msg'].lower()}"
    return "" if score.pipelines else "no pipeline is in it"


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.{SIGNIFICANT_DIGITS}g}")
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(item) for item in value]
    return value
