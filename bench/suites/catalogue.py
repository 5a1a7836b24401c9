"""The suites there are: the papers whose tables the bench repeats."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module

from rich.console import Console

from bench.runners.chunks import Chunk
from bench.runners.options import RunnerRequest
from bench.suites.folder import begin
from bench.suites.request import SuiteFiles, SuiteRequest
from models.at_work import at_work
from models.errors import ScenarioError

RunSuite = Callable[[SuiteRequest, Console], SuiteFiles]

# A suite is a module's ``run_suite``, loaded when it is asked for.
SUITES = {
    "opromolla2022": "bench.suites.opromolla2022.suite",
    "pesce2019": "bench.suites.pesce2019.suite",
    "uncooperative-suns": "bench.suites.uncooperative_suns.suite",
    "uncooperative-tumbles": "bench.suites.uncooperative_tumbles.suite",
    "vinag2018": "bench.suites.vinag2018.suite",
    "volpe2017": "bench.suites.volpe2017.suite",
}
TITLES = {
    "opromolla2022": "fiducial markers, both cameras: Opromolla et al. 2022, Tables 12 to 20",
    "pesce2019": "an uncooperative, known target from corners: Pesce et al. 2019, Tables 5 to 8",
    "uncooperative-suns": "an uncooperative target under any Sun, at any attitude: a study of ours",
    "uncooperative-tumbles": "an uncooperative target followed through any tumble: a study of ours",
    "vinag2018": "absolute orbit and attitude, LEO and GEO: VINAG 2018, Figures 5 to 10",
    "volpe2017": "an unknown target from tracks and a range: Volpe et al. 2017, Tables 1 and 2",
}


def suite_by_name(name: str) -> Suite:
    """Return a suite.

    Raises
    ------
    ScenarioError
        If there is none of that name; the message lists those there are.
    """
    if name not in SUITES:
        near = difflib.get_close_matches(name, SUITES, n=1)
        hint = f"; perhaps you meant {near[0]}" if near else ""
        raise ScenarioError(f"expected a suite among {', '.join(SUITES)}, got {name!r}{hint}")
    return Suite(name)


@dataclass(frozen=True)
class Suite:
    """A suite, in a folder that is new, empty or its own.

    Attributes
    ----------
    name : str
    """

    name: str

    def run(self, request: SuiteRequest, console: Console) -> SuiteFiles:
        """Do what is missing here, and write the results."""
        begin(request.out, self.name)
        found: RunSuite = import_module(SUITES[self.name]).run_suite
        return found(request, console)

    def do_share(self, request: SuiteRequest, chunk: Chunk, console: Console) -> int:
        """Do the units of a chunk; return how many were done now.

        Parameters
        ----------
        request : SuiteRequest
        chunk : Chunk
        console : Console
            For progress.
        """
        from bench.suites.shared_units import do_share

        begin(request.out, self.name)
        return do_share(SUITES[self.name], request, chunk, console)

    def have_done(
        self, request: SuiteRequest, runner: RunnerRequest, arguments: list[str], console: Console
    ) -> None:
        """Have the missing units done on a cluster.

        Parameters
        ----------
        request : SuiteRequest
        runner : RunnerRequest
        arguments : list of str
            What one types for it after ``rvbench``.
        console : Console
            For progress.
        """
        from bench.runners.cluster_run import have_done
        from bench.suites.shared_units import suite_work

        begin(request.out, self.name)
        work = suite_work(SUITES[self.name], request, runner, arguments)
        with at_work(request.out / "units", "suite"):
            have_done(runner, work, console)
