"""Processes that render a random dataset, each pose by one of them.

A process stays with a part as long as there is work in it: a scene is built once. What a frame is
depends on its scenario alone, so neither the number of processes nor their order changes a bit.
The process that was asked renders, too: it has read the spacecraft already, and while another
starts it is at work.
"""

from __future__ import annotations

import multiprocessing
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from bench.sweep.workers import begin_worker
from models.atomic_file import known_disks
from models.errors import StorageError
from renders.batches.case_rendering import CaseRendering
from renders.scenario.scenario import RenderRequest
from renders.variant.choice import active_variant, full_name

Task: TypeAlias = tuple[RenderRequest, tuple[int, ...]]
"""A part, and frames of it, those of a pose together."""

AT_LEAST = 8  # frames of a task: what it costs to hand one over is not seen then
IN_HAND = 2  # tasks of another process: it need not wait while this one renders

OWN = -1  # this process, among the numbers of those that it started
_opened: dict[Path, CaseRendering] = {}
"""The part that this process is at."""


def tasks_of(request: RenderRequest, poses: Sequence[Sequence[int]]) -> list[Task]:
    """Return tasks of whole poses.

    Parameters
    ----------
    request : RenderRequest
    poses : sequence of sequences of int
        The frames that are missing, by pose.
    """
    tasks, frames = list[Task](), list[int]()
    for own in poses:
        frames += own
        if len(frames) >= AT_LEAST:
            tasks.append((request, tuple(frames)))
            frames = []
    if frames:
        tasks.append((request, tuple(frames)))
    return tasks


def render_frames(request: RenderRequest, frames: Sequence[int]) -> int:
    """Render frames of a part that has begun; return how many."""
    if request.out not in _opened:
        _opened.clear()
        _opened[request.out] = case = CaseRendering(request)
        case.start_renderer()
    case = _opened[request.out]
    chosen = set(frames)
    wanted = [exposure for exposure in case.left if exposure.frame in chosen]
    asked = frozenset(wanted)
    for exposure in wanted:
        case.render(exposure, asked)
    return len(chosen)


@dataclass(eq=False)
class Crew:
    """Some processes and the tasks that are left, by part.

    Attributes
    ----------
    workers : int
        With one, the work is done in this process; this process is one of them unless it renders
        with another of Mitsuba's variants already.
    left : dict of Path to deque of Task
        By the folder of the part.
    """

    workers: int
    left: dict[Path, deque[Task]] = field(default_factory=dict)
    _at: dict[int, Path] = field(default_factory=dict, init=False)

    def work(self, tasks: Mapping[Path, Sequence[Task]]) -> Iterator[int]:
        """Do every task; yield how many frames each brought.

        Raises
        ------
        StorageError
            If a process was killed; what it has rendered is kept.
        RvbenchError
            What a task ended with.
        """
        self.left = {folder: deque(own) for folder, own in tasks.items() if own}
        count = min(self.workers, sum(map(len, self.left.values())))
        here = count <= 1 or all(_renders_here(own[0][0]) for own in self.left.values())
        # Not forked: this process may hold threads, which a fork would lose.
        context = multiprocessing.get_context("spawn")
        pools = [
            ProcessPoolExecutor(1, context, begin_worker, (known_disks(),))
            for _ in range(count - here)
        ]
        try:
            yield from self._shared(pools, here=here)
        except BrokenProcessPool as error:
            raise StorageError(
                "expected each rendering process to live, one was killed, perhaps for want of "
                "memory; every frame that is there is kept: run the same command again, with fewer "
                "--workers"
            ) from error
        finally:
            _opened.clear()
            for pool in pools:
                pool.shutdown(wait=True, cancel_futures=True)

    def _shared(self, pools: Sequence[ProcessPoolExecutor], *, here: bool) -> Iterator[int]:
        """Do every task, some ``here``, in this process; it hands them out between its own."""
        busy: dict[Future[int], int] = {}
        self._fill(pools, busy, 1)
        while busy or here:
            own = self._next(OWN) if here else None
            here = own is not None
            if own is not None:
                self._fill(pools, busy, IN_HAND)
                yield render_frames(*own)
            done, _ = wait(busy, 0.0 if here else None, return_when=FIRST_COMPLETED)
            for future in done:
                busy.pop(future)
                yield future.result()
            self._fill(pools, busy, 1)

    def _fill(
        self, pools: Sequence[ProcessPoolExecutor], busy: dict[Future[int], int], most: int
    ) -> None:
        """Hand each of the others tasks until it has so many, or none is left."""
        for worker, pool in enumerate(pools):
            while list(busy.values()).count(worker) < most:
                task = self._next(worker)
                if task is None:
                    return
                busy[pool.submit(render_frames, *task)] = worker

    def _next(self, worker: int) -> Task | None:
        """Return a task of the part that a worker is at, else of one that nobody is at."""
        here = self._at.get(worker)
        if here not in self.left:
            taken = {place for other, place in self._at.items() if other != worker}
            self._at.pop(worker, None)
            here = max(
                self.left, key=lambda each: (each not in taken, len(self.left[each])), default=None
            )
        if here is None:
            return None
        self._at[worker] = here
        task = self.left[here].popleft()
        if not self.left[here]:
            del self.left[here]
        return task


def _renders_here(request: RenderRequest) -> bool:
    """Tell whether this process can render it: one holds one variant."""
    active = active_variant()
    return active is None or request.variant == "auto" or full_name(request.variant) == active
