"""What a submitter writes down before it submits, so that the next one finds its jobs again.

::

    OUT/runner/job.json       what was submitted, and how often each chunk
               job.sh         what SLURM runs for each chunk
               NAME.token     seen by a job, it tells that its folder is ours
               NAME.cancelled tells that nobody wants the job any more
               submitter      locked by who waits for the job
               started/K      NAME and the node of the job that began chunk K last
               logs/K.log     what that job said
"""

from __future__ import annotations

import json
import secrets
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from bench.runners.shared_work import SharedWork
from models.atomic_file import write_text
from models.errors import DatasetError, UnreadableError
from models.reading.json_file import read_json_table

FORMAT, VERSION = "rvbench-job", 1


@dataclass(frozen=True)
class JobRecord:
    """A job that was submitted, or is about to be.

    Attributes
    ----------
    name : str
        By which the queue knows it; drawn, so nobody else's job has it.
    runner : str
        slurm or dask.
    command : tuple of str
    chunks : int
    tries : dict of int to int
        How often each chunk was submitted.
    ids : tuple of str
        Of arrays that were submitted under the name, as the queue numbers them.
    """

    name: str
    runner: str
    command: tuple[str, ...]
    chunks: int
    tries: dict[int, int] = field(default_factory=dict)
    ids: tuple[str, ...] = ()

    def tried(self, numbers: list[int]) -> JobRecord:
        """Return it with some chunks submitted once more."""
        return replace(self, tries=dict(Counter(self.tries) + Counter(numbers)))


def new_record(runner: str, work: SharedWork) -> JobRecord:
    """Return a record of what was not submitted yet."""
    return JobRecord(f"rvbench-{secrets.token_hex(6)}", runner, work.arguments, work.chunks)


def write_record(place: Path, record: JobRecord) -> None:
    """Write it, and its token.

    Raises
    ------
    StorageError
    """
    write_text(token_path(place, record.name), record.name + "\n")
    table = {
        "format": FORMAT,
        "version": VERSION,
        "name": record.name,
        "runner": record.runner,
        "command": list(record.command),
        "chunks": record.chunks,
        "tries": {str(number): count for number, count in sorted(record.tries.items())},
        "ids": list(record.ids),
    }
    write_text(place / "job.json", json.dumps(table, indent=1) + "\n")


def read_record(place: Path) -> JobRecord | None:
    """Return what was submitted last; None if nothing was.

    Raises
    ------
    DatasetError
        If the file is none of ours.
    """
    path = place / "job.json"
    if not path.is_file():
        return None
    try:
        return _record(read_json_table(path))
    except (UnreadableError, KeyError, TypeError, ValueError, AttributeError) as error:
        raise DatasetError(
            f"{path}: expected the job that was submitted last, got {error}; delete the file if "
            "no job of yours is at work in that folder"
        ) from error


def _record(table: dict[str, Any]) -> JobRecord:
    if table["format"] != FORMAT or table["version"] != VERSION:
        raise ValueError(f"format {table['format']!r}, version {table['version']!r}")
    name = str(table["name"])
    if not name.replace("-", "").isalnum():  # it goes into commands
        raise ValueError(f"the name {name!r}")
    return JobRecord(
        name,
        str(table["runner"]),
        tuple(map(str, table["command"])),
        int(table["chunks"]),
        {int(number): int(count) for number, count in table["tries"].items()},
        tuple(map(str, table["ids"])),
    )


def token_path(place: Path, name: str) -> Path:
    """Return the file by which a job knows that it sees our folder."""
    return place / f"{name}.token"


def cancelled_path(place: Path, name: str) -> Path:
    """Return the file that tells whoever does or awaits a job that it was cancelled."""
    return place / f"{name}.cancelled"


def log_path(place: Path, number: int) -> Path:
    """Return where the jobs of a chunk say what they do."""
    return place / "logs" / f"{number}.log"


def started(place: Path, record: JobRecord) -> set[int]:
    """Return the chunks of which we see that a job of this record began them."""
    found = set()
    for path in (place / "started").glob("*"):
        try:
            if path.name.isdecimal() and path.read_text().split()[:1] == [record.name]:
                found.add(int(path.name))
        except (OSError, UnicodeDecodeError):
            continue
    return found
