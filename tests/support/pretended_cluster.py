"""A cluster that is none: work that is files, a queue in memory, SLURM's commands as scripts."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bench.runners.queue import Queued
from bench.runners.shared_work import SharedWork

PIECES = 2  # of each chunk


def piece_work(out: Path, chunks: int) -> SharedWork:
    """Return work of two pieces a chunk, each an empty file ``CHUNK-PIECE`` when done."""

    def missing() -> dict[int, int]:
        left = {
            number: sum(not (out / f"{number}-{k}").exists() for k in range(PIECES))
            for number in range(chunks)
        }
        return {number: count for number, count in left.items() if count}

    (out / "runner" / "logs").mkdir(parents=True, exist_ok=True)
    return SharedWork(out, ("suite", "mine"), chunks, PIECES * chunks, missing, "pieces")


def do(out: Path, number: int) -> None:
    """Do a chunk of such work."""
    for k in range(PIECES):
        (out / f"{number}-{k}").touch()


@dataclass(eq=False)
class PretendedQueue:
    """A queue with a node that does one task each time that somebody sleeps.

    Attributes
    ----------
    does : callable
        What a task does; told the chunk and how often it was submitted.
    silent : int
        Next questions that are not answered.
    """

    does: Callable[[int, int], None]
    silent: int = 0
    stuck: frozenset[int] = frozenset()
    waiting: list[int] = field(default_factory=list)
    submitted: list[list[int]] = field(default_factory=list)
    cancelled: bool = False
    now_s: float = 0.0

    def submit(self, numbers: Sequence[int]) -> tuple[str, ...]:
        """Note it."""
        self.submitted.append(list(numbers))
        self.waiting += numbers
        return (str(len(self.submitted)),)

    def queued(self) -> Queued | None:
        """Tell, unless silent."""
        if self.silent:
            self.silent -= 1
            return None
        return Queued(frozenset(self.waiting[1:]), frozenset(self.waiting[:1]))

    def cancel(self) -> None:
        """Note it."""
        self.cancelled, self.waiting = True, []

    def close(self) -> None:
        """Nothing is held."""

    def sleep(self, seconds: float) -> None:
        """Pass time, and do the task at the head."""
        self.now_s += seconds
        if self.waiting and self.waiting[0] not in self.stuck:
            number = self.waiting.pop(0)
            self.does(number, sum(number in each for each in self.submitted))


COMMANDS = {
    "sbatch": """#!/bin/sh
echo "sbatch $*" >>"$PRETENDED/asked"
[ -e "$PRETENDED/refuses" ] && { echo "sbatch: error: invalid partition specified" >&2; exit 1; }
echo "4711;cluster"
""",
    "squeue": """#!/bin/sh
echo "squeue $*" >>"$PRETENDED/asked"
[ -e "$PRETENDED/silent" ] && { echo "slurm_load_jobs error: Unable to contact" >&2; exit 1; }
cat "$PRETENDED/queue" 2>/dev/null || true
""",
    "scancel": """#!/bin/sh
echo "scancel $*" >>"$PRETENDED/asked"
rm -f "$PRETENDED/queue"
""",
}


class PretendedSlurm:
    """SLURM's commands, which read what a test wrote and write down what they were asked.

    Parameters
    ----------
    folder : Path
    setenv : callable
        As pytest's ``monkeypatch`` has it.
    """

    def __init__(self, folder: Path, setenv: Callable[[str, str], None]) -> None:
        self.folder = folder
        for name, text in COMMANDS.items():
            (folder / name).write_text(text)
            (folder / name).chmod(0o755)
        setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")
        setenv("PRETENDED", str(folder))

    def has(self, *rows: str) -> None:
        """Let the queue hold some rows, as ``array|task|state|reason``."""
        (self.folder / "queue").write_text("".join(f"{row}\n" for row in rows))

    def turn(self, how: str) -> None:
        """Make it ``silent``, or let it be that it ``refuses``."""
        (self.folder / how).touch()

    @property
    def asked(self) -> list[str]:
        """Every command that was run."""
        path = self.folder / "asked"
        return path.read_text().splitlines() if path.exists() else []

    def asked_of(self, command: str) -> list[str]:
        """Every line that began with a command."""
        return [line for line in self.asked if line.split()[0] == command]
