"""A folder that is written into is new, empty or ours: what is somebody else's is never touched."""

from __future__ import annotations

import errno
import os
from collections.abc import Collection
from pathlib import Path

from models.atomic_file import SCRATCH_NAME, forget_disk
from models.errors import DatasetError, StorageError, cause
from models.folder_kinds import kind_of

MOST_NAMED = 6


def check_place(folder: Path, option: str = "--out") -> None:
    """Refuse a place where no folder can be, or none that we may write; a verb begins there.

    Parameters
    ----------
    folder : Path
        It need not be there.
    option : str
        What the message asks to change.

    Raises
    ------
    DatasetError, StorageError
        Nothing was changed.
    """
    forget_disk(folder)
    place = folder
    while not os.path.lexists(place) and place.parent != place:
        place = place.parent
    if place.is_symlink() and not place.exists():
        raise DatasetError(
            f"expected a folder at {place}, found a link to {os.readlink(place)}, which is not "
            f"there; choose another {option}"
        )
    if not place.is_dir():
        raise DatasetError(f"expected a folder at {place}, found a file; choose another {option}")
    if not os.access(place, os.W_OK | os.X_OK):
        read_only = os.statvfs(place).f_flag & os.ST_RDONLY
        raise StorageError(
            f"expected to write into {folder}, got: "
            f"{os.strerror(errno.EROFS if read_only else errno.EACCES)}; choose another {option}"
        )


def check_empty(folder: Path, meant: str, own: Collection[str] = (), option: str = "--out") -> None:
    """Refuse a folder that holds anything; for one that carries no mark of ours.

    Parameters
    ----------
    folder : Path
        It need not be there.
    meant : str
        What of ours it might hold, for the message.
    own : collection of str
        Names in it that are known to be ours.
    option : str
        What the message asks to change.

    Raises
    ------
    DatasetError
        The message names what was found; nothing was changed.
    """
    found = [name for name in foreign_names(folder) if name.rstrip("/") not in own]
    if not found:
        return
    if (kind := kind_of(folder)) is not None:
        raise DatasetError(
            f"expected {folder} to be empty or to hold {meant}; it holds another kind of folder of "
            f"rvbench's, a {kind}; nothing was changed: choose another {option}"
        )
    more = f" and {len(found) - MOST_NAMED} more" if len(found) > MOST_NAMED else ""
    raise DatasetError(
        f"expected {folder} to be empty or to hold {meant}; it holds what rvbench did not make: "
        f"{', '.join(found[:MOST_NAMED])}{more}; nothing was changed: choose another {option}, "
        "or move these away"
    )


def foreign_names(folder: Path) -> list[str]:
    """Return what lies in a folder, sorted; folders end in a slash.

    What a killed process of ours left half written does not count, nor does a folder that holds
    nothing else: a run may be killed before it has written the file that marks its folder.

    Raises
    ------
    DatasetError
        If it cannot be looked into.
    """
    try:
        with os.scandir(folder) as entries:
            found = [(entry.name, entry.is_dir(), entry.is_symlink()) for entry in entries]
    except FileNotFoundError:
        return []
    except OSError as error:
        raise DatasetError(
            f"expected a folder at {folder} to look into, got: {cause(error)}"
        ) from error
    return sorted(
        f"{name}/" if is_folder else name
        for name, is_folder, is_link in found
        if not SCRATCH_NAME.fullmatch(name)
        and (is_link or not is_folder or _holds_a_file(folder / name))
    )


def _holds_a_file(folder: Path) -> bool:
    return any(
        not SCRATCH_NAME.fullmatch(name)
        for place, folders, names in os.walk(folder)
        for name in (*names, *(each for each in folders if Path(place, each).is_symlink()))
    )
