"""Files that are whole or not there: written beside, flushed, then renamed into place.

What is being written lies beside its place as ``.NAME.MACHINE-PROCESS.part``. A killed process
leaves such a file behind; ``sweep_scratch`` takes away those whose writer is no more.
"""

from __future__ import annotations

import errno
import hashlib
import os
import platform
import re
import shutil
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from glob import escape
from pathlib import Path

from models.errors import StorageError, cause

A_DAY_S = 86_400.0  # no file takes so long to write


def _process_numbers() -> str:
    """Return what tells apart who counts processes: a machine, or a container on it."""
    try:
        return f"{platform.node()} {os.readlink('/proc/self/ns/pid')}"
    except OSError:  # no Linux
        return platform.node()


MACHINE = hashlib.sha256(_process_numbers().encode()).hexdigest()[:8]
SCRATCH_NAME = re.compile(r"\..+\.(?P<machine>[0-9a-f]{8})-(?P<process>\d+)\.part")
_BEGAN_S = time.time()
_IN_HAND: set[Path] = set()  # scratch files of this process
_DISKS: dict[Path, int] = {}  # of folders that this process has written into


@contextmanager
def whole_or_absent(path: Path, size_bytes: int | None = None) -> Iterator[Path]:
    """Give a scratch path to write to; at the end it takes the place of ``path``.

    Parameters
    ----------
    path : Path
        Its folder is made if needed.
    size_bytes : int, optional
        For the message, where known.

    Raises
    ------
    StorageError
        If the disk is full, read-only or gone; what stood at ``path`` before still does.
    """
    scratch = path.with_name(f".{path.name}.{MACHINE}-{os.getpid()}.part")
    try:
        _refuse_another_disk(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        _DISKS.setdefault(path.parent, _disk_of(path.parent))
        _IN_HAND.add(scratch)
        try:
            yield scratch
            with scratch.open("rb") as file:
                os.fsync(file.fileno())
            scratch.replace(path)
        finally:
            scratch.unlink(missing_ok=True)
            _IN_HAND.discard(scratch)
    except OSError as error:
        size = "" if size_bytes is None else f" ({size_bytes} bytes)"
        raise StorageError(
            f"expected to write {path}{size}, got: {cause(error)}; {_mend(path, error)}; "
            "everything written so far is whole, and the same command goes on from there"
        ) from error


def forget_disk(folder: Path) -> None:
    """Let a folder and those below it be on another disk than before: a verb begins in it."""
    for known in [each for each in _DISKS if each == folder or folder in each.parents]:
        _DISKS.pop(known, None)


def known_disks() -> dict[Path, int]:
    """Return the disks that folders were on, for a process that goes on with the work."""
    return dict(_DISKS)


def remember_disks(known: Mapping[Path, int]) -> None:
    """Take over what another process knows of the disks that folders were on."""
    _DISKS.update(known)


def _refuse_another_disk(path: Path) -> None:
    """Refuse to write where the disk of before is gone, as beneath the place of its mount."""
    known = next((each for each in path.parents if each in _DISKS), None)
    if known is not None and _disk_of(known) != _DISKS[known]:
        raise StorageError(
            f"expected to write {path}, got: {known} is no longer on the disk that it was on when "
            "this began; mount it again: everything written so far is whole, and the same command "
            "goes on from there"
        )


def _disk_of(folder: Path) -> int:
    """Return the number of the disk that a folder is on, or would be."""
    for place in (folder, *folder.parents):
        with suppress(FileNotFoundError, NotADirectoryError):
            return os.stat(place).st_dev
    return os.stat(os.curdir).st_dev


def _mend(path: Path, error: OSError) -> str:
    """Return what helps: room helps a full disk, and no other."""
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        return "free some space or choose another folder"
    if path.is_dir():
        return f"there is a folder where the file {path.name} should be: move it away or delete it"
    return "choose a folder you can write"


def write_bytes(path: Path, data: bytes) -> None:
    """Write ``data`` to ``path`` atomically, making its folder if needed.

    Raises
    ------
    StorageError
        If the disk is full or read-only; what stood at ``path`` before still does.
    """
    with whole_or_absent(path, len(data)) as scratch:
        scratch.write_bytes(data)


def write_text(path: Path, text: str) -> None:
    """Write UTF-8 text atomically; see ``write_bytes``."""
    write_bytes(path, text.encode())


def link_or_copy(source: Path, place: Path) -> None:
    """Put ``source`` at ``place`` too, atomically, without spending disk where the two share one.

    Raises
    ------
    StorageError
        If ``source`` is gone, or the disk is full or read-only.
    """
    with whole_or_absent(place) as scratch:
        scratch.unlink(missing_ok=True)
        try:
            os.link(source, scratch)
        except OSError:
            shutil.copyfile(source, scratch)


def drop_scratch() -> None:
    """Delete what this process is writing; for one that is about to end, with no time to finish."""
    for scratch in list(_IN_HAND):
        with suppress(OSError):
            scratch.unlink()


def sweep_scratch(folder: Path) -> int:
    """Delete what killed processes left half written in a folder and in those below it.

    What a living process of this machine writes is left alone; so is what another machine's
    process writes to a shared folder, for a day.

    Returns
    -------
    int
        How many files were deleted.
    """
    swept = 0
    for place, _, names in os.walk(folder):
        for name in names:
            scratch = Path(place, name)
            try:
                if _is_abandoned(scratch):
                    scratch.unlink()
                    swept += 1
            except OSError:  # another process was quicker, or nothing can be deleted here
                continue
    return swept


def sweep_beside(path: Path) -> None:
    """Delete what killed processes left half written of one file, which is to be written anew.

    For a file that is written into a folder which nobody sweeps first, such as a report's.
    """
    for scratch in path.parent.glob(f".{escape(path.name)}.*.part"):
        with suppress(OSError):
            if _is_abandoned(scratch):
                scratch.unlink()


def _is_abandoned(scratch: Path) -> bool:
    named = SCRATCH_NAME.fullmatch(scratch.name)
    if named is None:
        return False
    written_s = scratch.stat().st_ctime  # a link to an old file is a new scratch file
    if time.time() - written_s > A_DAY_S:
        return True
    if named["machine"] != MACHINE:
        return False
    process = int(named["process"])
    if process == os.getpid():
        # An earlier process had our number; or ours is in hand, and the clock was set back since.
        return written_s < _BEGAN_S and scratch not in _IN_HAND
    return not _is_alive(process)


def _is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        return True
    return True
