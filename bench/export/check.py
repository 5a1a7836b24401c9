"""An export reopened: every file by its hash, and what the format's readers would find in it."""

from __future__ import annotations

from pathlib import Path

from bench.export.folder import all_files, completed, hash_of, listed
from bench.export.formats.catalogue import FORMATS
from bench.export.formats.format import Findings
from bench.progress import frame_progress
from models.errors import DatasetError

MOST_FAULTS = 1000  # more say nothing more


def check_export(out: Path) -> tuple[str, Findings]:
    """Reopen an export.

    Parameters
    ----------
    out : Path

    Returns
    -------
    str, Findings
        The format, and what came of it.

    Raises
    ------
    DatasetError
        If it is no export of ours, or none that is complete.
    """
    kind = FORMATS[completed(out).choice("as", FORMATS)]
    faults: list[str] = []
    names = dict(listed(out))
    with frame_progress("check", len(names)) as advance:
        for name, digest in names.items():
            path = out / name
            if path.is_symlink() or not path.is_file():
                faults.append(f"{name}: expected the file that {out.name} lists, found none")
            elif hash_of(path) != digest:
                faults.append(f"{name}: expected the bytes that were written, got others")
            advance()
    faults += [
        f"{name}: a file that was not exported" for name in all_files(out) if name not in names
    ]
    if faults:  # what is damaged cannot be judged
        return kind.name, Findings(faults=faults[:MOST_FAULTS])
    try:
        found = kind.check(out)
    except (DatasetError, KeyError, TypeError, IndexError, ValueError) as error:
        told = f"no {error.args[0]}" if isinstance(error, KeyError) else str(error)
        found = Findings(faults=[f"expected files of the format {kind.name}, got: {told}"])
    found.faults = found.faults[:MOST_FAULTS]
    return kind.name, found
