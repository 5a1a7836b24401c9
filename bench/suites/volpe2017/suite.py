"""``rvbench suite volpe2017``: plan, run what is missing, summarise, report."""

from __future__ import annotations

from dataclasses import asdict, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.console import Console

from bench.report.numbers import count, number
from bench.suites.code_fingerprint import code_fingerprint
from bench.suites.folder import write_document
from bench.suites.request import SuiteFiles, SuiteRequest
from bench.suites.spread import do_units
from bench.suites.told_settings import told_settings
from bench.suites.units import LIBRARIES, WorkUnit
from bench.suites.volpe2017.cases import CAMERA
from bench.suites.volpe2017.plan import PARTS, QUICK, Plan, Sizes
from bench.suites.volpe2017.results import Outcomes, Results, StudiedCase
from bench.suites.volpe2017.suite_page import write_suite_page
from bench.suites.volpe2017.suite_tables import small
from pipelines.unknown_target.options import VARIANTS, options_for


def plan_of(request: SuiteRequest) -> Plan:
    """Return what a request asks for.

    Raises
    ------
    ScenarioError
        If a part or a size is none, or is one of another suite.
    """
    own = QUICK if request.quick else Sizes()
    asked = request.sizes("runs", "seeds", "duration_s", "paper_runs")
    return Plan(replace(own, seed=request.seed, **asked), request.parts or PARTS)


def units_of(request: SuiteRequest) -> list[WorkUnit]:
    """Return the units of what a request asks for."""
    return plan_of(request).units()


def run_suite(request: SuiteRequest, console: Console) -> SuiteFiles:
    """Do what is missing and write ``suite.json`` and ``suite.html``.

    Raises
    ------
    ScenarioError, StorageError
        Each says what to do; nothing already done is lost.
    """
    return run_plan(plan_of(request), request.out, request.workers, console)


def run_plan(plan: Plan, out: Path, workers: int, console: Console) -> SuiteFiles:
    """Do what is missing of a plan and write its results; see ``run_suite``.

    Parameters
    ----------
    plan : Plan
    out : Path
        Folder of the results.
    workers : int
        Processes.
    console : Console
        For progress.
    """
    folder = out / "units"
    do_units(plan.units(), folder, workers, console)
    outcomes = Outcomes(plan, folder)
    results = outcomes.results()
    score = write_document(out, "volpe2017", _settings(plan), parts=asdict(results))
    page = write_suite_page(out / "suite.html", outcomes, results, told_settings(_settings(plan)))
    return SuiteFiles(score, page, _summary(results))


def _settings(plan: Plan) -> dict[str, Any]:
    return {
        **asdict(plan.sizes),
        "camera": CAMERA,
        "options": {name: repr(options_for(name)) for name in VARIANTS},
        "code": code_fingerprint("bench.suites.volpe2017.tracking_run"),
        "libraries": {name: version(name) for name in LIBRARIES},
    }


def _summary(results: Results) -> list[list[str]]:
    """Return a line for each case: position and shape beside their bounds, and the NEES."""
    rows = [["", "runs", "position, m", "over bound", "shape, m", "over bound", "NEES"]]
    own = [*results.observability, *results.tracks]
    if results.paper is not None:
        rows.append(_line("the paper's case", results.paper.summary))
    rows += [_line(_title(one), one.summary) for one in own]
    return rows


def _title(own: StudiedCase) -> str:
    lost = ", no range" if own.case.range_to == "none" else ""
    return f"{own.case.name}{lost}"


def _line(title: str, one: Any) -> list[str]:
    ends = {end.quantity: end for end in one.ends}
    line = [title, count(one.runs)]
    for name in ("position_m", "shape_m"):
        error = ends[name].error
        line += [small(error), number(None if error is None else error / ends[name].bound)]
    return [*line, number(one.last_nees)]
