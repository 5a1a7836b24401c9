"""A sweep as a cluster's runner sees it: the Suns of each chunk, and which shots are missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from bench.runners.arguments import typed_arguments
from bench.runners.chunks import Chunk, runs_in_order
from bench.runners.missing_files import MissingFiles
from bench.runners.options import NAMES, RunnerRequest, asked_of
from bench.runners.shared_locks import check_locks
from bench.runners.shared_work import SharedWork
from bench.sweep.plan import SweepRequest
from bench.sweep.run import BegunSweep, begin_sweep, sweep_share
from bench.sweep.shots import shot_path
from models.at_work import at_work
from models.plain_console import plain_console

if TYPE_CHECKING:
    from bench.sweep.verb import Sweep


def swept_share(verb: Sweep, out: Path) -> Chunk | None:
    """Do the share that was typed, or have jobs do all that is missing.

    Parameters
    ----------
    verb : Sweep
    out : Path
        Folder of the sweep.

    Returns
    -------
    Chunk or None
        The share, which is all that was asked; None where maps and tables are still to be made.

    Raises
    ------
    RvbenchError
        Each says what to do; nothing already done is lost.
    """
    runner, chunk = asked_of(verb, verb.threads)
    check_locks(verb.store)
    if runner is not None:
        _have_swept(verb, out, runner)
    if chunk is not None:
        sweep_share(SweepRequest(case=verb.case, out=out, **verb.options()), chunk)
    return chunk


def _have_swept(verb: Sweep, out: Path, runner: RunnerRequest) -> None:
    from bench.runners.cluster_run import have_done
    from renders.variant.choice import choose_variant, short_name

    variant = short_name(choose_variant(verb.variant))  # light of one sweep is of one kind
    shared = replace(verb, out=out, variant=variant, threads=runner.workers)
    console = plain_console(stderr=True)
    begun = begin_sweep(SweepRequest(case=verb.case, out=out, **shared.options()), console)
    work = suns_work(begun, runner, typed_arguments("sweep", shared, NAMES))
    with at_work(out, "sweep"):
        have_done(runner, work, console)


def suns_work(begun: BegunSweep, runner: RunnerRequest, arguments: Sequence[str]) -> SharedWork:
    """Return a sweep as a runner sees it.

    Parameters
    ----------
    begun : BegunSweep
    runner : RunnerRequest
    arguments : sequence of str
        What one types for it.
    """
    out = begun.plan.request.out
    files = [
        [
            [shot_path(out, shot)]
            for work in begun.works
            for sun in own
            for shot in work.shots_under(sun)
        ]
        for own in runs_in_order(range(len(begun.plan.suns)), runner.jobs)
    ]
    pieces = sum(map(len, files))
    missing = MissingFiles(files)
    return SharedWork(out, tuple(arguments), runner.jobs, pieces, missing, "frames")
