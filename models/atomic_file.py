"""Files that are whole or not there: written beside, flushed, then renamed into place."""

from __future__ import annotations

import os
from pathlib import Path

from models.errors import StorageError


def write_bytes(path: Path, data: bytes) -> None:
    """Write ``data`` to ``path`` atomically, making its folder if needed.

    Raises
    ------
    StorageError
        If the disk is full or read-only; what stood at ``path`` before still does.
    """
    scratch = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with scratch.open("wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            scratch.replace(path)
        except OSError:
            scratch.unlink(missing_ok=True)
            raise
    except OSError as error:
        raise StorageError(
            f"expected to write {path} ({len(data)} bytes), got: {error}; "
            "free some space or choose a folder you can write; "
            "everything written so far is whole, and the same command goes on from there"
        ) from error


def write_text(path: Path, text: str) -> None:
    """Write UTF-8 text atomically; see ``write_bytes``."""
    write_bytes(path, text.encode())
