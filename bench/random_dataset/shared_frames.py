"""A random dataset as a cluster's runner sees it: which frames a chunk renders, and which miss."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from bench.random_dataset.plan import Plan, shots_by_chunk
from bench.random_dataset.run import DatasetRequest, begin_parts, planned
from bench.runners.missing_files import MissingFiles
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
    missing = MissingFiles(frame_files(plan, request.out, runner.jobs))
    pieces = len(plan.shots)
    return SharedWork(request.out, tuple(arguments), runner.jobs, pieces, missing, "frames")


def frame_files(plan: Plan, out: Path, chunks: int) -> list[list[list[Path]]]:
    """Return the images of each frame of each chunk.

    Parameters
    ----------
    plan : Plan
    out : Path
        Each of its parts has begun.
    chunks : int
    """
    folders = {part.number: out / part.name for part in plan.used}
    streams = {number: read_info(folder).image_streams for number, folder in folders.items()}
    return [
        [
            [stream.path(folders[shot.part], shot.frame) for stream in streams[shot.part]]
            for shot in own
        ]
        for own in shots_by_chunk(plan, chunks)
    ]
