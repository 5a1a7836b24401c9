"""A store within its budget: what was used longest ago goes first.

The last use of an entry is its file's time of modification: set by whoever reads it, and by no
backup or file system. What a dataset holds as a link costs the store nothing, and stays. What a
live run must have stays too; what one would merely trace again goes last.
"""

from __future__ import annotations

import os
import re
from collections.abc import Container, Iterator
from dataclasses import dataclass
from pathlib import Path

from models.errors import ScenarioError, StorageError
from renders.store.claims import live_claims

GB = 1e9
DEFAULT_BUDGET_GB = 20.0  # about 900 exposures of eight groups at 2048 x 2048
VARIABLE = "RVBENCH_STORE_BUDGET_GB"
LOW_WATER = 0.9  # of the budget: what is deleted at once lasts for a while
CERTAIN_EXCESS = 1.5  # a first frame tells the size of all to better than this
ENTRY_NAME = re.compile(r"(?P<key>[0-9a-f]{64})\.exr")


@dataclass(frozen=True)
class Entry:
    """One file of a store.

    Attributes
    ----------
    key : str
    path : Path
    size_bytes : int
    used_ns : int
        When it was last used, ns since 1970.
    is_linked : bool
        A dataset holds it, too.
    """

    key: str
    path: Path
    size_bytes: int
    used_ns: int
    is_linked: bool

    @property
    def cost_bytes(self) -> int:
        """What deleting it would free: nothing where a dataset holds it as a link."""
        return 0 if self.is_linked else self.size_bytes


def budget_bytes(typed_gb: float | None) -> float:
    """Return the budget typed, else that of ``$RVBENCH_STORE_BUDGET_GB``, else 20 GB; in bytes.

    Raises
    ------
    ScenarioError
        If it is no positive number; ``inf`` is one.
    """
    name, text = "--store-budget-gb", str(typed_gb)
    if typed_gb is None:
        name, text = f"${VARIABLE}", os.environ.get(VARIABLE) or str(DEFAULT_BUDGET_GB)
    try:
        budget_gb = float(text)
    except ValueError:
        budget_gb = 0.0
    if not budget_gb > 0.0:
        raise ScenarioError(
            f"expected {name} to be a number of gigabytes above 0, or inf, got {text!r}"
        )
    return budget_gb * GB


def stored(folder: Path) -> Iterator[Entry]:
    """Yield every entry of a store; what goes away meanwhile is passed over."""
    for place in _scan(folder):
        if len(place.name) != 2 or not place.is_dir():
            continue
        for file in _scan(Path(place.path)):
            named = ENTRY_NAME.fullmatch(file.name)
            try:
                status = file.stat() if named and file.is_file() else None
            except OSError:
                continue
            if named is not None and status is not None:
                size, used, linked = status.st_size, status.st_mtime_ns, status.st_nlink > 1
                yield Entry(named["key"], Path(file.path), size, used, linked)


def _scan(folder: Path) -> list[os.DirEntry[str]]:
    try:
        with os.scandir(folder) as found:
            return list(found)
    except OSError:
        return []


def mark_used(path: Path) -> None:
    """Note that an entry is used now; who may not write the store leaves no note."""
    try:
        if path.stat().st_nlink == 1:  # a link shows its time in a dataset, too
            os.utime(path)
    except OSError:
        return


def evict(
    folder: Path,
    down_to_bytes: float,
    needed: Container[str],
    wanted: Container[str],
    refused: list[OSError] | None = None,
) -> tuple[int, int]:
    """Delete entries, those used longest ago first, until a store is small enough.

    Parameters
    ----------
    folder : Path
    down_to_bytes : float
    needed : container of str
        Keys of what stays.
    wanted : container of str
        Keys of what goes after everything else.
    refused : list of OSError, optional
        Takes what the system said where it did not let us delete.

    Returns
    -------
    (int, int)
        Bytes that are left, and how many entries were deleted.
    """
    found = list(stored(folder))
    left, deleted = sum(entry.cost_bytes for entry in found), 0
    spare = (entry for entry in found if entry.cost_bytes and entry.key not in needed)
    for entry in sorted(spare, key=lambda entry: (entry.key in wanted, entry.used_ns)):
        if left <= down_to_bytes:
            break
        try:
            gone = _deleted(entry)
        except OSError as error:
            gone = False
            if refused is not None:
                refused.append(error)
        if gone:
            left, deleted = left - entry.cost_bytes, deleted + 1
    return left, deleted


def _deleted(entry: Entry) -> bool:
    """Delete an entry unless somebody has used it meanwhile; tell whether it is gone."""
    try:
        if entry.path.stat().st_mtime_ns != entry.used_ns:
            return False
        entry.path.unlink()
    except FileNotFoundError:
        return True
    return True


class Room:
    """The room that one process has for writing to a store.

    The store is counted anew whenever what this process has written since could, with as much
    again from each of three others, have filled it.

    Parameters
    ----------
    folder : Path
    limit_bytes : float
    """

    def __init__(self, folder: Path, limit_bytes: float) -> None:
        self.folder = folder
        self.limit_bytes = limit_bytes
        self.claim: Path | None = None
        self.needed: frozenset[str] = frozenset()
        self.wanted: frozenset[str] = frozenset()
        self.in_hand: frozenset[str] = frozenset()
        self._unknown = True
        self._free_bytes = 0.0
        self._written_bytes = 0

    def take_in_hand(self, keys: frozenset[str]) -> None:
        """Protect what is worked on; what was in hand before is wanted no longer."""
        self.wanted -= self.in_hand - keys
        self.in_hand = keys

    def wrote(self, size_bytes: int) -> None:
        """Make room again after a write.

        Raises
        ------
        StorageError
            If the budget cannot hold what this run needs to the end.
        """
        self._written_bytes += size_bytes
        if not self._unknown and 4 * self._written_bytes <= self._free_bytes:
            return
        others = live_claims(self.folder, besides=self.claim)
        needed = self.needed.union(self.in_hand, *(claim.needed for claim in others))
        wanted = self.wanted.union(*(claim.wanted for claim in others))
        sizes = {entry.key: entry.cost_bytes for entry in stored(self.folder)}
        total = sum(sizes.values())
        self._check_needed([sizes[key] for key in self.needed if key in sizes])
        if total > self.limit_bytes:
            total, _ = evict(self.folder, LOW_WATER * self.limit_bytes, needed, wanted)
        self._free_bytes, self._written_bytes = self.limit_bytes - total, 0
        self._unknown = False

    def _check_needed(self, sizes: list[int]) -> None:
        """Refuse to go on where what this run needs, by what is there of it, will never fit."""
        if not sizes:
            return
        expected = sum(sizes) / len(sizes) * len(self.needed)
        if sum(sizes) > self.limit_bytes or expected > CERTAIN_EXCESS * self.limit_bytes:
            raise StorageError(
                f"expected the light of all frames to fit in the store's budget of "
                f"{self.limit_bytes / GB:g} GB, since --seeds exposes every frame again; it will "
                f"take about {expected / GB:.2g} GB. Give --store-budget-gb "
                f"{1.2 * expected / GB:.2g}, fewer frames, or --seeds 1; what is there is kept"
            )
