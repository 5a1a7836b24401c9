"""What may stand where a file should: a folder, a pipe, a link to nowhere, nothing."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

from numpy.random import Generator

PlaceSpoil: TypeAlias = Callable[[Generator, Path], None]
GIGABYTE = 2**30


def folder(random: Generator, path: Path) -> None:
    """Put a folder there."""
    path.unlink()
    path.mkdir()


def pipe(random: Generator, path: Path) -> None:
    """Put a pipe there, into which nobody writes."""
    path.unlink()
    os.mkfifo(path)


def nothing(random: Generator, path: Path) -> None:
    """Take the file away."""
    path.unlink()


def empty(random: Generator, path: Path) -> None:
    """Leave no byte."""
    path.write_bytes(b"")


def noise(random: Generator, path: Path) -> None:
    """Put noise there."""
    path.write_bytes(random.bytes(int(random.integers(1, 5000))))


def ring(random: Generator, path: Path) -> None:
    """Put a link to itself there."""
    path.unlink()
    path.symlink_to(path.name)


def dangling(random: Generator, path: Path) -> None:
    """Put a link to nothing there."""
    path.unlink()
    path.symlink_to("is_not_there")


def device(random: Generator, path: Path) -> None:
    """Put a link to a device there, which never ends."""
    path.unlink()
    path.symlink_to("/dev/zero")


def huge(random: Generator, path: Path) -> None:
    """Have a gigabyte of zeros follow; sparse, so that no disk fills."""
    os.truncate(path, GIGABYTE)


PLACE_SPOILS: dict[str, PlaceSpoil] = {
    each.__name__: each
    for each in (folder, pipe, nothing, empty, noise, ring, dangling, device, huge)
}
NEVER_RIGHT = frozenset(
    each.__name__ for each in (folder, pipe, nothing, ring, dangling, device, empty, noise)
)
"""Of a file without which the verb has nothing to work on."""
