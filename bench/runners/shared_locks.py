"""Whether the locks of a folder hold between machines, as far as its mount tells.

The store of light is locked while it is read, written and made room in (``flock``). NFS passes such
locks on to its server, Lustre to its lock servers, unless the mount says not to: then two machines
would each believe that they hold a lock, and one could delete what the other is about to use.
"""

from __future__ import annotations

from pathlib import Path

from models.errors import StorageError
from renders.store.radiance_store import default_store

MOUNTS = Path("/proc/self/mounts")
KEPT_HERE = {
    "nfs": ("nolock", "local_lock=flock", "local_lock=all"),
    "nfs4": ("nolock", "local_lock=flock", "local_lock=all"),
    "cifs": ("nobrl", "nolock"),
    "lustre": ("localflock", "noflock"),
    "9p": ("",),  # knows no locks between machines
}
NEEDED = {"lustre": "flock"}  # it knows none unless told to


def check_locks(store: Path | None, mounts: Path = MOUNTS) -> None:
    """Refuse a store whose locks do not hold between machines.

    Parameters
    ----------
    store : Path or None
        The house's cache unless given.
    mounts : Path
        As Linux lists them; elsewhere nothing can be told.

    Raises
    ------
    StorageError
        The message names the mount and what to do.
    """
    folder = (store or default_store()).absolute()
    found = mount_of(folder, mounts)
    if found is None:
        return
    place, kind, options = found
    broken = [each for each in KEPT_HERE.get(kind, ()) if each == "" or each in options]
    lacking = kind in NEEDED and NEEDED[kind] not in options
    if broken or lacking:
        why = f"the option {broken[0]}" if broken and broken[0] else "no locks between machines"
        raise StorageError(
            f"expected locks in the store {folder} to hold between machines, {place} is mounted as "
            f"{kind} with {why}; choose a --store on each machine's own disk, or have it mounted "
            "with locks"
        )


def mount_of(folder: Path, mounts: Path = MOUNTS) -> tuple[str, str, tuple[str, ...]] | None:
    """Return where the file system of a folder is mounted, its kind and its options.

    None where it cannot be told.
    """
    try:
        lines = mounts.read_text(errors="replace").splitlines()
    except OSError:
        return None
    best: tuple[str, str, tuple[str, ...]] | None = None
    for line in lines:
        fields = line.split()
        if len(fields) < 4:
            continue
        place = fields[1].replace("\\040", " ")
        if folder.is_relative_to(place) and (best is None or len(place) >= len(best[0])):
            best = (place, fields[2], tuple(fields[3].split(",")))
    return best
