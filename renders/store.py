"""The radiance store: rendered light, keyed by the hash of all that shaped it.

One entry is one file, half-float, compressed, named by its key; it is written beside and renamed,
so a killed run leaves whole entries or none. An entry carries the hash of its own pixels, and one
that does not match is treated as absent and rendered again.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

from models.arrays import AnyArray, Radiance
from models.atomic_file import sweep_scratch, whole_or_absent, write_text
from renders.probe_cache import cache_folder

STORE_VERSION = 1
CACHE_SIGNATURE = "Signature: 8a477f597d28d172789f06886806bc55"
STDERR = 2  # the file descriptor
HALF_MAX = 65504.0  # a glint brighter than this saturates any detector a thousandfold


def default_store() -> Path:
    """Return ``$RVBENCH_STORE``, or a folder in the house's cache."""
    if named := os.environ.get("RVBENCH_STORE"):
        return Path(named)
    return cache_folder() / "store"


def entry_key(shaping: Mapping[str, Any]) -> str:
    """Return the key of what ``shaping`` describes; numbers enter with all their digits."""
    text = json.dumps({"store": STORE_VERSION, **shaping}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def write_exr(path: Path, channels: Mapping[str, AnyArray]) -> None:
    """Write an EXR file atomically, its pixels' hash in the header.

    Raises
    ------
    StorageError
        If the disk is full or read-only.
    """
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "rvbench_sha256": _pixels_hash(channels),
    }
    with whole_or_absent(path) as scratch:
        try:
            with OpenEXR.File(header, dict(channels)) as file:
                file.write(str(scratch))
        except RuntimeError as error:  # OpenEXR's word for a full disk
            raise OSError(str(error).rstrip(".").rpartition('". ')[2]) from error


def read_exr(path: Path) -> dict[str, AnyArray] | None:
    """Read an EXR file back, or None if it is absent, truncated or not what was written."""
    if not path.is_file():
        return None
    try:
        with _openexr_silenced(), OpenEXR.File(str(path), separate_channels=True) as file:
            recorded = file.header().get("rvbench_sha256")
            channels = {name: np.array(c.pixels) for name, c in file.channels().items()}
    except (OSError, RuntimeError, ValueError):
        return None
    return channels if recorded == _pixels_hash(channels) else None


@contextmanager
def _openexr_silenced() -> Iterator[None]:
    """Turn stderr and stdout off: OpenEXR writes pages there about a file that is damaged."""
    sys.stderr.flush()
    before, nowhere = os.dup(STDERR), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, STDERR)
        with redirect_stdout(io.StringIO()):
            yield
    finally:
        os.dup2(before, STDERR)
        os.close(before)
        os.close(nowhere)


def _pixels_hash(channels: Mapping[str, AnyArray]) -> str:
    digest = hashlib.sha256()
    for name in sorted(channels):
        digest.update(name.encode())
        digest.update(np.ascontiguousarray(channels[name]).data)
    return digest.hexdigest()


class RadianceStore:
    """A folder of radiance entries.

    Parameters
    ----------
    folder : Path
        Made when first written to.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def open_for_writing(self) -> None:
        """Make the folder, and delete what killed processes left half written in it.

        Raises
        ------
        StorageError
            If it cannot be written: better now than after the first light is traced.
        """
        tag = self.folder / "CACHEDIR.TAG"  # tells backups to pass by; see bford.info/cachedir
        if not tag.is_file() or not os.access(self.folder, os.W_OK):
            write_text(tag, f"{CACHE_SIGNATURE}\n# What is in here can be rendered again.\n")
        sweep_scratch(self.folder)

    def path(self, key: str) -> Path:
        """Return where the entry of ``key`` lies, whether it is there or not."""
        return self.folder / key[:2] / f"{key}.exr"

    def has(self, key: str) -> bool:
        """Tell whether an entry is there; ``read`` tells whether it is whole."""
        return self.path(key).is_file()

    def read(self, key: str) -> Radiance | None:
        """Return an entry as (height, width) float32, W m-2 sr-1, or None if absent or damaged."""
        channels = read_exr(self.path(key))
        if channels is None or set(channels) != {"Y"}:
            return None
        return np.asarray(channels["Y"], dtype=np.float32)

    def write(self, key: str, radiance: Radiance) -> None:
        """Write an entry, rounded to half floats."""
        half = np.minimum(radiance, HALF_MAX).astype(np.float16)
        write_exr(self.path(key), {"Y": half})
