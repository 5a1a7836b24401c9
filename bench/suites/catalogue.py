"""The suites there are: the papers whose tables the bench repeats."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from importlib import import_module

from rich.console import Console

from bench.suites.folder import begin
from bench.suites.request import SuiteFiles, SuiteRequest
from models.errors import ScenarioError

RunSuite = Callable[[SuiteRequest, Console], SuiteFiles]

# A suite is a module's ``run_suite``, loaded when it is asked for.
SUITES = {
    "opromolla2022": "bench.suites.opromolla2022.suite",
    "pesce2019": "bench.suites.pesce2019.suite",
    "uncooperative-suns": "bench.suites.uncooperative_suns.suite",
    "vinag2018": "bench.suites.vinag2018.suite",
    "volpe2017": "bench.suites.volpe2017.suite",
}
TITLES = {
    "opromolla2022": "fiducial markers, both cameras: Opromolla et al. 2022, Tables 12 to 20",
    "pesce2019": "an uncooperative, known target from corners: Pesce et al. 2019, Tables 5 to 8",
    "uncooperative-suns": "an uncooperative target under any Sun, at any attitude: a study of ours",
    "vinag2018": "absolute orbit and attitude, LEO and GEO: VINAG 2018, Figures 5 to 10",
    "volpe2017": "an unknown target from tracks and a range: Volpe et al. 2017, Tables 1 and 2",
}


def suite_by_name(name: str) -> RunSuite:
    """Return what runs a suite, in a folder that is new, empty or its own.

    Raises
    ------
    ScenarioError
        If there is none of that name; the message lists those there are.
    """
    if name not in SUITES:
        near = difflib.get_close_matches(name, SUITES, n=1)
        hint = f"; perhaps you meant {near[0]}" if near else ""
        raise ScenarioError(f"expected a suite among {', '.join(SUITES)}, got {name!r}{hint}")
    found: RunSuite = import_module(SUITES[name]).run_suite

    def run_in_own_folder(request: SuiteRequest, console: Console) -> SuiteFiles:
        begin(request.out, name)
        return found(request, console)

    return run_in_own_folder
