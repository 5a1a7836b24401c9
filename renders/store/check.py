"""Every entry of a store read and held against its seal: one flipped byte is found, and named."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from renders.store.budget import Entry, stored
from renders.store.claims import read_claims
from renders.store.radiance_store import KEY
from renders.store.sealed_exr import fault

NAMED = KEY.encode() + b"\0string\0"
ANOTHERS_NAME = "it is whole, but it is the entry of another key"


@dataclass(frozen=True)
class Damage:
    """An entry that is not as it was written.

    Attributes
    ----------
    path : Path
    reason : str
    copies : tuple of Path
        Links to the same bytes in the datasets that the store knows of.
    """

    path: Path
    reason: str
    copies: tuple[Path, ...] = ()

    def delete(self) -> None:
        """Delete it everywhere, so that the next run renders it again."""
        for path in (self.path, *self.copies):
            path.unlink(missing_ok=True)


def damaged(
    folder: Path, entries: list[Entry], done: Callable[[], None] = lambda: None
) -> list[Damage]:
    """Read entries, as many at once as there are cores, and return those that are damaged.

    Parameters
    ----------
    folder : Path
        The store.
    entries : list of Entry
    done : callable
        Called after each.

    Raises
    ------
    OSError
        If the disk fails to read one; an entry that is evicted meanwhile is passed over.
    """
    found = []
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as readers:
        for entry, reason in zip(entries, readers.map(what_is_wrong, entries), strict=True):
            done()
            if reason is not None:
                found.append(Damage(entry.path, reason, tuple(_copies(folder, entry.path))))
    return found


def what_is_wrong(entry: Entry) -> str | None:
    """Read one entry; return what is wrong with it, or None if it is whole or gone."""
    try:
        data = entry.path.read_bytes()
    except FileNotFoundError:
        return None
    reason = fault(data)
    named = data.find(NAMED)
    if reason is None and data[named + len(NAMED) + 4 :][:64] != entry.key.encode():
        return ANOTHERS_NAME
    return reason


def _copies(folder: Path, path: Path) -> Iterator[Path]:
    try:
        if path.stat().st_nlink == 1:
            return
    except FileNotFoundError:
        return
    for claim in read_claims(folder):
        for copy in sorted((claim.dataset / "truth" / "geometry").glob("*.exr")):
            if copy.samefile(path):
                yield copy


def all_entries(folder: Path) -> list[Entry]:
    """Return the entries of a store, in order of their keys."""
    return sorted(stored(folder), key=lambda entry: entry.key)
