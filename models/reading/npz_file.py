"""NumPy's archives of arrays: bounded in size, without pickles, whole or refused."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from pathlib import Path

import numpy as np

from models.arrays import AnyArray
from models.errors import UnreadableError
from models.reading.regular_file import MOST_TABLE_BYTES, read_bytes
from models.reading.shown import shown_line

# What zipfile, zlib and NumPy raise at bytes that are not as they were written; a RuntimeError is a
# flag that says encrypted, or a method of compression that there is not.
NOT_AS_WRITTEN = (
    ValueError, KeyError, EOFError, OSError, zipfile.BadZipFile, zlib.error, struct.error,
    RuntimeError, SyntaxError, TypeError, OverflowError, MemoryError,
)  # fmt: skip


def read_npz(path: Path, most_bytes: int = MOST_TABLE_BYTES) -> dict[str, AnyArray]:
    """Read every array of an archive, by name.

    Returns
    -------
    dict of str to (...,) arrays

    Raises
    ------
    UnreadableError
        If it is missing, no regular file, too large, or not as NumPy writes it.
    """
    data = read_bytes(path, most_bytes)
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            return {name: np.asarray(file[name]) for name in file.files}
    except NOT_AS_WRITTEN as error:
        told = shown_line(str(error)) or type(error).__name__
        raise UnreadableError(path, f"no archive of arrays: {told}") from error
