"""``rvbench suite pesce2019``: plan, run what is missing, summarise, report."""

from __future__ import annotations

from dataclasses import asdict, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.console import Console

from bench.suites.code_fingerprint import code_fingerprint
from bench.suites.folder import write_document
from bench.suites.pesce2019.comparison import compared
from bench.suites.pesce2019.navigators import options_text
from bench.suites.pesce2019.plan import CAMERA, PARTS, QUICK, RATE_HZ, VARIANTS, Plan, Sizes
from bench.suites.pesce2019.results import Outcomes
from bench.suites.pesce2019.suite_page import write_suite_page
from bench.suites.pesce2019.suite_tables import standing_table
from bench.suites.request import SIZES, SuiteFiles, SuiteRequest
from bench.suites.spread import do_units
from bench.suites.units import LIBRARIES, WorkUnit

NEVER_THE_SAME = ("seconds", "frame_ms")


def plan_of(request: SuiteRequest) -> Plan:
    """Return what a request asks for.

    Raises
    ------
    ScenarioError
        If a part or a size is none.
    """
    own, asked = QUICK if request.quick else Sizes(), request.sizes(*SIZES)
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
    cells = compared(results)
    found = {"cells": [asdict(cell) for cell in cells], "parts": asdict(results)}
    score = write_document(out, "pesce2019", _settings(plan), **found)
    standing = standing_table(cells)
    page = write_suite_page(out / "suite.html", outcomes, results, cells, _settings(plan))
    return SuiteFiles(score, page, [standing.head, *standing.rows])


def without_times(document: Any) -> Any:
    """Return what ``suite.json`` holds, but for what no two runs have alike: times."""
    if isinstance(document, dict):
        return {
            key: without_times(value)
            for key, value in document.items()
            if key not in NEVER_THE_SAME
        }
    if isinstance(document, list):
        return [without_times(value) for value in document]
    return document


def _settings(plan: Plan) -> dict[str, Any]:
    return {
        **asdict(plan.sizes),
        "rate_hz": RATE_HZ,
        "camera": CAMERA,
        "navigator": plan.navigator,
        "options": {name: options_text(plan.navigator, name) for name in VARIANTS},
        "code": code_fingerprint("bench.suites.pesce2019.tracking_run", plan.navigator),
        "libraries": {name: version(name) for name in LIBRARIES},
    }
