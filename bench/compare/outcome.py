"""A comparison as JSON: every number of the tables, what it was made of, and every frame."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from bench.compare.bootstrap import CONFIDENCE
from bench.compare.comparison import Comparison
from bench.compare.conditions import conditions
from bench.compare.leaderboard import Value
from bench.compare.outcome_place import FORMAT
from bench.scoring.core_score import core_score
from bench.scoring.metrics import bop, speed
from bench.scoring.pose_measures import FrameMeasures, MethodMeasures
from bench.scoring.score import plain, rounded
from models.atomic_file import sweep_beside, write_text

VERSION = 1


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
    sweep_beside(path)
    write_text(path, json.dumps(table, indent=1, allow_nan=False) + "\n")


def standings_csv(comparison: Comparison) -> str:
    """Return the leaderboard as CSV: of all frames, then of each group of like conditions.

    A number that is infinite, for half of the frames are lost, is an empty cell.
    """
    measures = list(comparison.board.standings[0].values)
    ends = [f"{name}{end}" for name in measures for end in ("", "_low", "_high")]
    rows: list[list[Any]] = [["by", "low", "high", "method", "frames", "lost", *ends]]
    summaries = comparison.summaries
    for own in comparison.board.standings:
        frames = summaries[own.label].frames
        lost = frames - summaries[own.label].estimated
        rows.append(["", "", "", own.label, frames, lost, *_cells(own.values)])
    for each in comparison.board.groups:
        place = [each.by, each.low, each.high, each.label, each.frames, each.lost]
        rows.append([*place, *_cells(each.values)])
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(rows)
    return stream.getvalue()


def _cells(values: dict[str, Value]) -> list[str]:
    numbers = [each for own in values.values() for each in (own.value, *own.interval)]
    return ["" if each is None else f"{each:.9g}" for each in numbers]


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
            "model_points": {
                "spread": len(shape.spread),
                "corners_of_the_hull": len(shape.corners),
            },
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
