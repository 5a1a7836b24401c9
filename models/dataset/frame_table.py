"""``frames.csv``: the number, time and exposure time of each frame."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from models.errors import DatasetError
from models.reading.bounds import EXPOSURE_MS, FRAME, TIME_S
from models.reading.csv_table import read_csv

FILE_NAME = "frames.csv"


@dataclass(frozen=True)
class FrameEntry:
    """One row.

    Attributes
    ----------
    index : int
    time_s : float, s
    exposure_ms : float, ms
        Of each image of the frame; 0 where nothing is exposed.
    """

    index: int
    time_s: float
    exposure_ms: float = 0.0


def frames_to_csv(entries: Iterable[FrameEntry]) -> str:
    """Return the text of ``frames.csv``; numbers keep all their digits."""
    rows = "".join(
        f"{int(entry.index)},{float(entry.time_s)!r},{float(entry.exposure_ms)!r}\n"
        for entry in entries
    )
    return "index,time_s,exposure_ms\n" + rows


def read_frame_entries(folder: Path) -> list[FrameEntry]:
    """Read ``frames.csv``, in order of time.

    Raises
    ------
    DatasetError
        If the file is missing, a column or number is missing or cannot be, or indices or times do
        not rise.
    """
    path = folder / FILE_NAME
    if not path.exists():
        raise DatasetError(
            f"{path}: No such file, where the frames of a dataset were expected; "
            "run the render again, it goes on where it stopped"
        )
    entries = [
        FrameEntry(
            index=row.whole("index", *FRAME),
            time_s=row.number("time_s", *TIME_S),
            exposure_ms=row.number("exposure_ms", 0.0, EXPOSURE_MS[1])
            if "exposure_ms" in row
            else 0.0,
        )
        for row in read_csv(path, ("index", "time_s"), ("exposure_ms",))
    ]
    for before, after in pairwise(entries):
        if after.index <= before.index or after.time_s <= before.time_s:
            raise DatasetError(f"{path}: expected rising indices and times, got {before}, {after}")
    return entries
