"""What a runner asks of a cluster, whichever it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class Queued:
    """What a cluster has of a job now.

    Attributes
    ----------
    waiting, running : frozenset of int
        Chunks.
    why : str
        What it waits for, in the cluster's words; empty if they are not told.
    tells_which_run : bool
        Whether those that run are told from those that wait.
    """

    waiting: frozenset[int] = frozenset()
    running: frozenset[int] = frozenset()
    why: str = ""
    tells_which_run: bool = True

    @property
    def active(self) -> frozenset[int]:
        """Chunks that will be done, or are being done."""
        return self.waiting | self.running


class Queue(Protocol):
    """A cluster as one job sees it."""

    def submit(self, numbers: Sequence[int]) -> tuple[str, ...]:
        """Have chunks done; return what the cluster calls what was submitted.

        Raises
        ------
        RunnerError
            If it refuses.
        """

    def queued(self) -> Queued | None:
        """Return what is queued; None while the cluster does not answer.

        Raises
        ------
        RunnerError
            If it never will again.
        """

    def cancel(self) -> None:
        """Have nothing more done."""

    def close(self) -> None:
        """Let go of the cluster; what it does goes on if it can."""
