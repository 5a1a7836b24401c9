"""The radiance store: rendered light, keyed by the hash of all that shaped it.

One entry is one EXR file, half-float, compressed and sealed, named by its key; it is written
beside and renamed, so a killed run leaves whole entries or none. One that is not as it was written
is treated as absent and rendered again.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import AnyArray, Radiance
from models.atomic_file import link_or_copy, sweep_scratch, write_text
from models.errors import StorageError
from models.output_folder import check_empty, check_place
from renders.store.budget import Room, budget_bytes, mark_used
from renders.store.claims import Claim, held
from renders.store.sealed_exr import read_exr, write_exr
from renders.variant.probe_cache import cache_folder

STORE_VERSION = 2
KEY = "rvbench_key"  # in the header: an entry under another's name is none
CACHE_SIGNATURE = "Signature: 8a477f597d28d172789f06886806bc55"
HALF_MAX = 65504.0  # a glint brighter than this saturates any detector a thousandfold
OWN_NAME = re.compile(r"[0-9a-f]{2}|claims")
MOST_WRITERS = 8


def default_store() -> Path:
    """Return ``$RVBENCH_STORE``, or a folder in the house's cache."""
    if named := os.environ.get("RVBENCH_STORE"):
        return Path(named)
    return cache_folder() / "store"


def entry_key(shaping: Mapping[str, Any]) -> str:
    """Return the key of what ``shaping`` describes; numbers enter with all their digits."""
    text = json.dumps({"store": STORE_VERSION, **shaping}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def as_half(radiance: AnyArray) -> AnyArray:
    """Return radiance in the half floats in which all light is kept; of halves, themselves.

    Parameters
    ----------
    radiance : (...,) array, W m-2 sr-1

    Returns
    -------
    (...,) float16 array, W m-2 sr-1
        What is beyond the largest half is set to it.
    """
    if radiance.dtype == np.float16:
        return radiance
    return np.minimum(radiance, HALF_MAX).astype(np.float16)


class RadianceStore:
    """A folder of radiance entries.

    Parameters
    ----------
    folder : Path
        Made when first written to.
    limit_bytes : float, optional
        Its disk budget; see ``renders.store.budget.budget_bytes``, whose default it is.
    writers : int, optional
        Entries written side by side; as many as there are cores unless given.
    """

    def __init__(
        self, folder: Path, limit_bytes: float | None = None, writers: int | None = None
    ) -> None:
        self.folder = folder
        self.room = Room(folder, budget_bytes(None) if limit_bytes is None else limit_bytes)
        self.writers = min(writers or len(os.sched_getaffinity(0)), MOST_WRITERS)

    def open_for_writing(self) -> None:
        """Make the folder, and delete what killed processes left half written in it.

        Raises
        ------
        DatasetError
            If it holds what is not ours.
        StorageError
            If it cannot be written: better now than after the first light is traced.
        """
        check_place(self.folder, "--store")
        tag = self.folder / "CACHEDIR.TAG"  # tells backups to pass by; see bford.info/cachedir
        if not tag.is_file():
            names = os.listdir(self.folder) if self.folder.is_dir() else []
            own = [name for name in names if OWN_NAME.fullmatch(name)]
            check_empty(self.folder, "a store of light", own, "--store")
        if not tag.is_file() or not os.access(self.folder, os.W_OK):
            write_text(tag, f"{CACHE_SIGNATURE}\n# What is in here can be rendered again.\n")
        sweep_scratch(self.folder)

    @contextmanager
    def claimed(self, claim: Claim, to_come: frozenset[str] | None = None) -> Iterator[None]:
        """Keep what a run needs from being evicted while it lives, by us and by others.

        Parameters
        ----------
        claim : Claim
        to_come : frozenset of str, optional
            Those of its keys that it will use; all unless given.

        Raises
        ------
        StorageError
            If the store cannot be written.
        """
        wanted = claim.keys if to_come is None else to_come
        for key in wanted | claim.needed:
            mark_used(self.path(key))
        with held(self.folder, claim) as path:
            self.room.claim = path
            self.room.needed, self.room.wanted = claim.needed, wanted
            try:
                yield
            finally:
                self.room.needed = self.room.wanted = self.room.in_hand = frozenset()
                self.room.claim = None

    def path(self, key: str) -> Path:
        """Return where the entry of ``key`` lies, whether it is there or not."""
        return self.folder / key[:2] / f"{key}.exr"

    def has(self, key: str) -> bool:
        """Tell whether an entry is there; ``read`` tells whether it is whole, and still there."""
        return self.path(key).is_file()

    def read(self, key: str) -> Radiance | None:
        """Return an entry as (height, width) float32, W m-2 sr-1, or None if absent or damaged."""
        channels = self.read_channels(key)
        if channels is None or set(channels) != {"Y"}:
            return None
        return np.asarray(channels["Y"], dtype=np.float32)

    def read_channels(self, key: str) -> dict[str, AnyArray] | None:
        """Return an entry's channels as they are, or None if it is absent or damaged.

        Returns
        -------
        dict of str to (height, width) arrays, or None
        """
        channels = read_exr(self.path(key), {KEY: key})
        if channels is not None:
            mark_used(self.path(key))
        return channels

    def write(self, key: str, radiance: Radiance) -> None:
        """Write an entry, rounded to half floats; see ``write_all``.

        Parameters
        ----------
        key : str
        radiance : (height, width) array, W m-2 sr-1
        """
        self.write_all({key: radiance})

    def write_all(self, images: Mapping[str, Radiance]) -> None:
        """Write entries by key, rounded to half floats, and keep the store within its budget.

        Parameters
        ----------
        images : mapping of str to (height, width) arrays, W m-2 sr-1
            By key.

        Raises
        ------
        StorageError
            If the disk is full or read-only, or the budget cannot hold what this run needs.
        """
        with ThreadPoolExecutor(min(self.writers, max(1, len(images)))) as writers:
            list(writers.map(self._write, images.keys(), images.values()))
        self.room.wrote(sum(_size(self.path(key)) for key in images))

    def _write(self, key: str, radiance: Radiance) -> None:
        write_exr(self.path(key), {"Y": as_half(radiance)}, {KEY: key})

    def write_channels(self, key: str, channels: Mapping[str, AnyArray]) -> None:
        """Write an entry of several channels, as they are, and keep the store within its budget.

        Parameters
        ----------
        key : str
        channels : mapping of str to (height, width) float16, float32 or uint32 arrays

        Raises
        ------
        StorageError
            If the disk is full or read-only, or the budget cannot hold what this run needs.
        """
        write_exr(self.path(key), channels, {KEY: key})
        self.room.wrote(_size(self.path(key)))

    def lend(self, key: str, place: Path) -> bool:
        """Put an entry at ``place`` too, as a link where the two share a disk.

        Returns
        -------
        bool
            False if the entry is not there, or goes away meanwhile.

        Raises
        ------
        StorageError
            If the disk is full or read-only.
        """
        if not self.has(key):
            return False
        try:
            link_or_copy(self.path(key), place)
        except StorageError:
            if self.has(key):
                raise
            return False
        return True

    def take(self, key: str, source: Path) -> None:
        """Take in an entry that lies elsewhere under seal, as a link where the two share a disk.

        Raises
        ------
        StorageError
            If the disk is full or read-only.
        """
        link_or_copy(source, self.path(key))
        self.room.wrote(_size(self.path(key)))


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:  # evicted already
        return 0
