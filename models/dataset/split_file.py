"""``splits.csv`` of a dataset: what each frame is for, where whoever made it has said so."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from models.errors import DatasetError
from models.reading.bounds import FRAME
from models.reading.csv_table import read_csv

FILE_NAME = "splits.csv"
COLUMNS = ("index", "split")
SPLITS = ("train", "val", "test")


def splits_to_csv(splits: Sequence[str]) -> str:
    """Return the text of the file; ``splits`` are those of frames 0, 1, 2, ..."""
    rows = (f"{index},{split}" for index, split in enumerate(splits))
    return "\n".join([",".join(COLUMNS), *rows]) + "\n"


def read_splits(folder: Path) -> dict[int, str] | None:
    """Return each frame's split; None where the dataset has no such file.

    Raises
    ------
    DatasetError
        If a row is broken, or a frame stands in it twice.
    """
    path = folder / FILE_NAME
    if not path.is_file():
        return None
    found: dict[int, str] = {}
    for row in read_csv(path, COLUMNS):
        index, split = row.whole("index", *FRAME), row.text("split")
        if split not in SPLITS:
            raise DatasetError(
                f"{path}: expected split as one of {', '.join(SPLITS)}, got {split!r} for frame "
                f"{index}"
            )
        if index in found:
            raise DatasetError(f"{path}: expected each frame once, got {index} twice")
        found[index] = split
    return found
