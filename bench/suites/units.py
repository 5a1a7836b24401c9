"""Units of work, and what each came to, kept in a file of its own.

What a unit comes to depends on its task alone, so neither the number of workers nor the order
changes a bit of it; how long it took stands in another file beside. A unit is done if its file
carries the hash of everything that shapes it: the task, the code and the libraries.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache, cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from bench.suites.code_fingerprint import code_fingerprint
from models.arrays import AnyArray, Floats
from models.atomic_file import write_bytes, write_text
from models.errors import DatasetError, UnreadableError
from models.reading.json_file import read_json
from models.reading.npz_file import read_npz
from models.reading.regular_file import MEGABYTE

KEY = "key"
LIBRARIES = ("numpy", "scipy", "opencv-contrib-python-headless")
MOST_OUTCOME_BYTES = 2000 * MEGABYTE


@dataclass(frozen=True, eq=False)
class Outcome:
    """What a unit came to.

    Attributes
    ----------
    values : dict of arrays
        The same bits on every run of the unit.
    seconds : (n,) array, s
        How long its pieces took; these are never the same.
    """

    values: dict[str, AnyArray]
    seconds: Floats


@dataclass(frozen=True)
class WorkUnit:
    """A piece of a suite that one process does by itself.

    Attributes
    ----------
    name : str
        Its file's path below the folder of units, without suffix.
    work : callable
        A function of a module: from the task to its outcome.
    task : dataclass
        Plain numbers, texts and tuples of them, nested as one likes: it must hold all that shapes
        the outcome but the code.
    kind : str
        Units of one kind take about as long.
    expected_s : float, s
        How long it is thought to take, before one of its kind was done.
    modules : tuple of str
        Modules that the work imports by a name it is told; their code counts too.
    reads : str
        A folder that the work reads, handed to it beside the task, which must hold a hash of what
        lies there: where it lies shapes nothing.
    """

    name: str
    work: Callable[..., Outcome]
    task: Any
    kind: str
    expected_s: float
    modules: tuple[str, ...] = ()
    reads: str = ""

    def done(self) -> Outcome:
        """Do the work, and return what it comes to."""
        return self.work(self.task, self.reads) if self.reads else self.work(self.task)

    @cached_property
    def key(self) -> str:
        """Hash of all that shapes the outcome.

        Raises
        ------
        TypeError
            If the task holds something whose text does not tell it whole.
        """
        shaped = {
            "task": asdict(self.task),
            "work": f"{self.work.__module__}.{self.work.__qualname__}",
            "code": code_fingerprint(self.work.__module__, *self.modules),
            "libraries": _library_versions(),
        }
        return hashlib.sha256(json.dumps(shaped, sort_keys=True).encode()).hexdigest()


@cache
def _library_versions() -> dict[str, str]:
    return {name: version(name) for name in LIBRARIES}


def outcome_path(folder: Path, unit: WorkUnit) -> Path:
    """Return where a unit's values are kept."""
    return folder / f"{unit.name}.npz"


def seconds_path(folder: Path, unit: WorkUnit) -> Path:
    """Return where a unit's times are kept."""
    return folder / f"{unit.name}.seconds.json"


def write_outcome(folder: Path, unit: WorkUnit, outcome: Outcome) -> None:
    """Keep what a unit came to; its values are written last, and whole or not at all.

    Parameters
    ----------
    folder : Path
    unit : WorkUnit
    outcome : Outcome

    Raises
    ------
    StorageError
        If the disk is full or read-only.
    """
    stream = io.BytesIO()
    arrays: dict[str, Any] = {**outcome.values, KEY: np.array(unit.key)}
    np.savez_compressed(stream, **arrays)
    write_text(seconds_path(folder, unit), json.dumps([round(s, 6) for s in outcome.seconds]))
    write_bytes(outcome_path(folder, unit), stream.getvalue())


def is_done(folder: Path, unit: WorkUnit) -> bool:
    """Tell whether a unit's outcome is there, whole, and of this task and code."""
    return read_outcome(folder, unit) is not None


def read_outcome(folder: Path, unit: WorkUnit) -> Outcome | None:
    """Return what a unit came to; None if it is not done, or was of another task or code."""
    key = unit.key  # now: what a process is handed later is the unit of this code
    try:
        values = read_npz(outcome_path(folder, unit), MOST_OUTCOME_BYTES)
        if str(values.pop(KEY, None)) != key:
            return None
        seconds = np.array(read_json(seconds_path(folder, unit)), dtype=np.float64)
    except (UnreadableError, ValueError, TypeError):
        return None
    return Outcome(values, seconds)


def done_outcome(folder: Path, unit: WorkUnit) -> Outcome:
    """Return what a unit came to.

    Raises
    ------
    DatasetError
        If it is not done.
    """
    outcome = read_outcome(folder, unit)
    if outcome is None:
        raise DatasetError(
            f"{outcome_path(folder, unit)}: expected the outcome of {unit.name} as today's code "
            "makes it, got none; run the same suite again: only what is missing is done"
        )
    return outcome
