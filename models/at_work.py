"""Who is at work in a folder of ours, and what the last who failed there ended with.

Whoever writes into a folder holds a shared lock on the folder itself, so that no file tells of it;
the system lets go of the lock when the process ends, however it ends. A verb that fails once it has
begun leaves its message in the folder until the next one begins.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from models.atomic_file import write_text
from models.errors import RvbenchError, StorageError
from models.reading.json_file import read_json_table

FAILED_NAME = ".rvbench-failed.json"
MOST_MESSAGE = 4000


@contextmanager
def at_work(folder: Path, verb: str) -> Iterator[None]:
    """Be seen at work in a folder that is there and ours.

    Parameters
    ----------
    folder : Path
    verb : str
        For who asks what failed.
    """
    failed = folder / FAILED_NAME
    with suppress(OSError):
        failed.unlink(missing_ok=True)
    place = _opened(folder)
    try:
        yield
    except Exception as error:
        table = {"verb": verb, "message": _message(error)[:MOST_MESSAGE]}
        with suppress(StorageError, OSError):  # a full disk is what it may have failed for
            write_text(failed, json.dumps(table) + "\n")
        raise
    finally:
        if place is not None:
            os.close(place)


def is_at_work(folder: Path) -> bool | None:
    """Tell whether anybody is at work in a folder; None where its disk knows no locks."""
    try:
        place = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    except OSError:
        return False
    try:
        fcntl.flock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return None
    finally:
        os.close(place)
    return False


def last_failure(folder: Path) -> dict[str, str] | None:
    """Return the verb and the message of who failed last in a folder; None if nobody did."""
    try:
        table: dict[str, Any] = read_json_table(folder / FAILED_NAME)
        return {"what": str(table["verb"]), "why": str(table["message"])}
    except (RvbenchError, KeyError):
        return None


def _opened(folder: Path) -> int | None:
    """Lock a folder for as long as it is open; None where it cannot be."""
    try:
        place = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    except OSError:
        return None
    with suppress(OSError):
        fcntl.flock(place, fcntl.LOCK_SH)
    return place


def _message(error: Exception) -> str:
    return str(error) if isinstance(error, RvbenchError) else f"{type(error).__name__}: {error}"
