"""A case's rendering as a cluster's runner sees it: which frames a chunk renders, which miss."""

from __future__ import annotations

from collections.abc import Sequence

from bench.runners.chunks import Chunk, runs_in_order
from bench.runners.missing_files import MissingFiles
from bench.runners.options import RunnerRequest
from bench.runners.shared_locks import check_locks
from bench.runners.shared_work import SharedWork
from models.errors import ScenarioError
from renders.batches.case_rendering import CaseRendering
from renders.scenario.scenario import RenderRequest, Scenario, resolve
from renders.world.build import world_of


def frames_of(request: RenderRequest, chunk: Chunk) -> frozenset[int]:
    """Return the frames that a chunk renders.

    Parameters
    ----------
    request : RenderRequest
    chunk : Chunk

    Raises
    ------
    ScenarioError
        If the frames cannot be rendered apart.
    StorageError
        If the locks of the store do not hold between machines.
    """
    check_locks(request.store)
    scenario = resolve(request)
    _check_apart(scenario)
    return frozenset(runs_in_order(range(len(scenario.times_s)), chunk.of)[chunk.number])


def case_work(
    request: RenderRequest, runner: RunnerRequest, arguments: Sequence[str]
) -> SharedWork:
    """Begin a case's dataset and return it as a runner sees it.

    Parameters
    ----------
    request : RenderRequest
    runner : RunnerRequest
    arguments : sequence of str
        What one types to render it.

    Raises
    ------
    ScenarioError, DatasetError, VariantError, StorageError
        Each says what to do; nothing already rendered is lost.
    """
    check_locks(request.store)
    case = CaseRendering(request)
    _check_apart(case.world.scenario)
    case.begin()
    streams = case.info.image_streams
    files = [
        [[stream.path(request.out, frame) for stream in streams] for frame in own]
        for own in runs_in_order(range(case.info.frames), runner.jobs)
    ]
    missing = MissingFiles(files)
    return SharedWork(
        request.out, tuple(arguments), runner.jobs, case.info.frames, missing, "frames"
    )


def _check_apart(scenario: Scenario) -> None:
    if world_of(scenario).plan.metered:
        raise ScenarioError(
            "expected frames that can be rendered apart, got exposures that are each metered from "
            'the image before; give exposure.mode = "fixed", or leave out --runner and --chunk'
        )
