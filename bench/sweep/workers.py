"""Processes that share the work of a sweep; with one, the work is done in this process.

What a worker does depends on what it is given alone, so the number of workers changes no result.
Workers load no Mitsuba, and die with the process that started them.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any, TypeVar

import cv2

from models.atomic_file import known_disks, remember_disks
from models.errors import StorageError

Result = TypeVar("Result")


class Workers:
    """A pool of processes, started when first needed; use it as a context.

    Parameters
    ----------
    count : int
    """

    def __init__(self, count: int) -> None:
        self.count = count
        self._pool: ProcessPoolExecutor | None = None

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)

    def run(
        self, work: Callable[..., Result], tasks: Sequence[tuple[Any, ...]]
    ) -> Iterator[tuple[int, Result]]:
        """Do ``work(*task)`` for every task; yield (number of the task, result) as each is done.

        Raises
        ------
        StorageError
            If a process was killed; what was written is kept.
        """
        if self.count == 1 or len(tasks) < 2:
            for number, task in enumerate(tasks):
                yield number, work(*task)
            return
        if self._pool is None:
            # Not forked: this process may hold the threads of Dr.Jit, which a fork would lose.
            self._pool = ProcessPoolExecutor(
                self.count,
                multiprocessing.get_context("spawn"),
                initializer=begin_worker,
                initargs=(known_disks(),),
            )
        numbers: dict[Future[Result], int] = {}
        try:
            for number, task in enumerate(tasks):
                numbers[self._pool.submit(work, *task)] = number
            for done in as_completed(numbers):
                yield numbers[done], done.result()
        except BrokenProcessPool as error:
            raise StorageError(
                "expected each working process to live, one was killed, perhaps for want of "
                "memory; what is done is kept: run the same command again, with fewer workers"
            ) from error
        finally:
            for future in numbers:
                future.cancel()


def begin_worker(disks: Mapping[Path, int]) -> None:
    """Prepare a worker: one thread, Ctrl-C left to its parent, and never to outlive it.

    Parameters
    ----------
    disks : mapping of Path to int
        Of the folders that its parent writes into; see ``models.atomic_file``.
    """
    remember_disks(disks)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    cv2.setNumThreads(1)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_die_with, args=(parent,), daemon=True).start()


def _die_with(parent: Any) -> None:
    parent.join()
    os._exit(1)
