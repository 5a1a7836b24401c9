"""Bytes and text of a regular file, and of nothing else: a pipe would keep its reader waiting."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from models.errors import UnreadableError, cause

MEGABYTE = 1_000_000
MOST_TABLE_BYTES = 64 * MEGABYTE  # CSV and JSON: a day of estimates at 5 Hz takes a tenth
MOST_LINE_BYTES = 4 * MEGABYTE

KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def read_bytes(path: Path, most_bytes: int = MOST_TABLE_BYTES) -> bytes:
    """Read a regular file whole, or a link to one.

    Raises
    ------
    UnreadableError
        If it is missing, no regular file (it is not opened then), or larger than ``most_bytes``.
    """
    data = read_beginning(path, most_bytes + 1)
    if len(data) > most_bytes:
        raise UnreadableError(
            path,
            f"more than {most_bytes / MEGABYTE:g} MB, the most that a file of this kind may have",
        )
    return data


def read_beginning(path: Path, count: int) -> bytes:
    """Read up to so many bytes from the beginning of a regular file, or of a link to one.

    Raises
    ------
    UnreadableError
        If it is missing, or no regular file (it is not opened then).
    """
    try:
        _refuse_other_kinds(path, os.stat(path).st_mode)
        flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
        with open(os.open(path, flags), "rb") as file:
            status = os.fstat(file.fileno())
            _refuse_other_kinds(path, status.st_mode)
            data = file.read(min(count, status.st_size + 1))  # a read takes all the room it asks
            while len(data) < count and (more := file.read(min(count - len(data), MEGABYTE))):
                data += more
            return data
    except (OSError, ValueError) as error:  # a ValueError is a NUL in the path
        raise UnreadableError(path, cause(error)) from error


def read_text(path: Path, most_bytes: int = MOST_TABLE_BYTES) -> str:
    """Read a regular file as UTF-8, with or without a byte order mark.

    Raises
    ------
    UnreadableError
        As ``read_bytes``, and if it is no UTF-8.
    """
    data = read_bytes(path, most_bytes)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise UnreadableError(
            path, f"byte {data[error.start]:#04x} is no UTF-8 text; save it as UTF-8", line
        ) from error


def read_lines(
    path: Path, most_bytes: int = MOST_TABLE_BYTES, most_line_bytes: int = MOST_LINE_BYTES
) -> list[str]:
    r"""Read the lines of a text file, which end in ``\n`` or ``\r\n``; the last may lack its end.

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
        As ``read_text``, and if a line is too long.
    """
    lines = read_text(path, most_bytes).split("\n")
    if lines[-1] == "":
        lines.pop()
    for number, line in enumerate(lines, start=1):
        if len(line) > most_line_bytes:
            raise UnreadableError(
                path, f"more than {most_line_bytes} characters, the most of one line", number
            )
    return [line.removesuffix("\r") for line in lines]


def state_of(path: Path) -> tuple[int, ...]:
    """Return what changes when a file is written anew, or empty where none is there."""
    try:
        told = os.stat(path)
    except (OSError, ValueError):
        return ()
    return told.st_ino, told.st_size, told.st_mtime_ns, told.st_ctime_ns


def holds_text(path: Path, text: str) -> bool:
    """Tell whether a regular file is there and holds a text, to the byte."""
    data = text.encode()
    try:
        return read_beginning(path, len(data) + 1) == data
    except UnreadableError:
        return False


def check_regular(path: Path) -> None:
    """Refuse what is no regular file, nor a link to one, for who reads it piece by piece.

    Raises
    ------
    UnreadableError
        If it is missing, or something else.
    """
    try:
        _refuse_other_kinds(path, os.stat(path).st_mode)
    except OSError as error:
        raise UnreadableError(path, cause(error)) from error


def _refuse_other_kinds(path: Path, mode: int) -> None:
    if not stat.S_ISREG(mode):
        kind = KINDS.get(stat.S_IFMT(mode), "something else")
        raise UnreadableError(path, f"{kind}, where a file was expected")
