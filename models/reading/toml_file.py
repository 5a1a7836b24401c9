"""TOML files: bounded in size and depth."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from models.errors import UnreadableError
from models.reading.nesting import MOST_LEVELS, check_toml_nesting, too_deep
from models.reading.regular_file import MEGABYTE, read_text
from models.reading.shown import shown_line

MOST_TOML_BYTES = 4 * MEGABYTE


def read_toml(path: Path, most_bytes: int = MOST_TOML_BYTES) -> dict[str, Any]:
    """Read a TOML file; ``models.reading.fields`` checks what is in it.

    Raises
    ------
    UnreadableError
        If it is no regular file, too large, no UTF-8, nested too deep, or no TOML.
    """
    text = read_text(path, most_bytes)
    check_toml_nesting(path, text)
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # also a number of too many digits
        raise UnreadableError(path, shown_line(str(error))) from error
    if too_deep(table):
        raise UnreadableError(path, f"nested more than {MOST_LEVELS} deep")
    return table
