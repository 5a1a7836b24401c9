"""A table stream as CSV: the frame that gets a row, the row's time, and what was measured."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from models.dataset.frame_table import FrameEntry
from models.errors import DatasetError
from models.frame import TableReading
from models.reading.bounds import FRAME, TIME_S
from models.reading.csv_table import CsvRow, read_csv

LARGEST = 1e15  # of any number: below it all arithmetic stays finite
SAME_TIME_S = 1e-6


def table_to_csv(columns: tuple[str, ...], readings: Iterable[tuple[int, TableReading]]) -> str:
    """Return the text of a table stream, from its readings by frame; numbers keep all digits."""
    lines = [",".join(("index", "time_s", *columns))]
    for index, reading in readings:
        for time_s, row in zip(reading.time_s.tolist(), reading.rows.tolist(), strict=True):
            lines.append(",".join([str(index), repr(time_s), *map(repr, row)]))
    return "\n".join(lines) + "\n"


def read_table(
    path: Path, columns: tuple[str, ...], entries: Iterable[FrameEntry]
) -> dict[int, TableReading]:
    """Read a table stream: its readings by frame; a frame without rows has an empty one.

    Parameters
    ----------
    path : Path
    columns : tuple of str
        Beside ``index`` and ``time_s``.
    entries : iterable of FrameEntry
        The frames of the dataset.

    Raises
    ------
    DatasetError
        If the file, a column or a number is missing, a row is of no frame or of a time after it,
        or times run back.
    """
    by_frame: dict[int, tuple[list[float], list[list[float]]]] = {
        entry.index: ([], []) for entry in entries
    }
    time_of = {entry.index: entry.time_s for entry in entries}
    last_s = -np.inf
    for row in _rows(path, columns):
        index, time_s = row.whole("index", *FRAME), row.number("time_s", *TIME_S)
        if index not in by_frame:
            raise DatasetError(
                f"{row.where}: expected the number of a frame of frames.csv, got {index}"
            )
        if time_s > time_of[index] + SAME_TIME_S or time_s < last_s:
            raise DatasetError(
                f"{row.where}: expected times that do not run back, up to frame {index}'s, "
                f"{time_of[index]} s; got {time_s} s"
            )
        last_s = time_s
        by_frame[index][0].append(time_s)
        by_frame[index][1].append([row.number(name, -LARGEST, LARGEST) for name in columns])
    return {index: _reading(columns, *own) for index, own in by_frame.items()}


def _rows(path: Path, columns: tuple[str, ...]) -> Iterable[CsvRow]:
    if not path.exists():
        raise DatasetError(
            f"{path}: No such file, where a sensor's table was expected, as dataset.json tells; "
            "render again: only what is missing is rendered"
        )
    return read_csv(path, ("index", "time_s", *columns))


def _reading(
    columns: tuple[str, ...], times_s: list[float], rows: list[list[float]]
) -> TableReading:
    table = np.array(rows, dtype=np.float64).reshape(len(rows), len(columns))
    return TableReading(columns, np.array(times_s, dtype=np.float64), table)
