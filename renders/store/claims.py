"""Who uses what light of a store: so that no run loses what it needs, and for the store's list.

A run leaves ``claims/NAME.json`` in the store, one for each dataset, and holds a shared lock on it
for as long as it lives. The system lets go of the lock when the process ends, however it ends; a
claim without a lock is only a record of which light was whose.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from models.atomic_file import write_text
from models.errors import UnreadableError
from models.reading.json_file import read_json_table
from models.reading.regular_file import MEGABYTE, check_regular

FOLDER = "claims"
MOST_CLAIM_BYTES = 2000 * MEGABYTE  # 64 digits a key, a million exposures, some keys each
AN_HOUR_S = 3600.0  # where a disk knows no locks, a claim is believed for so long


@dataclass(frozen=True)
class Claim:
    """The light of one dataset.

    Attributes
    ----------
    case, sun : str
    dataset : Path
        Its folder.
    needed : frozenset of str
        Keys of what must stay until the run ends.
    wanted : frozenset of str
        Keys of all else that shapes the dataset: another tracing brings it back.
    """

    case: str
    sun: str
    dataset: Path
    needed: frozenset[str] = field(default=frozenset(), repr=False)
    wanted: frozenset[str] = field(default=frozenset(), repr=False)

    @property
    def keys(self) -> frozenset[str]:
        """All of them."""
        return self.needed | self.wanted

    def path(self, store: Path) -> Path:
        """Return where the claim lies in a store."""
        name = hashlib.sha256(str(self.dataset.resolve()).encode()).hexdigest()[:16]
        return store / FOLDER / f"{name}.json"

    def to_text(self) -> str:
        """Return the text of its file."""
        table = {
            "case": self.case,
            "sun": self.sun,
            "dataset": str(self.dataset.resolve()),
            "needed": sorted(self.needed),
            "wanted": sorted(self.wanted),
        }
        return json.dumps(table, indent=0) + "\n"


@contextmanager
def held(store: Path, claim: Claim) -> Iterator[Path]:
    """Write a claim and hold it.

    Raises
    ------
    StorageError
        If the store cannot be written.
    """
    path = claim.path(store)
    write_text(path, claim.to_text())
    with path.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH)
        except OSError:  # a disk without locks: the claim's age must do
            os.utime(path)
        yield path


def read_claim(path: Path) -> Claim | None:
    """Read a claim, or None if it is gone or not one."""
    try:
        table = read_json_table(path, MOST_CLAIM_BYTES)
        return Claim(
            case=str(table["case"]),
            sun=str(table["sun"]),
            dataset=Path(table["dataset"]),
            needed=frozenset(table["needed"]),
            wanted=frozenset(table["wanted"]),
        )
    except (UnreadableError, ValueError, KeyError, TypeError):
        return None


def read_claims(store: Path) -> list[Claim]:
    """Return every claim on a store, of runs that live and of those that are over."""
    found = (read_claim(path) for path in sorted((store / FOLDER).glob("*.json")))
    return [claim for claim in found if claim is not None]


def live_claims(store: Path, besides: Path | None = None) -> list[Claim]:
    """Return the claims of runs in progress; ``besides`` is the path of one to pass over."""
    paths = (path for path in sorted((store / FOLDER).glob("*.json")) if path != besides)
    found = (read_claim(path) for path in paths if _is_held(path))
    return [claim for claim in found if claim is not None]


def forget_claims_without_light(store: Path, keys: frozenset[str]) -> None:
    """Delete the claims of runs that are over and of whose light nothing is among ``keys``."""
    for path in sorted((store / FOLDER).glob("*.json")):
        claim = read_claim(path)
        if claim is not None and not claim.keys & keys and not _is_held(path):
            with suppress(OSError):  # a store that cannot be written keeps its records
                path.unlink()


def _is_held(path: Path) -> bool:
    try:
        check_regular(path)  # to open a pipe is to wait
        with _opened(path) as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (FileNotFoundError, UnreadableError):
        return False
    except BlockingIOError:
        return True
    except OSError:
        return time.time() - path.stat().st_mtime < AN_HOUR_S
    return False


def _opened(path: Path) -> BinaryIO:
    """Open a claim for writing if it may be: NFS locks nothing else for one alone."""
    try:
        return path.open("r+b")
    except OSError:  # not ours to write, or a disk that is only read
        return path.open("rb")
