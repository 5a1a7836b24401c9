"""Compare and write it down: JSON with every number and every frame, and the page."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from bench.compare.bootstrap import CONFIDENCE
from bench.compare.comparison import CompareOptions, Comparison, check_number, compared
from bench.compare.conditions import conditions
from bench.compare.methods import found_methods
from bench.compare.page import write_comparison_page
from bench.scoring.core_score import core_score
from bench.scoring.metrics import bop, speed
from bench.scoring.pose_measures import FrameMeasures, MethodMeasures
from bench.scoring.score import plain, rounded
from models.atomic_file import write_text
from models.errors import DatasetError, ScenarioError, UnreadableError
from models.output_folder import check_empty, check_place
from models.reading.json_file import read_json_table

FORMAT, VERSION = "rvbench-comparison", 1
FILE_NAME, PAGE_NAME = "comparison.json", "comparison.html"
MOST_BYTES = 4_000_000_000


def score_one(
    folder: Path, estimates: Path, out: Path, options: CompareOptions
) -> tuple[Comparison, dict[str, Any]]:
    """Score one file of estimates against a dataset.

    Parameters
    ----------
    folder : Path
        The dataset; it is only read.
    estimates : Path
    out : Path
        The score.
    options : CompareOptions

    Raises
    ------
    ScenarioError
        If the estimates are a folder with several.
    DatasetError
        If something cannot be read, or another's file stands at ``out``.
    """
    check_file_place(out)
    dataset, methods = found_methods([estimates], folder, options.file_format, options.choices)
    if len(methods) > 1:
        raise ScenarioError(
            f"expected one file with --estimates, got the folder {estimates} with "
            f"{len(methods)}; to compare them: `rvbench compare {estimates}`"
        )
    comparison = compared(dataset, methods, options)
    table = comparison_table(comparison)
    write_comparison(out, table)
    return comparison, table


def write_outcome(
    methods: Sequence[Path], dataset: Path | None, out: Path | None, options: CompareOptions
) -> tuple[Comparison, dict[str, Path]]:
    """Compare methods and write JSON and page; see ``compare_methods``.

    Parameters
    ----------
    methods : sequence of Path
    dataset : Path, optional
    out : Path, optional
        Folder; ``out/compare-CASE`` unless given.
    options : CompareOptions

    Returns
    -------
    Comparison, dict of str to Path
        And the files, by what they are.

    Raises
    ------
    RvbenchError
        If something cannot be read, or the folder holds what is not ours.
    """
    if out is not None:
        check_folder_place(out)
    opened, found = found_methods(methods, dataset, options.file_format, options.choices)
    check_number(found)
    if out is None:
        out = Path("out") / f"compare-{opened.info.case}"
        check_folder_place(out)
    comparison = compared(opened, found, options)
    write_comparison(out / FILE_NAME, comparison_table(comparison))
    write_comparison_page(out / PAGE_NAME, comparison)
    return comparison, {"table:": out / FILE_NAME, "page: ": out / PAGE_NAME}


def comparison_table(comparison: Comparison) -> dict[str, Any]:
    """Return what ``comparison.json`` says, numbers to nine digits, None for what is infinite."""
    view, options = comparison.view, comparison.options
    info, how = view.dataset.info, options.resampling
    board = comparison.board
    table = {
        "format": FORMAT,
        "version": VERSION,
        "rvbench": version("rvbench"),
        "case": info.case,
        "sun": info.sun,
        "target": info.target,
        "chain": info.chain,
        "dataset": {"fingerprint": view.dataset.fingerprint(), "frames": len(view.dataset.entries)},
        "made_by": _made_by(comparison),
        "bootstrap": {
            "seed": how.seed,
            "resamples": how.resamples,
            "block_frames": how.block(len(view.dataset.entries)),
            "confidence": CONFIDENCE,
        },
        "rank_by": board.rank_by,
        "standings": board.standings,
        "pairs": board.pairs,
        "groups": board.groups,
        "methods": {each.label: _method(comparison, each) for each in comparison.measures},
        "conditions": _conditions(comparison),
    }
    written: dict[str, Any] = rounded(plain(_as_dicts(table)))
    return written


def write_comparison(path: Path, table: dict[str, Any]) -> None:
    """Write a comparison, whole or not at all."""
    write_text(path, json.dumps(table, indent=1, allow_nan=False) + "\n")


def check_file_place(path: Path) -> None:
    """Refuse a place where a folder stands, or a file that is no comparison of ours.

    Raises
    ------
    DatasetError, StorageError
        Nothing was changed.
    """
    check_place(path.parent)
    if not path.exists() and not path.is_symlink():
        return
    try:
        ours = read_json_table(path, MOST_BYTES).get("format") == FORMAT
    except UnreadableError:
        ours = False
    if not ours:
        raise DatasetError(
            f"expected a comparison of ours or nothing at {path}, found what rvbench did not make; "
            "nothing was changed: choose another --out, or move it away"
        )


def check_folder_place(out: Path) -> None:
    """Refuse a folder that holds what no comparison of ours has made.

    Raises
    ------
    DatasetError, StorageError
        Nothing was changed.
    """
    check_place(out)
    own: set[str] = set()
    if (out / FILE_NAME).exists():
        check_file_place(out / FILE_NAME)
        own = {FILE_NAME, PAGE_NAME}
    check_empty(out, "a comparison that rvbench made", own=own)


def _as_dicts(table: dict[str, Any]) -> dict[str, Any]:
    return {
        key: [asdict(each) for each in value] if key in ("standings", "pairs", "groups") else value
        for key, value in table.items()
    }


def _made_by(comparison: Comparison) -> dict[str, Any]:
    """Return the definitions that the numbers depend on."""
    view, shape = comparison.view, comparison.view.shape
    told: dict[str, Any] = {
        "speed_floors": {
            "position": speed.FLOOR_POSITION,
            "attitude_deg": speed.FLOOR_ATTITUDE_DEG,
        },
        "speed_of_a_lost_frame": speed.LOST.score,
        "shape": None if shape is None else shape.source,
    }
    if shape is not None:
        told |= {
            "diameter_m": shape.diameter_m,
            "symmetries": len(shape.symmetries),
            "points": {"spread": len(shape.spread), "corners_of_the_hull": len(shape.corners)},
        }
    if view.grid is not None:
        told["vsd"] = {
            "every_nth_pixel": view.grid.stride,
            "delta_m": bop.VSD_DELTA_M,
            "scene_depth": view.scene_depth_source,
        }
    return told


def _method(comparison: Comparison, measures: MethodMeasures) -> dict[str, Any]:
    method = comparison.method(measures.label)
    return {
        "file": method.path.name,
        "format": method.format,
        "sha256": method.sha256,
        "missing": method.missing,
        "remarks": list(method.remarks),
        "core": asdict(core_score([measures.judged], measures.runtime_ms)),
        "measures": asdict(comparison.summaries[measures.label]),
        "per_frame": [_row(each) for each in measures.frames],
    }


def _row(frame: FrameMeasures) -> dict[str, Any]:
    shape = frame.shape
    return {
        "frame": frame.frame,
        "reason": frame.reason,
        "wrong": frame.wrong,
        "position_m": frame.position_m,
        "attitude_deg": frame.attitude_deg,
        "speed": None if frame.lost else frame.speed.score,
        "speed_floored": None if frame.lost else frame.speed.score_floored,
        "add_m": shape and shape.add_m,
        "add_s_m": shape and shape.add_s_m,
        "mssd_m": shape and shape.mssd_m,
        "mspd_px": shape and shape.mspd_px,
        "vsd": None if shape is None or shape.vsd is None else shape.vsd.tolist(),
    }


def _conditions(comparison: Comparison) -> list[dict[str, Any]]:
    told = conditions(comparison.view)
    entries = comparison.view.dataset.entries
    columns = {
        "frame": [entry.index for entry in entries],
        "time_s": [entry.time_s for entry in entries],
        "range_m": told.range_m,
        "phase_deg": told.phase_deg,
        "tumble_deg_s": told.tumble_deg_s,
    }
    return [
        {key: None if own is None else np.asarray(own)[place] for key, own in columns.items()}
        for place in range(len(entries))
    ]
