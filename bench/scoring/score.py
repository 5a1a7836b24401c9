"""Score a dataset: every pipeline that has spoken, against the truth, into ``score.json``.

A frame without a pose is never dropped: it counts in ``frames`` and is listed in ``lost``. The same
estimates and truth give the same bytes, ``runtime_ms`` apart. Version 2 has for each pipeline a
``core``, which is the same for every chain, the chain's own ``parts`` by name, and ``per_frame``;
``docs/migration.md`` says where the keys of version 1 have gone. A ``checksum`` of all but the
runtimes tells a whole score from one that was cut or edited.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.chains.catalogue import chain_named
from bench.chains.chain import Chain
from bench.estimating.runs import (
    Run,
    estimates_path,
    found_runs,
    found_variants,
    read_run,
    spoken_variants,
)
from bench.scoring.core_score import core_score
from bench.scoring.judgement import Judgement
from models.atomic_file import sweep_beside, write_text
from models.dataset.dataset import Dataset, open_dataset
from models.errors import DatasetError, UnreadableError
from models.reading.json_file import read_json_table
from models.reading.regular_file import check_regular

FORMAT, VERSION = "rvbench-score", 2
OLD_FORMATS = ("rvbench-score", "rvbench-tumble-score")
SIGNIFICANT_DIGITS = 9  # far below any error, far above what differs between processors
MOST_BYTES = 4_000_000_000


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
    dataset = open_dataset(folder)
    dataset.check_images()
    chain = chain_named(dataset.info.chain)
    truth = chain.truth(dataset)
    pipelines = {label: _score(dataset, chain, truth, label) for label in found_variants(folder)}
    info = dataset.info
    scored: dict[str, Any] = rounded(
        {
            "format": FORMAT,
            "version": VERSION,
            "case": info.case,
            "sun": info.sun,
            "target": info.target,
            "chain": info.chain,
            "frames": len(dataset.entries),
            "runs": max(each["core"]["pooled"]["runs"] for each in pipelines.values()),
            "estimates": {label: estimates_hash(folder, label) for label in pipelines},
            "pipelines": pipelines,
        }
    )
    table = {**scored, "checksum": _checksum(scored)}
    sweep_beside(folder / "score.json")
    write_text(folder / "score.json", json.dumps(table, indent=1, allow_nan=False) + "\n")
    return table


def read_score(folder: Path) -> dict[str, Any]:
    """Read ``score.json`` back.

    Raises
    ------
    DatasetError
        If it is missing, broken, of another version, or of other estimates than those there are.
    """
    path, again = folder / "score.json", f"run `rvbench score {folder}`"
    try:
        table = read_json_table(path, MOST_BYTES)
    except UnreadableError as error:
        raise DatasetError(
            f"expected a score at {path}, got: {error.told}; {again} first"
        ) from error
    if table.get("format") in OLD_FORMATS and table.get("version") == 1:
        raise DatasetError(
            f"{path}: expected {FORMAT} version {VERSION}, got {table['format']} version 1, whose "
            f"keys have moved (docs/migration.md says where to); {again} again"
        )
    if (table.get("format"), table.get("version")) != (FORMAT, VERSION):
        raise DatasetError(
            f"{path}: expected {FORMAT} version {VERSION}, got another; {again} again"
        )
    if broken := _what_is_broken(table):
        raise DatasetError(f"{path}: expected a whole score, but {broken}; {again} again")
    unscored = sorted({*spoken_variants(folder)} - {*table["estimates"]})
    if unscored:
        raise DatasetError(
            f"{path}: expected a score of all the estimates that are there, but "
            f"{', '.join(unscored)} came later; {again} again"
        )
    for label, own in table["estimates"].items():
        if estimates_hash(folder, label) != own:
            raise DatasetError(
                f"{path}: expected a score of the estimates that are there, but {label}'s have "
                f"changed since; {again} again"
            )
    return table


def estimates_hash(folder: Path, label: str) -> str:
    """Return a hash of a pipeline's estimates in all runs, as hexadecimal text."""
    digest = hashlib.sha256()
    for number in found_runs(folder, label):
        path = estimates_path(folder, number, label)
        check_regular(path)
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _score(dataset: Dataset, chain: Chain, truth: Any, label: str) -> dict[str, Any]:
    numbers = found_runs(dataset.folder, label)
    runs = [read_run(dataset, number, label) for number in numbers]
    judged = [_judged(dataset, chain, truth, run) for run in runs]
    core = core_score(judged, list(runs[0].runtime_ms.values()))
    parts = {part.name: plain(part.score(judged, truth, label)) for part in chain.parts}
    rows = zip(judged[0], chain.frame_rows(judged, truth), strict=True)
    return {
        "core": asdict(core),
        "parts": parts,
        "per_frame": [{**_row(judgement), **plain(own)} for judgement, own in rows],
    }


