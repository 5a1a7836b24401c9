"""BOP results: ``scene_id,im_id,obj_id,score,R,t,time``, one row an estimate (BOP Challenge 2019).

``R`` is nine numbers row by row, ``t`` three in mm, both apart by spaces: ``cam_from_target``. An
image's number is the frame's. A file may say several poses of one image; as the challenge does for
one instance, that of the highest score is taken. ``time`` is in s, for the whole image; -1 where
nobody measured. Images without a row are lost.
"""

from __future__ import annotations

import re

import numpy as np

from bench.estimating.foreign_estimates.said_poses import LEAVE_OUT, Choices, SaidPoses
from models.errors import DatasetError
from models.pose import RigidTransform
from models.reading.bounds import FRAME, LENGTH_M, TIME_S
from models.reading.csv_table import CsvRow, csv_rows
from models.reading.fields import Fields
from models.reading.shown import shown

COLUMNS = ("scene_id", "im_id", "obj_id", "score", "R", "t", "time")
HEADER = ",".join(COLUMNS)
MOST_NUMBER = 10_000_000
MM = 1e-3
NOT_MEASURED = -1.0
MOST_CELL_CHARACTERS = 500
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,4})?", re.ASCII)


def read_bop_results(lines: list[str], said: SaidPoses, choices: Choices) -> None:
    """Read the lines of a results file.

    Parameters
    ----------
    lines : list of str
        Its header first.
    said : SaidPoses
        Takes what it says.
    choices : Choices

    Raises
    ------
    DatasetError
        If a row cannot be, is of no frame, scenes or objects are several and none was chosen, or
        an image has two poses of the highest score.
    """
    rows = csv_rows(lines, said.path, COLUMNS)
    rows = _only(rows, "scene_id", choices.scene, "--scene")
    rows = _only(rows, "obj_id", choices.target, "--object")
    by_frame: dict[int, list[tuple[float, CsvRow]]] = {}
    for row in rows:
        frame = row.whole("im_id", *FRAME)
        said.check_frame(frame, row.where)
        _pose(row)  # whatever its score, a pose that cannot be is refused
        by_frame.setdefault(frame, []).append((row.number("score", -1e300, 1e300), row))
    for frame, own in by_frame.items():
        best = max(score for score, _ in own)
        for row in (row for score, row in own if score == best):
            said.add(frame, _pose(row), row.where)
            spent_s = row.number("time", NOT_MEASURED, TIME_S[1])
            if spent_s >= 0.0:
                said.runtime_ms[frame] = 1e3 * spent_s
    left = len(rows) - len(by_frame)
    if left:
        said.remarks.append(f"{left} estimates of lower score than another of their image left out")


def _only(rows: list[CsvRow], key: str, chosen: int | None, option: str) -> list[CsvRow]:
    numbers = [row.whole(key, 0, MOST_NUMBER) for row in rows]
    there = sorted(set(numbers))
    if chosen is None and len(there) > 1:
        raise rows[0].refusal(
            key, "the same in all rows", f"{', '.join(map(str, there[:5]))}; choose one by {option}"
        )
    if chosen is not None and chosen not in there:
        where = rows[0].where if rows else "the file"
        raise DatasetError(f"{where}: expected a row of {key} {chosen}, got none; see {option}")
    return [row for row, own in zip(rows, numbers, strict=True) if chosen in (None, own)]


def _pose(row: CsvRow) -> RigidTransform:
    cells = {
        "R": np.array(_numbers(row, "R", 9)).reshape(3, 3).tolist(),
        "t": [MM * each for each in _numbers(row, "t", 3)],
    }
    try:
        return Fields(cells, row.where).pose("R", "t", *LENGTH_M)
    except DatasetError as error:
        raise DatasetError(f"{error}; {LEAVE_OUT}") from error


def _numbers(row: CsvRow, key: str, count: int) -> list[float]:
    cell = row.text(key, MOST_CELL_CHARACTERS)
    parts = cell.split()
    if len(parts) != count or not all(_NUMBER.fullmatch(part) for part in parts):
        raise row.refusal(key, f"as {count} numbers apart by spaces", f"{shown(cell)}; {LEAVE_OUT}")
    return [float(part) for part in parts]
