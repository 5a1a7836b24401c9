"""``rvbench suite uncooperative-tumbles``: render what is missing, follow it, summarise, report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from rich.console import Console

from bench.report.numbers import count, number
from bench.suites.request import SuiteFiles, SuiteRequest
from bench.suites.uncooperative_suns.study import Study
from bench.suites.uncooperative_suns.targets import TARGETS
from bench.suites.uncooperative_tumbles.page import write_suite_page
from bench.suites.uncooperative_tumbles.plan import QUICK, Plan, Sizes
from bench.suites.uncooperative_tumbles.results import Summary, followed_of, summary_of
from bench.suites.units import WorkUnit

NAME = "uncooperative-tumbles"


def plan_of(request: SuiteRequest) -> Plan:
    """Return what a request asks for.

    Raises
    ------
    ScenarioError
        If a target or a size is none.
    """
    own, asked = QUICK if request.quick else Sizes(), request.sizes("runs", "paper_runs", "width")
    sizes = replace(own, seed=request.seed, **asked)
    return Plan(sizes, request.parts or TARGETS, request.out)


def units_of(request: SuiteRequest) -> list[WorkUnit]:
    """Return the units of what a request asks for; their frames are rendered by ``prepare``."""
    return plan_of(request).units


def prepare(request: SuiteRequest, units: Sequence[WorkUnit], console: Console) -> None:
    """Render the tumbles that some units, which are not done, follow.

    Parameters
    ----------
    request : SuiteRequest
    units : sequence of WorkUnit
    console : Console
        For progress.

    Raises
    ------
    ScenarioError, VariantError, StorageError
        Each says what to do; nothing already done is lost.
    """
    plan_of(request).render_for(units, request.workers, console)


def run_suite(request: SuiteRequest, console: Console) -> SuiteFiles:
    """Do what is missing and write ``suite.json`` and ``suite.html``.

    Raises
    ------
    ScenarioError, VariantError, StorageError
        Each says what to do; nothing already done is lost.
    """
    return STUDY.run(plan_of(request), request.workers, console)


def _summary(summaries: dict[str, dict[str, Summary]]) -> list[list[str]]:
    rows: list[list[Any]] = [
        ["", "", "tumbles", "acquired", "right", "wrong", "most in a row", "NEES/n"]
    ]
    for target, own in summaries.items():
        for variant, one in reversed(own.items()):
            rows.append(
                [
                    target, variant, count(one.tumbles), count(one.acquired),
                    f"{one.right} of {one.images}", count(one.wrong), count(one.longest_wrong),
                    f"{number(one.nees_translation)}, {number(one.nees_rotation)}",
                ]
            )  # fmt: skip
    return rows


STUDY = Study(NAME, followed_of, summary_of, write_suite_page, _summary)