def _judged(dataset: Dataset, chain: Chain, truth: Any, run: Run) -> Sequence[Judgement]:
    try:
        return chain.judge(run, truth)
    except DatasetError as error:
        path = estimates_path(dataset.folder, run.number, run.label)
        raise DatasetError(f"{path}: {error}") from error


def _row(judgement: Judgement) -> dict[str, Any]:
    """Return what every chain says of a frame."""
    said = judgement.estimate
    return {
        "frame": said.frame,
        "time_s": said.time_s,
        "range_m": judgement.range_m,
        "mode": said.mode or None,
        "reason": judgement.reason,
        "missed": judgement.missed,
        "wrong": judgement.wrong,
        "position_error_mm": None if judgement.position_m is None else 1e3 * judgement.position_m,
        "attitude_error_deg": judgement.attitude_deg,
    }


def plain(part: Any) -> Any:
    """Return what a chain says as JSON has it: arrays as lists, None for what is not finite."""
    if is_dataclass(part) and not isinstance(part, type):
        return plain(asdict(part))
    if isinstance(part, Mapping):
        return {str(key): plain(item) for key, item in part.items()}
    if isinstance(part, np.ndarray | np.generic):
        return plain(part.tolist())
    if isinstance(part, list | tuple):
        return [plain(item) for item in part]
    if isinstance(part, float) and not math.isfinite(part):
        return None
    return part


def _what_is_broken(table: dict[str, Any]) -> str:
    """Say what keeps a table from being a score; nothing if it is one."""
    for key in ("case", "sun", "target", "chain"):
        if not isinstance(table.get(key), str):
            return f"{key} is no text"
    pipelines, told = table.get("pipelines"), table.get("estimates")
    if not isinstance(pipelines, dict) or not pipelines:
        return "no pipeline is in it"
    if not isinstance(told, dict) or set(told) != set(pipelines):
        return "it does not say of which estimates it is"
    for label, own in pipelines.items():
        for key, kind in (("core", dict), ("parts", dict), ("per_frame", list)):
            if not isinstance(own, dict) or not isinstance(own.get(key), kind):
                return f"pipelines.{label} lacks {key}"
        if not _are_times(own["core"].get("runtime_ms")):
            return f"pipelines.{label}.core.runtime_ms has not two numbers"
    content = {key: value for key, value in table.items() if key != "checksum"}
    if table.get("checksum") != _checksum(content):
        return "something in it is missing or was changed since it was written"
    return ""


def _are_times(told: Any) -> bool:
    return isinstance(told, dict) and all(
        told.get(key, "") is None or type(told.get(key)) in (int, float)
        for key in ("median", "p95")
    )


def _checksum(content: dict[str, Any]) -> str:
    """Return a hash of a score but for its runtimes, which change from run to run."""
    pipelines = {
        label: {**own, "core": {**own["core"], "runtime_ms": None}}
        for label, own in content["pipelines"].items()
    }
    text = json.dumps({**content, "pipelines": pipelines}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def rounded(value: Any) -> Any:
    """Return numbers to nine digits, in whatever tables and lists they stand."""
    if isinstance(value, float):
        return float(f"{value:.{SIGNIFICANT_DIGITS}g}")
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(item) for item in value]
    return value


def shown_labels(score: dict[str, Any]) -> Sequence[str]:
    """Return the labels of a score's pipelines, ``best`` first."""
    return sorted(score["pipelines"], key=lambda label: (label != "best", label))
