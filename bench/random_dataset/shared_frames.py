"""A random dataset as a cluster's runner sees it: which frames a chunk renders, and which miss."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from bench.random_dataset.plan import Plan, shots_by_chunk
from bench.random_dataset.run import DatasetRequest, begin_parts, planned
from bench.runners.options import RunnerRequest
from bench.runners.shared_work import SharedWork
from models.dataset.description import read_info


def frames_work(
    request: DatasetRequest, runner: RunnerRequest, arguments: Sequence[str]
) -> SharedWork:
    """Begin a dataset and return it as a runner sees it.

    Parameters
    ----------
    request : DatasetRequest
    runner : RunnerRequest
    arguments : sequence of str
        What one types for it.

    Raises
    ------
    ScenarioError, DatasetError, VariantError, StorageError
        Each says what to do; nothing already rendered is lost.
    """
    plan = planned(request)
    begin_parts(request, plan)
    missing = MissingFrames(plan, request.out, runner.jobs)
    pieces = len(plan.shots)
    return SharedWork(request.out, tuple(arguments), runner.jobs, pieces, missing, "frames")


class MissingFrames:
    """Counts frames of which an image is not there; one that was is not looked for again.

    Parameters
    ----------
    plan : Plan
    out : Path
        Each of its parts has begun.
    chunks : int
    """

    def __init__(self, plan: Plan, out: Path, chunks: int) -> None:
        folders = {part.number: out / part.name for part in plan.used}
        streams = {number: read_info(folder).image_streams for number, folder in folders.items()}
        self._left = {
            number: [
                [stream.path(folders[shot.part], shot.frame) for stream in streams[shot.part]]
                for shot in own
            ]
            for number, own in enumerate(shots_by_chunk(plan, chunks))
        }

    def __call__(self) -> dict[int, int]:
        """Return how many frames of each chunk are not there, but for chunks that have all."""
        listed: dict[Path, set[str]] = {}
        self._left = {
            number: left
            for number, frames in self._left.items()
            if (left := [paths for paths in frames if not _are_there(paths, listed)])
        }
        return {number: len(frames) for number, frames in self._left.items()}


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
