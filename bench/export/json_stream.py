"""JSON written piece by piece, so that a file of a million entries needs the memory of one."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from typing import Any


def whole(value: Any) -> list[bytes]:
    """Return a small value as the text of a file."""
    return [(json.dumps(value, indent=2) + "\n").encode()]


def entries(pairs: Iterable[tuple[str, Any]]) -> Iterator[bytes]:
    """Return a table with an entry a line."""
    yield b"{\n"
    begun = False
    for key, value in pairs:
        yield f"{',' if begun else ''}{chr(10) if begun else ''}  {json.dumps(key)}: ".encode()
        yield json.dumps(value).encode()
        begun = True
    yield b"\n}\n"


def items(values: Iterable[Any]) -> Iterator[bytes]:
    """Return a list with an item a line."""
    yield b"[\n"
    yield from _lines(values)
    yield b"\n]\n"


def lines(values: Iterable[Any]) -> Iterator[bytes]:
    """Return JSON lines."""
    for value in values:
        yield (json.dumps(value) + "\n").encode()


def table_of_lists(head: Mapping[str, Any], lists: Mapping[str, Iterable[Any]]) -> Iterator[bytes]:
    """Return a table of small values and long lists.

    Parameters
    ----------
    head : mapping
        Small values by key.
    lists : mapping of iterables
        Each is walked once.
    """
    yield b"{\n"
    for key, value in head.items():
        yield f"{json.dumps(key)}: {json.dumps(value)},\n".encode()
    for number, (key, values) in enumerate(lists.items()):
        yield f"{',' if number else ''}{chr(10) if number else ''}{json.dumps(key)}: [\n".encode()
        yield from _lines(values)
        yield b"\n]"
    yield b"\n}\n"


def _lines(values: Iterable[Any]) -> Iterator[bytes]:
    begun = False
    for value in values:
        yield (",\n" if begun else "").encode() + json.dumps(value).encode()
        begun = True
