"""Which pieces of each chunk are not there yet, by the files that each leaves behind."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path


class MissingFiles:
    """Counts pieces of which a file is not there; one that was whole is not looked for again.

    Parameters
    ----------
    files : sequence of sequences of sequences of Path
        By chunk, then by piece.
    """

    def __init__(self, files: Sequence[Sequence[Sequence[Path]]]) -> None:
        self._left = {number: list(own) for number, own in enumerate(files)}

    def __call__(self) -> dict[int, int]:
        """Return how many pieces of each chunk are not there, but for chunks that have all."""
        listed: dict[Path, set[str]] = {}
        self._left = {
            number: left
            for number, pieces in self._left.items()
            if (left := [paths for paths in pieces if not _are_there(paths, listed)])
        }
        return {number: len(pieces) for number, pieces in self._left.items()}


def _are_there(paths: Sequence[Path], listed: dict[Path, set[str]]) -> bool:
    for path in paths:
        if path.parent not in listed:
            try:
                listed[path.parent] = set(os.listdir(path.parent))
            except OSError:
                listed[path.parent] = set()
        if path.name not in listed[path.parent]:
            return False
    return True
