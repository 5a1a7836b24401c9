"""``rvbench suite vinag2018``: plan, run what is missing, summarise, report."""

from __future__ import annotations

from dataclasses import asdict, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.console import Console

from bench.report.numbers import NONE, number, share
from bench.suites.code_fingerprint import code_fingerprint
from bench.suites.folder import write_document
from bench.suites.request import SuiteFiles, SuiteRequest
from bench.suites.spread import do_units
from bench.suites.units import LIBRARIES, WorkUnit
from bench.suites.vinag2018.cases import CASES, LEO
from bench.suites.vinag2018.flight_dataset import write_flight
from bench.suites.vinag2018.page import write_suite_page
from bench.suites.vinag2018.plan import DATASET_S, PARTS, QUICK, Plan, Sizes, options_text
from bench.suites.vinag2018.results import Outcomes, Results
from models.errors import ScenarioError
from pipelines.absolute.options import REGIMES, VARIANTS

DATASET = "flight-leo"
STAR_RATES_HZ = (1, 2, 4, 5, 10, 20, 25, 50, 100)


def plan_of(request: SuiteRequest) -> Plan:
    """Return what a request asks for.

    Raises
    ------
    ScenarioError
        If a part or a size is none, or is one of another suite.
    """
    asked = request.sizes("runs", "seeds", "acquisitions", "duration_s", "rate_hz")
    if "rate_hz" in asked:
        asked["star_rate_hz"] = _star_rate_hz(asked.pop("rate_hz"))
    sizes = replace(QUICK if request.quick else Sizes(), seed=request.seed, **asked)
    return Plan(sizes, request.parts or PARTS)


def _star_rate_hz(rate_hz: float) -> int:
    if rate_hz not in STAR_RATES_HZ:
        known = ", ".join(map(str, STAR_RATES_HZ))
        raise ScenarioError(
            f"expected --rate-hz, star frames a second, among {known}, got {rate_hz:g}: the "
            "gyroscopes' hundred samples a second are summed between them"
        )
    return int(rate_hz)


def units_of(request: SuiteRequest) -> list[WorkUnit]:
    """Return the units of what a request asks for."""
    return plan_of(request).units()


def run_suite(request: SuiteRequest, console: Console) -> SuiteFiles:
    """Do what is missing and write ``suite.json``, ``suite.html`` and a flight as a dataset.

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
    if "dataset" in plan.parts and not (out / DATASET / "dataset.json").is_file():
        write_flight(out / DATASET, LEO, DATASET_S, plan.sizes.seed)
    outcomes = Outcomes(plan, folder)
    results = outcomes.results()
    settings = _settings(plan)
    score = write_document(out, "vinag2018", settings, parts=asdict(results))
    page = write_suite_page(out / "suite.html", outcomes, results, settings)
    return SuiteFiles(score, page, _summary(results))


def _settings(plan: Plan) -> dict[str, Any]:
    return {
        **asdict(plan.sizes),
        "parts": list(plan.parts),
        **{
            f"options of {variant}, {regime}": options_text(variant, regime, False)
            for variant in VARIANTS
            for regime in REGIMES
        },
        "code": code_fingerprint("bench.suites.vinag2018.navigation_run"),
        "libraries": {name: version(name) for name in LIBRARIES},
    }


def _summary(results: Results) -> list[list[str]]:
    """Return a line for each flown cell: its errors, over its bound, and how honest it is."""
    rows = [["", "radial, along, normal, m", "over bound", "NEES", "attitude, deg"]]
    for part, flown in results.flights.items():
        for own in flown if part != "stars" else ():
            over = NONE if own.bound is None else number(own.flight.rms_m / own.bound.position_m)
            named = part if part in CASES else f"{part}, {own.cell.case.key}"
            rows.append(
                [
                    f"{named}, {own.cell.variant}",
                    ", ".join(number(each) for each in own.flight.rms_along_m),
                    over,
                    number(own.flight.orbit.mean),
                    number(own.flight.attitude_deg, 2),
                ]
            )
    return rows + _star_rows(results) + _chain_rows(results)


def _chain_rows(results: Results) -> list[list[str]]:
    """Return a line for each variant with a chaser that navigates, and with one that knows."""
    rows = []
    if results.chained:
        rows.append(["chain", "position, mm", "lost", "NEES, position", "attitude, deg"])
    for own in results.chained:
        rows.append(
            [
                f"{own.variant}, chaser {own.chaser}",
                number(1e3 * own.position_m),
                number(own.lost),
                number(own.nees_translation),
                number(own.attitude_deg, 2),
            ]
        )
    return rows


def _star_rows(results: Results) -> list[list[str]]:
    """Return a line for each sky, and for each star sensor that a filter flew with."""
    rows = []
    if results.surveyed:
        rows.append(["star frames", "identified, wrong", "over bound", "NEES", "across, arcsec"])
    for sky in results.surveyed:
        rows.append(
            [
                f"{sky.sky}, {sky.attitudes} attitudes",
                f"{share(sky.identified)}, {sky.wrong}",
                number(sky.across_over_bound),
                number(sky.nees),
                number(sky.across_arcsec),
            ]
        )
    for own in results.flights.get("stars", ()):
        rows.append(
            [
                f"flight, {'star images' if own.cell.star_pixels else 'star data sheet'}",
                f"{own.flight.unseen} frames without attitude",
                NONE,
                number(own.flight.attitude.mean),
                f"{number(own.flight.attitude_deg, 2)} deg",
            ]
        )
    return rows
