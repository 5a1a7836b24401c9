"""Which file of a kind is spoilt, and how: all of it drawn by one seed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from numpy.random import Generator

from bench.campaign.hostile.kind import Kind
from bench.campaign.hostile.spoilt_bytes import BYTE_SPOILS
from bench.campaign.hostile.spoilt_place import NEVER_RIGHT, PLACE_SPOILS
from bench.campaign.hostile.spoilt_text import TEXT_SPOILS

PLACE_SHARE, BYTE_SHARE = 0.12, 0.2  # of a text; of other files all but the first
IS_TEXT = 2000  # bytes that tell


@dataclass(frozen=True)
class Spoilt:
    """What was done to a file.

    Attributes
    ----------
    path : Path
    how : str
    never_right : bool
        Whether no reader can make anything of it.
    """

    path: Path
    how: str
    never_right: bool


def spoil(random: Generator, kind: Kind, folder: Path) -> Spoilt:
    """Spoil one file of a kind's ground.

    Parameters
    ----------
    random : Generator
    kind : Kind
    folder : Path
        The copy of its ground.
    """
    found = sorted({path for name in kind.files for path in folder.glob(name) if path.is_file()})
    path = found[int(random.integers(len(found)))]
    data = path.read_bytes()
    draw = random.random()
    if draw < PLACE_SHARE or not data:
        how = _one_of(random, PLACE_SPOILS)
        PLACE_SPOILS[how](random, path)
        return Spoilt(path, how, how in NEVER_RIGHT)
    if not _is_text(data) or draw < PLACE_SHARE + BYTE_SHARE:
        how = _one_of(random, BYTE_SPOILS)
        path.write_bytes(BYTE_SPOILS[how](random, data))
        return Spoilt(path, how, never_right=False)
    how = _one_of(random, TEXT_SPOILS)
    text = TEXT_SPOILS[how](random, data.decode())
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    return Spoilt(path, how, never_right=False)


def _one_of(random: Generator, table: Mapping[str, object]) -> str:
    return list(table)[int(random.integers(len(table)))]


def _is_text(data: bytes) -> bool:
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return b"\0" not in data[:IS_TEXT]
