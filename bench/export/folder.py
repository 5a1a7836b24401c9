"""The folder of an export: marked as ours from its first moment, and listed to the last byte.

::

    OUT/export.json      what was asked of which datasets; ``complete`` once everything is there
        files.sha256     hash and path of every other file
        .rvbench-export/ label records while it is being made
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from bench.export.plan import Plan
from bench.export.records import HIDDEN
from bench.export.request import ExportRequest
from models.atomic_file import sweep_scratch, whole_or_absent, write_text
from models.dataset.split_file import FILE_NAME as SPLITS
from models.errors import DatasetError, UnreadableError
from models.output_folder import check_empty, check_place
from models.reading.fields import Fields
from models.reading.json_file import read_json_table
from models.reading.regular_file import check_regular
from models.reading.shown import shown

FORMAT, VERSION = "rvbench-export", 1
MARK, HASHES = "export.json", "files.sha256"
BUFFER = 1 << 20
MOST_LINE = 5000  # a hash and the longest path that a system has


def marking(request: ExportRequest, plan: Plan, versions: str) -> dict[str, Any]:
    """Return what marks a folder: the options, and the datasets by their hashes.

    Parameters
    ----------
    request : ExportRequest
    plan : Plan
    versions : str
        Of what makes the export.
    """
    return {
        "format": FORMAT,
        "version": VERSION,
        "as": request.kind,
        "bits": request.bits,
        "tone": request.tone,
        "demosaic": request.demosaic,
        "split": list(request.split),
        "split_seed": request.split_seed,
        "split_block": request.split_block,
        "licence": request.licence,
        "mcap": request.mcap,
        "made_by": versions,
        "datasets": [
            {
                "case": source.dataset.info.case,
                "target": source.dataset.info.target,
                "frames": source.dataset.info.frames,
                "public_half": source.fingerprint,
                "truth": _hash_of(source.truth.path),
                **({} if source.splits is None else {"splits": _hash_of(source.folder / SPLITS)}),
            }
            for source in plan.sources
        ],
    }


def begin(out: Path, mark: dict[str, Any]) -> bool:
    """Mark a folder, unless it is marked by the same export already.

    Parameters
    ----------
    out : Path
        Made if needed.
    mark : dict
        See ``marking``.

    Returns
    -------
    bool
        Whether the export is complete already.

    Raises
    ------
    DatasetError
        If it holds another export, or what is not ours; nothing was changed.
    StorageError
        If it cannot be written.
    """
    check_place(out)
    there = read_mark(out)
    if there is None:
        check_empty(out, "an export that rvbench made")
        write_text(out / MARK, _text({**mark, "complete": False}))
        return False
    complete = bool(there.pop("complete", False))
    differs = [key for key in mark if there.get(key) != mark[key]]
    if differs:
        told = ", ".join(
            f"{key} {shown(there.get(key))} instead of {shown(mark[key])}" for key in differs[:3]
        )
        raise DatasetError(
            f"expected {out} to be empty or to hold this very export, it holds another: {told}; "
            "nothing was changed: choose another --out"
        )
    if not complete:
        _refuse_links(out)
        sweep_scratch(out)
    return complete


def _refuse_links(out: Path) -> None:
    """Refuse to go on where a link would have us write elsewhere; an export has none."""
    for place, folders, names in os.walk(out):
        for name in (*folders, *names):
            path = Path(place, name)
            if path.is_symlink():
                raise DatasetError(
                    f"expected an export without links in {out}, found {path} to "
                    f"{shown(os.readlink(path))}; nothing was changed: choose another --out, or "
                    "take it away"
                )


def read_mark(out: Path) -> dict[str, Any] | None:
    """Return what marks a folder as an export of ours; None if nothing does."""
    if not (out / MARK).is_file():
        return None
    try:
        table = read_json_table(out / MARK)
    except UnreadableError:
        return None
    return table if table.get("format") == FORMAT and table.get("version") == VERSION else None


def finish(out: Path, mark: dict[str, Any], files: Iterable[tuple[str, str]]) -> None:
    """List every file with its hash, say that all is there, and drop what was kept on the way.

    Parameters
    ----------
    out : Path
    mark : dict
        See ``marking``.
    files : iterable of (str, str)
        Path in the export and SHA-256.

    Raises
    ------
    StorageError
        If it cannot be written.
    """
    with whole_or_absent(out / HASHES) as scratch, scratch.open("w") as file:
        for name, digest in files:
            file.write(f"{digest}  {name}\n")
    write_text(out / MARK, _text({**mark, "complete": True}))
    shutil.rmtree(out / HIDDEN, ignore_errors=True)


def write_pieces(path: Path, pieces: Iterable[bytes]) -> tuple[int, str]:
    """Write a file piece by piece, whole or not at all; return its size and SHA-256.

    Raises
    ------
    StorageError
        If it cannot be written.
    """
    digest, size = hashlib.sha256(), 0
    with whole_or_absent(path) as scratch, scratch.open("wb", BUFFER) as file:
        for piece in pieces:
            digest.update(piece)
            size += len(piece)
            file.write(piece)
    return size, digest.hexdigest()


def listed(out: Path) -> Iterator[tuple[str, str]]:
    """Walk the paths and hashes of ``files.sha256``.

    Raises
    ------
    DatasetError
        If it cannot be read, or a path leads out of the export.
    """
    path = out / HASHES
    try:
        check_regular(path)
        with path.open() as file:
            lines = iter(lambda: file.readline(MOST_LINE), "")
            for number, line in enumerate(lines, start=1):
                digest, _, name = line.rstrip("\n").partition("  ")
                inside = name and not Path(name).is_absolute() and ".." not in Path(name).parts
                if len(digest) != 64 or not inside:
                    raise DatasetError(
                        f"{path}:{number}: expected a hash and a path within the export, got "
                        f"{shown(line)}"
                    )
                yield name, digest
    except (OSError, UnicodeDecodeError, UnreadableError) as error:
        raise DatasetError(
            f"expected the hashes of an export at {path}, got: {error}; export again"
        ) from error


def hash_of(path: Path) -> str:
    """Return the SHA-256 of a file, read piece by piece."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while piece := file.read(BUFFER):
            digest.update(piece)
    return digest.hexdigest()


def all_files(out: Path) -> Iterator[str]:
    """Walk the paths of all files of an export, but for the two that tell of it."""
    for place, folders, names in os.walk(out):
        folders[:] = sorted(each for each in folders if each != HIDDEN)
        for name in sorted(names):
            path = str(Path(place, name).relative_to(out))
            if path not in (MARK, HASHES):
                yield path


def completed(out: Path) -> Fields:
    """Return the mark of an export that is complete.

    Raises
    ------
    DatasetError
        If there is none, or it is not complete.
    """
    table = read_mark(out)
    if table is None:
        raise DatasetError(f"expected an export of rvbench in {out}, with an {MARK}; found none")
    if table.get("complete") is not True:
        raise DatasetError(
            f"expected a complete export in {out}, got one that was stopped; run the command that "
            "made it again, it goes on where it stopped"
        )
    return Fields(table, out / MARK)


def _hash_of(path: Path) -> str:
    return hash_of(path) if path.is_file() else ""


def _text(table: dict[str, Any]) -> str:
    return json.dumps(table, indent=2) + "\n"
