"""Processes that begin with the libraries read already: a second saved for each of a thousand."""

from __future__ import annotations

import contextlib
import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

LIBRARIES = (
    "numpy", "scipy.linalg", "scipy.ndimage", "scipy.optimize", "scipy.interpolate",
    "scipy.spatial.transform", "scipy.special", "scipy.stats", "scipy.signal", "cv2", "pydantic",
    "rich.console", "rich.table", "pytest", "coverage", "tyro",
)  # fmt: skip
ASLEEP_S = 900.0
"""A child that computes nothing for so long by the clock waits for what will never come."""
BROKEN = 70
"""Exit code of a child whose work could not even be tried."""


@dataclass(frozen=True)
class Child:
    """What is to be done in a process of its own, and how long it may compute."""

    name: str
    work: Callable[[], int]
    most_s: float
    log: Path


def read_libraries() -> None:
    """Import what nearly every child needs and no test of ours changes."""
    for library in LIBRARIES:
        __import__(library)


@dataclass
class Running:
    """A child at work: since when, what it had computed when last looked at, and when that grew."""

    child: Child
    began: float
    spent: int = 0
    grew: float = 0.0

    def is_asleep(self, pid: int) -> bool:
        """Look at what it has computed; tell whether it has not for too long."""
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
        spent, now = sum(map(int, fields[11:15])), time.monotonic()
        if spent > self.spent:
            self.spent, self.grew = spent, now
        return now - max(self.grew, self.began) > ASLEEP_S


def run_all(children: Iterable[Child], at_once: int) -> Iterator[tuple[Child, int | None, float]]:
    """Run children, some at once; yield each with its exit code, None if it did not end in time.

    Time is the processor's: how busy the machine is changes nothing.

    Yields
    ------
    tuple
        The child, its exit code (negative: the signal that ended it), and seconds by the clock.
    """
    waiting, running = iter(children), dict[int, Running]()
    while True:
        while len(running) < at_once and (child := next(waiting, None)) is not None:
            running[_forked(child)] = Running(child, time.monotonic())
        if not running:
            return
        for pid, own in list(running.items()):
            done, status = os.waitpid(pid, os.WNOHANG)
            if done:
                del running[pid]
                _end_group(pid)
                code = os.waitstatus_to_exitcode(status)
                in_time = code not in (-signal.SIGXCPU, -signal.SIGKILL)
                yield own.child, code if in_time else None, time.monotonic() - own.began
            elif own.is_asleep(pid):
                _end_group(pid)
        time.sleep(0.02)


def _forked(child: Child) -> int:
    sys.stdout.flush()
    pid = os.fork()
    if pid:
        return pid
    code = BROKEN
    try:
        os.setpgid(0, 0)  # not a session of its own: it stays in its group of priority
        log = os.open(child.log, os.O_CREAT | os.O_WRONLY | os.O_TRUNC)
        os.dup2(log, 1)
        os.dup2(log, 2)
        most = int(sum(os.times()[:2]) + child.most_s) + 1
        resource.setrlimit(resource.RLIMIT_CPU, (most, most + 5))
        code = child.work()
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        os._exit(code)


def _end_group(pid: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(pid, signal.SIGKILL)
