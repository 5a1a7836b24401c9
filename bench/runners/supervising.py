"""Wait for a job: count what is there, submit again what ended without its work, say how far it is.

What is done is known from the command's own files, never from the cluster: a queue that forgets, a
node that dies or a submitter that is killed loses nothing, and the same loop goes on.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from rich.console import Console

from bench.runners.job_record import (
    JobRecord,
    cancelled_path,
    log_path,
    started,
    write_record,
)
from bench.runners.queue import Queue, Queued
from bench.runners.shared_work import SharedWork
from models.errors import RunnerError
from models.progress_lines import LinePace, told

TRIES = 4  # the first, and three more
MOST_LOG_BYTES = 4000


@dataclass(frozen=True)
class Patience:
    """How often to look, and how long files may take to be seen from here.

    Attributes
    ----------
    look_s, most_look_s : float, s
        From one look to the next: at first, and at most.
    settle_s : float, s
        From a job's end to when its last files are surely seen: a network file system may show an
        older listing of a folder meanwhile.
    shared_s : float, s
        From a job's start to when its token is surely seen. Clients of NFS keep a listing for up to
        60 s.
    """

    look_s: float = 1.0
    most_look_s: float = 10.0
    settle_s: float = 10.0
    shared_s: float = 75.0


@dataclass(eq=False)
class Supervision:
    """One wait for one job.

    Attributes
    ----------
    work : SharedWork
    queue : Queue
    record : JobRecord
    console : Console
        For progress.
    patience : Patience
    clock, sleep : callable
        Seconds; and what waits some.
    """

    work: SharedWork
    queue: Queue
    record: JobRecord
    console: Console
    patience: Patience = field(default_factory=Patience)
    clock: Callable[[], float] = time.monotonic
    sleep: Callable[[float], None] = time.sleep
    _ended_s: dict[int, float] = field(default_factory=dict, init=False)
    _ran_s: dict[int, float] = field(default_factory=dict, init=False)
    _silent: bool = field(default=False, init=False)

    def wait(self) -> None:
        """Return once all is there.

        Raises
        ------
        RunnerError
            If a chunk's jobs ended too often without its work, or the folder is not shared; what
            is done is kept.
        """
        began_s = self.clock()
        missing = self.work.missing()
        at_first = sum(missing.values())
        lines = LinePace(max(1, at_first), self.clock)
        while missing:
            self._check_cancelled()
            queued = self._queued()
            given_up = []
            if queued is not None:
                self._check_shared(queued)
                given_up = self._submit_again(missing, queued)
                if given_up and not (queued.active & missing.keys()):
                    raise self._gave_up(given_up)
            left = sum(missing.values())
            if lines.due(at_first - left):
                self._say(at_first, left, self.clock() - began_s, queued)
            spent_s = self.clock() - began_s
            self.sleep(min(self.patience.most_look_s, max(self.patience.look_s, spent_s / 20.0)))
            missing = self.work.missing()
        if at_first:
            noun, pieces = self.work.noun, self.work.pieces
            self.console.print(f"{noun}: {pieces} of {pieces}", soft_wrap=True)

    def _check_cancelled(self) -> None:
        if cancelled_path(self.work.place, self.record.name).exists():
            self.queue.cancel()
            raise RunnerError(
                f"expected job {self.record.name} to be done, it was cancelled; all that is done "
                "is kept, and the same command submits the rest"
            )

    def _queued(self) -> Queued | None:
        queued = self.queue.queued()
        if queued is None and not self._silent:
            self.console.print("the cluster does not answer; still waiting", soft_wrap=True)
        self._silent = queued is None
        return queued

    def _submit_again(self, missing: dict[int, int], queued: Queued) -> list[int]:
        """Submit what ended without its work; return what was submitted often enough."""
        now_s, given_up, again = self.clock(), list[int](), list[int]()
        for number in sorted(missing):
            if number in queued.active:
                self._ended_s.pop(number, None)
            elif now_s - self._ended_s.setdefault(number, now_s) >= self.patience.settle_s:
                tries = self.record.tries.get(number, 0)
                (given_up if tries >= TRIES else again).append(number)
        if again:
            self.console.print(
                f"{len(again)} of {self.work.chunks} jobs ended without all of their work; "
                "submitting them again",
                soft_wrap=True,
            )
            self.submit(again)
        return given_up

    def submit(self, numbers: list[int]) -> None:
        """Submit chunks; the record tells of it before the cluster does."""
        self.record = self.record.tried(numbers)
        write_record(self.work.place, self.record)
        ids = self.queue.submit(numbers)
        self.record = replace(self.record, ids=(*self.record.ids, *ids))
        write_record(self.work.place, self.record)
        for number in numbers:
            self._ended_s.pop(number, None)
            self._ran_s.pop(number, None)

    def _check_shared(self, queued: Queued) -> None:
        """Refuse a folder in which a job that runs for long has left no token that we see."""
        now_s = self.clock()
        for number in queued.running:
            self._ran_s.setdefault(number, now_s)
        unseen = [
            number
            for number in queued.running
            if now_s - self._ran_s[number] >= self.patience.shared_s
        ]
        if unseen and not started(self.work.place, self.record):
            self.queue.cancel()
            raise RunnerError(
                f"expected {self.work.out} to be a folder that the cluster's machines share with "
                f"this one; a job runs since {self.patience.shared_s:.0f} s and nothing that it "
                "wrote is seen here. The job was cancelled: choose an --out that is shared"
            )

    def _gave_up(self, numbers: list[int]) -> RunnerError:
        number = numbers[0]
        log = log_path(self.work.place, number)
        more = f" (and {len(numbers) - 1} other chunks)" if len(numbers) > 1 else ""
        words = _last_line(log)
        shared = "" if words else "; it wrote nothing: is the folder shared with that machine?"
        return RunnerError(
            f"expected chunk {number} of {self.work.chunks}{more} to be done, its job ended "
            f"{self.record.tries.get(number, 0)} times without; its log is {log}"
            f"{f', which ends: {words}' if words else shared}; all that is done is kept: mend what "
            "it says and run the same command again"
        )

    def _say(self, at_first: int, left: int, spent_s: float, queued: Queued | None) -> None:
        done = at_first - left
        left_s = spent_s / done * left if done else None
        said = ""
        if queued is not None:
            why = f" ({queued.why})" if queued.why and not queued.running else ""
            said = (
                f"; {len(queued.running)} jobs run, {len(queued.waiting)} wait{why}"
                if queued.tells_which_run
                else f"; {len(queued.active)} jobs are not done"
            )
        self.console.print(
            f"{self.work.noun}: {self.work.pieces - left} of {self.work.pieces}{said}; "
            f"left: {told(left_s)}",
            soft_wrap=True,
        )


def _last_line(log: Path) -> str:
    try:
        with log.open("rb") as file:
            file.seek(max(0, log.stat().st_size - MOST_LOG_BYTES))
            lines = file.read().decode(errors="replace").split("\n")
    except OSError:
        return ""
    said = [line.strip() for line in lines if line.strip()]
    return said[-1][:500] if said else ""
