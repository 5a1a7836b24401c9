"""What kind of folder of ours one is, by the file that marks it."""

from __future__ import annotations

from pathlib import Path

from models.errors import RvbenchError
from models.reading.json_file import read_json_table

MARKS = {
    "random_dataset.json": "random dataset",
    "dataset.json": "dataset",
    "export.json": "export",
    "units/made_by.json": "suite",
    "truth/scenario.toml": "sweep",
}
"""Kinds by their marks, in the order in which a folder is asked for them."""
OTHER_MARKS = {"comparison.json": "comparison", "CACHEDIR.TAG": "store of light"}
OURS = "rvbench-"
STORE_TOLD = b"What is in here can be rendered again."
MOST_TAG_BYTES = 4096


def kind_of(folder: Path) -> str | None:
    """Return the kind of a folder that rvbench made; None if its mark is missing or not ours."""
    for name, kind in {**MARKS, **OTHER_MARKS}.items():
        path = folder / name
        if path.is_file() and _is_ours(path):
            return kind
    return None


def _is_ours(path: Path) -> bool:
    """Tell whether a mark is ours by what it says; that of a sweep lies where only ours does."""
    if path.suffix == ".toml":
        return True
    try:
        if path.suffix == ".json":
            return str(read_json_table(path).get("format", "")).startswith(OURS)
        with path.open("rb") as file:
            return STORE_TOLD in file.read(MOST_TAG_BYTES)
    except (OSError, RvbenchError):
        return False
