"""EXR files under a seal: the hash of every byte of the file, in its own header.

The seal is a string attribute of 64 hexadecimal digits, the SHA-256 of the file with zeros in
their place. One bit that is changed anywhere, in the pixels as in the header, or a byte that is
missing, breaks it; and it is tested without decompressing a pixel. To every other program the
file is an ordinary EXR.

Pixels are compressed with ZIP. On 2048 x 2048 half floats of a sunlit Maxar-1300 (16 groups, the
mean; the time is that of one core) every EXR reader can open the smallest file of all:

=========  ======  ======  ================================
ZIP        2.7 MB  105 ms  a third of the raw 8.4 MB
PXR24      2.9 MB   80 ms
ZIPS       3.0 MB  127 ms
ZSTD       3.1 MB  110 ms  OpenEXR 3.5 alone reads it
PIZ        3.2 MB  186 ms
HTJ2K256   3.3 MB   42 ms  OpenEXR 3.4 and later reads it
RLE        3.5 MB   31 ms
=========  ======  ======  ================================

OpenEXR lets go of the interpreter while it works, so that threads write files side by side.
"""

from __future__ import annotations

import hashlib
import io
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

from models.arrays import AnyArray
from models.atomic_file import write_bytes
from models.errors import UnreadableError
from models.reading.regular_file import MEGABYTE, read_bytes

SEAL = "rvbench_seal"
DIGITS = 64
OPEN = b"0" * DIGITS
FIELD = SEAL.encode() + b"\0string\0" + struct.pack("<i", DIGITS)
MOST_BYTES = 4000 * MEGABYTE  # an image of 8192 x 8192 in a few channels
HEADER_BYTES = 65536  # the seal is in the first part's header: within this

EARLIER_SEAL = b"rvbench_sha256\0"
CUT_SHORT = "it is cut short, or another program wrote it"
EARLIER = "an earlier rvbench wrote it, and this one cannot use it"
CHANGED = "its bytes are no longer those that were written"


def write_exr(
    path: Path, channels: Mapping[str, AnyArray], attributes: Mapping[str, str] | None = None
) -> None:
    """Write an EXR file atomically and under seal.

    Parameters
    ----------
    path : Path
    channels : mapping of str to (height, width) float16 or float32 arrays
    attributes : mapping of str to str, optional
        More for the header.

    Raises
    ------
    StorageError
        If the disk is full or read-only.
    """
    write_bytes(path, exr_bytes(channels, attributes))


def exr_bytes(
    channels: Mapping[str, AnyArray], attributes: Mapping[str, str] | None = None
) -> bytes:
    """Return an EXR file under seal.

    Parameters
    ----------
    channels : mapping of str to (height, width) float16 or float32 arrays
    attributes : mapping of str to str, optional
        More for the header.
    """
    header = {**flat_header(), **(attributes or {}), SEAL: OPEN.decode()}
    with OpenEXR.File(header, dict(channels)) as file:
        return sealed(file)


def flat_header() -> dict[str, Any]:
    """Return the header attributes of every image in the house."""
    return {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}


def sealed(file: Any) -> bytes:
    """Return the bytes of an OpenEXR file whose first header holds an open seal, now closed."""
    stream = io.BytesIO()
    file.write(stream)
    data = stream.getvalue()
    place = data.index(FIELD + OPEN) + len(FIELD)
    digest = hashlib.sha256(data).hexdigest().encode()
    return b"".join((data[:place], digest, data[place + DIGITS :]))


def fault(data: bytes) -> str | None:
    """Return what is wrong with the bytes of a sealed file, or None if they are as written."""
    start = data.find(FIELD, 0, HEADER_BYTES)
    if start < 0:
        return EARLIER if EARLIER_SEAL in data[:HEADER_BYTES] else CUT_SHORT
    place, view = start + len(FIELD), memoryview(data)
    digest = hashlib.sha256(view[:place])
    digest.update(OPEN)
    digest.update(view[place + DIGITS :])
    return None if digest.hexdigest().encode() == data[place : place + DIGITS] else CHANGED


def whole_bytes(path: Path) -> bytes | None:
    """Return a sealed file's bytes, or None if it is absent or its seal is broken."""
    try:
        data = read_bytes(path, MOST_BYTES)
    except UnreadableError:  # a pipe or a device, too: it would never end
        return None
    return data if fault(data) is None else None


def read_exr(path: Path, attributes: Mapping[str, str] | None = None) -> dict[str, AnyArray] | None:
    """Read a file's channels back, or None if it is absent or not what was written.

    Parameters
    ----------
    path : Path
    attributes : mapping of str to str, optional
        What its header must say.

    Returns
    -------
    dict of str to (height, width) arrays, or None
        By channel.
    """
    data = whole_bytes(path)
    if data is None:
        return None
    with OpenEXR.File(io.BytesIO(data), separate_channels=True) as file:
        header = file.header()
        if any(header.get(name) != text for name, text in (attributes or {}).items()):
            return None
        return {name: np.array(channel.pixels) for name, channel in file.channels().items()}
