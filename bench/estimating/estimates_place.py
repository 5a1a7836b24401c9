"""Where the estimates of image pairs may go: into a folder with none but ours."""

from __future__ import annotations

import json
from pathlib import Path

from models.dataset.description import read_info
from models.dataset.estimates_file import FORMAT
from models.errors import DatasetError
from models.output_folder import check_empty, check_place, foreign_names

KEYS = {"frame", "time_s", "status"}  # of a line of version 1, which had no head
RUNTIMES = ("frame,runtime_ms",)


def check_estimates_place(out: Path, frames: Path) -> None:
    """Refuse a folder whose estimates are somebody else's, or that is not ours altogether.

    The folder of the pairs is the user's own, and there only ``estimates`` must be ours.

    Parameters
    ----------
    out : Path
        The estimates will lie in ``out/estimates``.
    frames : Path
        The folder of the pairs.

    Raises
    ------
    DatasetError, StorageError
        Nothing was changed.
    """
    check_place(out)
    check_place(out / "estimates")
    ours = {name for name in foreign_names(out / "estimates") if is_ours(out / "estimates" / name)}
    check_empty(out / "estimates", "estimates that rvbench made", own=ours)
    if out.resolve() != frames.resolve() and not _is_dataset(out):
        check_empty(out, "estimates that rvbench made", own={"estimates"})


def is_ours(path: Path) -> bool:
    """Tell whether a file is one that only an estimate writes."""
    try:
        if not path.is_file():
            return False
        with path.open() as file:
            first = file.readline().strip()
        if path.name.endswith(".runtime.csv"):
            return first in RUNTIMES
        head = json.loads(first) if path.suffix == ".jsonl" else None
        return isinstance(head, dict) and (head.get("format") == FORMAT or set(head) >= KEYS)
    except (OSError, ValueError, TypeError, RecursionError):
        return False


def _is_dataset(folder: Path) -> bool:
    try:
        read_info(folder)
    except DatasetError:
        return False
    return True
