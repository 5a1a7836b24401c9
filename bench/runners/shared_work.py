"""What a runner has to know of a command's work: how to have a share done, and what is missing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from bench.runners.chunks import Chunk


@dataclass(frozen=True, eq=False)
class SharedWork:
    """A command whose work is shared by chunks, and the folder that shows how far it is.

    Attributes
    ----------
    out : Path
        The command's folder, which has begun and is marked as ours.
    arguments : tuple of str
        What one types after ``rvbench``, without runner and chunk.
    chunks : int
    pieces : int
        In all.
    missing : callable
        Returns how many pieces of each chunk are not there; chunks that have all are left out. It
        is called again and again, and should look at files, not read them.
    noun : str
        What a piece is: units, frames.
    """

    out: Path
    arguments: tuple[str, ...]
    chunks: int
    pieces: int
    missing: Callable[[], dict[int, int]]
    noun: str

    @property
    def place(self) -> Path:
        """Folder of the runner's own files."""
        return self.out / "runner"

    def command(self, number: int) -> list[str]:
        """Return what one types after ``rvbench`` for a share."""
        return [*self.arguments, "--chunk", str(Chunk(number, self.chunks))]
