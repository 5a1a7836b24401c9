"""A whole command in a process of its own: what it took by the clock and of processors."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from models.errors import RvbenchError

LAST_WORDS = 2000  # characters of a failed command's output that are shown


class CommandFailed(RvbenchError):
    """A command that was to be timed and did not end well."""


@dataclass(frozen=True)
class Spent:
    """What a command took, all of its processes counted.

    Attributes
    ----------
    clock_s : float, s
    processor_s : float, s
    """

    clock_s: float
    processor_s: float


def timed(arguments: Sequence[str], log: Path, cores: int | None = None) -> Spent:
    """Run ``rvbench`` with these arguments and wait for it.

    Parameters
    ----------
    arguments : sequence of str
    log : Path
        Where all that it says goes.
    cores : int, optional
        That it may use, where the system lets them be chosen: a worker's threads of light are
        not to be more than what is counted. All unless given.

    Raises
    ------
    CommandFailed
        If its exit code is not 0.
    """
    with log.open("wb") as said, _on_cores(cores):
        began = time.perf_counter()
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", "bench", *arguments],
            stdin=subprocess.DEVNULL,
            stdout=said,
            stderr=subprocess.STDOUT,
        )
        _, status, usage = os.wait4(process.pid, 0)
        clock_s = time.perf_counter() - began
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        last = log.read_text(errors="replace")[-LAST_WORDS:].strip()
        raise CommandFailed(
            f"expected `rvbench {' '.join(arguments)}` to end well, got exit code "
            f"{process.returncode}:\n{last}"
        )
    return Spent(clock_s, usage.ru_utime + usage.ru_stime)


@contextmanager
def _on_cores(count: int | None) -> Iterator[None]:
    """Have processes begun meanwhile use so many cores, those of the lowest numbers."""
    if count is None or not hasattr(os, "sched_setaffinity"):
        yield
        return
    every = os.sched_getaffinity(0)
    os.sched_setaffinity(0, sorted(every)[:count])
    try:
        yield
    finally:
        os.sched_setaffinity(0, every)


def yardstick_s(rounds: int = 5) -> float:
    """Return the processor time that a fixed piece of work takes here, the least of some rounds, s.

    What is kept of one machine is told in it, so that another may be held against it: Fourier
    transforms, a blur and a sort by others' code, on one thread.

    Parameters
    ----------
    rounds : int
    """
    image = np.random.default_rng(0).standard_normal((1024, 1024))
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        spent = []
        for _ in range(rounds):
            began = time.process_time()
            np.fft.ifft2(np.fft.fft2(image))
            cv2.GaussianBlur(image, (0, 0), 4.0)
            np.sort(image, axis=None)
            spent.append(time.process_time() - began)
    finally:
        cv2.setNumThreads(threads)
    return min(spent)
