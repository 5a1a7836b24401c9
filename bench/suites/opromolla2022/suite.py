"""``rvbench suite opromolla2022``: price, render what is missing, fly it, summarise, report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.console import Console

from bench.report.numbers import count, number
from bench.scoring.score import rounded
from bench.suites.code_fingerprint import code_fingerprint
from bench.suites.folder import write_document
from bench.suites.opromolla2022.frame_making import FlightFrames
from bench.suites.opromolla2022.page import write_suite_page
from bench.suites.opromolla2022.plan import GB, PARTS, QUICK, VARIANTS, Plan, Sizes
from bench.suites.opromolla2022.results import FlownSequence, Outcomes
from bench.suites.request import SuiteFiles, SuiteRequest
from bench.suites.spread import do_units
from bench.suites.units import LIBRARIES, WorkUnit, is_done
from models.progress_lines import told
from renders.store.budget import budget_bytes


def plan_of(request: SuiteRequest) -> Plan:
    """Return what a request asks for.

    Raises
    ------
    ScenarioError
        If a part or a size is none, or is one of another suite.
    """
    asked = request.sizes("runs", "seeds", "rate_hz", "width")
    rate_hz = asked.pop("rate_hz", None)
    own = QUICK if request.quick else Sizes()
    sizes = replace(own, seed=request.seed, **asked).at(rate_hz)
    return Plan(sizes, request.out, request.parts or PARTS)


def units_of(request: SuiteRequest) -> list[WorkUnit]:
    """Return the units of what a request asks for."""
    return plan_of(request).units


def prepare(request: SuiteRequest, units: Sequence[WorkUnit], console: Console) -> None:
    """Render the frames that some units, which are not done, fly over.

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
    budget = budget_bytes(request.store_budget_gb)
    for flight in _flown_by(plan_of(request), units):
        flight.make(request.store, budget, "auto", console, request.workers)


def run_suite(request: SuiteRequest, console: Console) -> SuiteFiles:
    """Do what is missing and write ``suite.json`` and ``suite.html``.

    Raises
    ------
    ScenarioError, VariantError, StorageError
        Each says what to do; nothing already done is lost.
    """
    budget = budget_bytes(request.store_budget_gb)
    return run_plan(plan_of(request), request.workers, request.store, budget, console)


def run_plan(
    plan: Plan, workers: int, store: Path | None, budget: float, console: Console
) -> SuiteFiles:
    """Do what is missing of a plan and write its results; see ``run_suite``.

    Parameters
    ----------
    plan : Plan
    workers : int
        Processes.
    store : Path or None
        Where light is kept.
    budget : float, bytes
        What that may take.
    console : Console
        For progress.
    """
    folder = plan.out / "units"
    left = [unit for unit in plan.units if not is_done(folder, unit)]
    flights = _flown_by(plan, left)  # what is flown needs no frames any more
    _announce(plan, flights, left, workers, budget, console)
    for flight in flights:
        flight.make(store, budget, "auto", console)
    do_units(plan.units, folder, workers, console)
    outcomes = Outcomes(plan, folder)
    results = outcomes.results()
    settings = _settings(plan)
    score = write_document(plan.out, "opromolla2022", settings, parts=rounded(asdict(results)))
    page = write_suite_page(plan.out / "suite.html", outcomes, results, settings)
    return SuiteFiles(score, page, _summary(results.sequences))


def _flown_by(plan: Plan, units: Sequence[WorkUnit]) -> list[FlightFrames]:
    folders = {unit.reads for unit in units}
    return [flight for flight in plan.flights if str(flight.folder) in folders]


def _announce(
    plan: Plan,
    flights: Sequence[FlightFrames],
    left: Sequence[WorkUnit],
    workers: int,
    budget: float,
    console: Console,
) -> None:
    """Say what all of it will take before any of it is done."""
    price = plan.price(flights)
    flown_s = sum(unit.expected_s for unit in left)
    frames = "no frames are" if not price.frames else f"{price.frames} frames are"
    console.print(
        f"{frames} to be rendered (at most {price.size_gb:.2g} GB in {plan.out}, their light "
        f"within {budget / GB:.2g} GB of the store; {told(price.render_s)} of one core) and "
        f"{len(left)} of {len(plan.units)} units of runs to be flown over them "
        f"({told(flown_s)} of one core, {told(flown_s / workers)} with {workers} "
        f"worker{'s' if workers > 1 else ''}), as thought before anything is timed here",
        soft_wrap=True,
    )


def _settings(plan: Plan) -> dict[str, Any]:
    sizes = plan.sizes
    return {
        "parts": list(plan.parts),
        "runs": sizes.runs,
        "runs under each error": sizes.seeds,
        "frames a second": dict(sizes.rates_hz),
        "columns": sizes.width,
        "seed": sizes.seed,
        "variants": list(VARIANTS),
        "frames": {flight.folder.name: flight.frames for flight in plan.flights},
        "code": code_fingerprint("bench.suites.opromolla2022.flight_run"),
        "libraries": {name: version(name) for name in LIBRARIES},
    }


def _summary(flown: Sequence[FlownSequence]) -> list[list[str]]:
    """Return a line for each sequence and variant: its errors, losses, and how honest it is."""
    rows = [["", "", "runs", "position, mm rms", "attitude, deg rms", "lost", "wrong", "NEES / 6"]]
    for own in flown:
        for variant in reversed(VARIANTS):
            one = own.per_frame[variant]
            rows.append(
                [
                    own.sequence.name,
                    variant,
                    count(one.runs),
                    number(one.position_mm[2] if one.position_mm else None),
                    number(one.attitude_deg[2] if one.attitude_deg else None),
                    count(one.lost),
                    count(one.wrong),
                    number(one.nees.mean),
                ]
            )
    return rows
