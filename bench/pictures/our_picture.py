"""Pictures that say in their header who made them: no other file is written over."""

from __future__ import annotations

import os
import struct
import zlib
from pathlib import Path

from models.errors import DatasetError, cause
from models.output_folder import check_place

SIGNATURE_AND_SIZE = 33  # bytes of a PNG before its second chunk
MARK = b"Software\0rvbench"
MARKED_WITHIN = 200  # bytes


def marked(png: bytes) -> bytes:
    """Return a PNG with a chunk after its first that names rvbench as what wrote it."""
    body = b"tEXt" + MARK
    chunk = struct.pack(">I", len(MARK)) + body + struct.pack(">I", zlib.crc32(body))
    return png[:SIGNATURE_AND_SIZE] + chunk + png[SIGNATURE_AND_SIZE:]


def check_picture_place(out: Path) -> None:
    """Refuse a place where a folder stands, or a file that is no picture of ours.

    Raises
    ------
    DatasetError, StorageError
        Nothing was changed.
    """
    check_place(out.parent)
    if not os.path.lexists(out):
        return
    if out.is_dir():
        raise DatasetError(
            f"expected a picture's name, such as {out}/frame.png, got the folder {out}"
        )
    try:
        with out.open("rb") as file:
            start = file.read(MARKED_WITHIN) if out.is_file() else b""
    except OSError as error:
        raise DatasetError(
            f"expected a picture of ours or nothing at {out}, got: {cause(error)}"
        ) from error
    if MARK not in start:
        raise DatasetError(
            f"expected a picture of ours or nothing at {out}, found a file that `rvbench show` did "
            "not make; nothing was changed: choose another --out, or delete it"
        )
