"""JSON files and JSON lines: bounded in size and depth, no key twice, no NaN, no infinity."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from models.errors import UnreadableError
from models.reading.nesting import check_json_nesting
from models.reading.regular_file import (
    MOST_LINE_BYTES,
    MOST_TABLE_BYTES,
    read_lines,
    read_text,
)
from models.reading.shown import shown, shown_line

MOST_DIGITS = 40  # of a whole number; a seed of 128 bits has 39


def read_json(path: Path, most_bytes: int = MOST_TABLE_BYTES) -> Any:
    """Read a JSON file; ``models.reading.fields`` checks what is in it.

    Raises
    ------
    UnreadableError
        If it is no regular file, too large, no UTF-8, nested too deep, no JSON, names a key twice
        in one table, or holds a number that is not finite.
    """
    return _parsed(path, read_text(path, most_bytes), None)


def read_json_table(path: Path, most_bytes: int = MOST_TABLE_BYTES) -> dict[str, Any]:
    """Read a JSON file whose outermost value is a table.

    Raises
    ------
    UnreadableError
        As ``read_json``, and if it is something else.
    """
    return _table(path, read_json(path, most_bytes), None)


def parse_json_table(path: Path, text: str) -> dict[str, Any]:
    """Parse JSON that stands in another file, such as a GLB; its outermost value is a table.

    Parameters
    ----------
    path : Path
        Where it stands, for messages.
    text : str

    Raises
    ------
    UnreadableError
        As ``read_json_table``, of what is parsed.
    """
    return _table(path, _parsed(path, text, None), None)


def read_json_lines(
    path: Path, most_bytes: int = MOST_TABLE_BYTES, most_line_bytes: int = MOST_LINE_BYTES
) -> list[tuple[int, dict[str, Any]]]:
    """Read a file of one JSON table a line: line numbers from 1, and the tables.

    Parameters
    ----------
    path : Path
    most_bytes : int
        Of the file.
    most_line_bytes : int
        Characters of a line.

    Raises
    ------
    UnreadableError
        As ``read_json_table``; the message names the line. An empty line is none of JSON.
    """
    lines = read_lines(path, most_bytes, most_line_bytes)
    return [
        (number, _table(path, _parsed(path, line, number), number))
        for number, line in enumerate(lines, start=1)
    ]


def parse_json_line(path: Path, text: str, line: int) -> dict[str, Any]:
    """Return the table that one line of a file holds, for who reads lines one at a time.

    Parameters
    ----------
    path : Path
        The file, for messages.
    text : str
    line : int
        Its number, from 1.

    Raises
    ------
    UnreadableError
        As ``read_json_table``.
    """
    return _table(path, _parsed(path, text, line), line)


def _table(path: Path, value: Any, line: int | None) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise UnreadableError(path, f"expected a table {{...}}, got {shown(value)}", line)
    return value


def _parsed(path: Path, text: str, line: int | None) -> Any:
    check_json_nesting(path, text, line)
    try:
        return _DECODER.decode(text)
    except json.JSONDecodeError as error:
        place = f"column {error.colno}" if line else f"line {error.lineno} column {error.colno}"
        raise UnreadableError(path, f"no JSON: {error.msg} at {place}", line) from error
    except (ValueError, RecursionError) as error:
        raise UnreadableError(path, shown_line(str(error)), line) from error


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in table if names.count(name) > 1)
        raise ValueError(f"the key {shown(twice)} twice in one table")
    return table


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"expected finite numbers, got {shown_line(text[:40])}")
    return value


def _whole(text: str) -> int:
    if len(text) > MOST_DIGITS:
        raise ValueError(f"a whole number of {len(text)} digits, more than {MOST_DIGITS}")
    return int(text)


_DECODER = json.JSONDecoder(
    object_pairs_hook=_unique, parse_constant=_finite, parse_float=_finite, parse_int=_whole
)
