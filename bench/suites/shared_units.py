"""The units of a suite on several machines: which of them a chunk does, and which are missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

from rich.console import Console

from bench.runners.chunks import Chunk, shares
from bench.runners.options import RunnerRequest
from bench.runners.shared_locks import check_locks
from bench.runners.shared_work import SharedWork
from bench.suites.request import SuiteRequest
from bench.suites.spread import do_units
from bench.suites.units import WorkUnit, is_done, outcome_path
from models.errors import ScenarioError


def shares_of(units: Sequence[WorkUnit], chunks: int) -> list[list[WorkUnit]]:
    """Return the units of each chunk; those that read the same rendered frames stay together."""
    costs = [unit.expected_s for unit in units]
    return shares(units, chunks, costs, [unit.reads for unit in units])


def do_share(module: str, request: SuiteRequest, chunk: Chunk, console: Console) -> int:
    """Do the units of a chunk, and no more; return how many were done now.

    Parameters
    ----------
    module : str
        Of the suite.
    request : SuiteRequest
    chunk : Chunk
    console : Console
        For progress.
    """
    suite = _that_is_shared_out(module, request)
    units = suite.units_of(request)
    own = shares_of(units, chunk.of)[chunk.number]
    folder = request.out / "units"
    left = [unit for unit in own if not is_done(folder, unit)]
    if left and hasattr(suite, "prepare"):
        check_locks(request.store)
        suite.prepare(request, left, console)
    return do_units(own, folder, request.workers, console, units)


def suite_work(
    module: str, request: SuiteRequest, runner: RunnerRequest, arguments: Sequence[str]
) -> SharedWork:
    """Return a suite as a runner sees it.

    Parameters
    ----------
    module : str
        Of the suite.
    request : SuiteRequest
    runner : RunnerRequest
    arguments : sequence of str
        What one types for it.
    """
    suite = _that_is_shared_out(module, request)
    units = suite.units_of(replace(request, chunk=None))
    own = shares_of(units, runner.jobs)
    missing = MissingUnits(request.out / "units", own)
    return SharedWork(request.out, tuple(arguments), runner.jobs, len(units), missing, "units")


def _that_is_shared_out(module: str, request: SuiteRequest) -> Any:
    suite = import_module(module)
    if not hasattr(suite, "units_of"):
        raise ScenarioError(
            f"expected a suite whose units can be shared out, {request.name}'s cannot yet: leave "
            "out --runner and --chunk"
        )
    return suite


class MissingUnits:
    """Counts units that are not done; one that was is not looked at again.

    Parameters
    ----------
    folder : Path
        Of the outcomes.
    own : sequence of lists of WorkUnit
        Of each chunk.
    """

    def __init__(self, folder: Path, own: Sequence[Sequence[WorkUnit]]) -> None:
        self._folder = folder
        self._left = {number: list(units) for number, units in enumerate(own)}
        self._stale: dict[str, int] = {}  # when a file of other code or another task was written

    def __call__(self) -> dict[int, int]:
        """Return how many units of each chunk are not done, but for chunks that have all."""
        self._left = {
            number: left
            for number, units in self._left.items()
            if (left := [unit for unit in units if not self._is_done(unit)])
        }
        return {number: len(units) for number, units in self._left.items()}

    def _is_done(self, unit: WorkUnit) -> bool:
        try:
            written_ns = outcome_path(self._folder, unit).stat().st_mtime_ns
        except OSError:
            return False
        if self._stale.get(unit.name) == written_ns:
            return False
        if is_done(self._folder, unit):
            return True
        self._stale[unit.name] = written_ns
        return False
