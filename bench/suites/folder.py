"""The folder of a suite, and the file that marks it as ours from its first moment.

::

    DIR/units/made_by.json    which suite: the first file to be written
        units/                what each unit came to, see ``bench.suites.units``
        suite.json, suite.html
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from models.atomic_file import sweep_beside, write_text
from models.errors import DatasetError, UnreadableError
from models.output_folder import check_empty, check_place
from models.reading.json_file import read_json_table

FORMAT, VERSION = "rvbench-suite", 1


def begin(out: Path, suite: str) -> None:
    """Mark a folder as one of a suite, unless it is already.

    Parameters
    ----------
    out : Path
        Made if needed.
    suite : str
        Its name.

    Raises
    ------
    DatasetError
        If it holds another suite, or what is not ours; nothing was changed.
    StorageError
        If it cannot be written.
    """
    check_place(out)
    there = _named(out / "units" / "made_by.json") or _named(out / "suite.json")
    if there is None:
        check_empty(out, "a suite that rvbench made")
    elif there != suite:
        raise DatasetError(
            f"expected {out} to be empty or to hold the suite {suite}, it holds {there}; "
            "nothing was changed: choose another --out"
        )
    text = json.dumps({"format": FORMAT, "suite": suite}) + "\n"
    write_text(out / "units" / "made_by.json", text)


def _named(path: Path) -> str | None:
    """Return the suite that a file of ours names; None if it is none of ours."""
    try:
        table = read_json_table(path)
        return str(table["suite"]) if table["format"] == FORMAT else None
    except (UnreadableError, KeyError):
        return None


def write_document(out: Path, suite: str, settings: dict[str, Any], **found: Any) -> Path:
    """Write ``suite.json`` and return where it is.

    Parameters
    ----------
    out : Path
        The suite's folder.
    suite : str
        Its name.
    settings : dict
        What shaped it.
    **found
        What came of it, ready for JSON.
    """
    head = {"format": FORMAT, "version": VERSION, "suite": suite, "settings": settings}
    sweep_beside(out / "suite.json")
    write_text(out / "suite.json", json.dumps({**head, **found}, indent=1) + "\n")
    return out / "suite.json"
