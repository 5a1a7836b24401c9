"""The page of the suite, of the house's parts: tables beside the paper's statements, figures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bench.report.numbers import number
from bench.report.page import Page, write_page
from bench.report.parts import Card, Figure, Section, TitledTable
from bench.report.plot import svg_address
from bench.report.run_table import with_runs
from bench.report.table import Table, length
from bench.suites.told_settings import told_settings
from bench.suites.vinag2018 import figures, star_figure, star_tables, tables
from bench.suites.vinag2018.cases import CASES, published
from bench.suites.vinag2018.chain_results import PAPER_DEG, chain_figure, chain_table
from bench.suites.vinag2018.chain_run import NAVIGATED
from bench.suites.vinag2018.integrity_results import diagnosed_table
from bench.suites.vinag2018.results import Flown, Outcomes, Results
from bench.suites.vinag2018.runs import chain_runs, flight_runs
from pipelines.absolute.options import VARIANTS

LEFT_OUT = (
    "The first tenth of a flight is left out: the filter starts a kilometre, a metre per second "
    "and a third of a degree off, with a clock that is 0.3 s wrong."
)


def write_suite_page(
    path: Path, outcomes: Outcomes, results: Results, settings: dict[str, Any]
) -> Path:
    """Write ``suite.html``.

    Parameters
    ----------
    path : Path
    outcomes : Outcomes
        For the figures.
    results : Results
    settings : dict
        What was run.

    Returns
    -------
    Path
        The file.
    """
    main = [own for part in CASES for own in results.flights.get(part, ())]
    title, headline = "Beside the paper's statements", _stated(outcomes, main)
    if results.chained and not main:
        title, headline = "Navigated and true chasers", _chained(outcomes, results)
    write_page(
        path,
        Page(
            title="VINAG 2018, absolute navigation",
            heading="VINAG 2018: absolute navigation",
            lead="Orbit, attitude and clock from GNSS, gyroscopes and stars, LEO and GEO",
            label="best",
            cards=_cards(main) + _chain_cards(results),
            headline_title=title,
            headline=headline,
            before=[],
            after=[*_flights(outcomes, results, main), *_others(outcomes, results)],
            facts=[
                *((f"settled: {name}", text) for name, text in published()["settled"].items()),
                *told_settings(settings),
            ],
            explained=True,
        ),
    )
    return path


def _stated(outcomes: Outcomes, main: Sequence[Flown]) -> Table:
    rows = [
        {3: runs}
        for own in main
        for runs in [flight_runs(outcomes, own.cell)]
        for _ in (*tables.AXES, "attitude")
    ]
    return with_runs(tables.stated_table(main), rows)


def _bounds(outcomes: Outcomes, flown: Sequence[Flown]) -> Table:
    bounded = [own for own in flown if own.bound is not None]
    rows = [dict.fromkeys((2, 3, 4, 6, 7), flight_runs(outcomes, own.cell)) for own in bounded]
    return with_runs(tables.bound_table(bounded), rows)


def _chained(outcomes: Outcomes, results: Results) -> Table:
    rows = [
        dict.fromkeys((1, 2, 3, 4, 5, 9), chain_runs(outcomes, own.variant, own.chaser))
        for own in results.chained
    ]
    return with_runs(chain_table(results.chained), rows)


def _cards(main: list[Flown]) -> list[Card]:
    cards = []
    for own in main:
        if own.cell.variant == "best" and own.bound is not None:
            cards += [
                Card(number(own.flight.rms_m), "m", f"position error, {own.cell.case.name}",
                     f"{number(own.flight.rms_m / own.bound.position_m)} times the bound"),
                Card(number(own.flight.attitude_deg, 2), "deg",
                     f"attitude error, {own.cell.case.name}", "three axes, rms"),
            ]  # fmt: skip
    return cards


def _chain_cards(results: Results) -> list[Card]:
    return [
        Card(length(1e3 * own.position_m), "", "relative position, the chain",
             f"{own.runs} runs, {number(own.attitude_deg, 2)} deg")
        for own in results.chained
        if (own.variant, own.chaser) == ("best", NAVIGATED)
    ]  # fmt: skip


def _flights(outcomes: Outcomes, results: Results, main: list[Flown]) -> list[Section]:
    sections = []
    for part, case in CASES.items():
        if part not in results.flights:
            continue
        cells = outcomes.plan.flights(part)
        where, turned = figures.names_of(case)
        sections.append(
            Section(
                f"{case.name}: {where} and {turned}",
                text=LEFT_OUT,
                figures=(
                    Figure(
                        svg_address(figures.position_figure(outcomes, cells)),
                        f"{where}: position errors",
                        f"{figures.SHOWN_RUNS} runs on inertial axes; grey: three sigmas of the "
                        "posterior Cramér-Rao bound.",
                    ),
                    Figure(
                        svg_address(figures.attitude_figure(outcomes, cells)),
                        f"{turned}: attitude errors",
                    ),
                    Figure(
                        svg_address(figures.consistency_figure(outcomes, cells)),
                        "NEES over time",
                    ),
                ),
            )
        )
    if main:
        sections.append(
            Section(
                "Errors and bounds",
                text="Root mean square over runs and time. The bound knows the variant's own model "
                "and the sensors' true noise.",
                tables=(
                    TitledTable("Errors and bounds", _bounds(outcomes, main), wide=True),
                    TitledTable("Consistency", tables.consistency_table(main), True, True),
                ),
                note="NEES over its degrees of freedom: 1 is honest. Inside: share of instants at "
                "which the mean over the runs is where an honest filter's is 95 times in 100.",
            )
        )
    return sections


def _others(outcomes: Outcomes, results: Results) -> list[Section]:
    sections = []
    for part, title, text in (
        ("model", "Truth drawn from the filter's own model",
         "Here the bound is exact, and a filter that is right is honest."),
        ("lasting", "Errors of ranges that last",
         "Ephemeris and clock for two hours, the ionosphere for ten minutes, as large as Table 3 "
         "has them. The bound estimates them; so does best. The paper variant takes them as new at "
         "every epoch."),
    ):  # fmt: skip
        flown = results.flights.get(part, ())
        if flown:
            sections.append(
                Section(
                    title,
                    text=text,
                    tables=(
                        TitledTable(title, _bounds(outcomes, flown), wide=True),
                        TitledTable("Consistency", tables.consistency_table(flown), True, True),
                    ),
                )
            )
    if "mask" in results.flights:
        masked = results.flights.get("geo", ())
        cells = [own.cell for own in (*masked, *results.flights["mask"])]
        table = with_runs(
            tables.mask_table(masked, results.flights["mask"]),
            [dict.fromkeys((2, 3, 4), flight_runs(outcomes, cell)) for cell in cells],
        )
        sections.append(
            Section(
                "GEO without the mask",
                text="Signals that graze the ionosphere come tens of metres late.",
                tables=(TitledTable("With and without the mask", table),),
            )
        )
    if results.counted:
        sections.append(
            Section(
                "Satellites: Figures 9 and 10",
                text="The receive antenna's gain is not printed. In GEO it decides: the side lobes "
                "of the transmitters are a plateau, which rises above the sensitivity between 6 "
                "and 9 dBi.",
                figures=(
                    Figure(
                        svg_address(figures.availability_figure(outcomes)),
                        "Figures 9 and 10: satellites over time",
                    ),
                ),
                tables=(TitledTable("Satellites", tables.availability_table(results.counted)),),
            )
        )
    if results.faults:
        cells = outcomes.plan.flights("faults")
        rows = [dict.fromkeys((3, 4), flight_runs(outcomes, cell)) for cell in cells]
        sections.append(
            Section(
                "Faults",
                text="LEO, best; each fault begins at 200 s.",
                figures=(
                    Figure(
                        svg_address(figures.fault_figure(outcomes, cells)),
                        "Errors through faults",
                    ),
                ),
                tables=(
                    TitledTable(
                        "Faults", with_runs(tables.fault_table(results.faults), rows), True
                    ),
                ),
            )
        )
    if results.diagnosed:
        sections.append(
            Section(
                "What the diagnostics are worth",
                text="Figure 1's integrity outputs, counted: ranges and star frames are left out "
                "beyond five sigmas, a satellite is called a liar when most of its last epochs "
                "were; the protection level is 5.33 stated sigmas an axis, exceeded once in ten "
                "million by an honest Gaussian error. The paper variant edits nothing.",
                tables=(
                    TitledTable(
                        "False alarms and missed detections",
                        diagnosed_table(results.diagnosed),
                        wide=True,
                    ),
                ),
            )
        )
    if results.surveyed:
        sections.append(_stars(results, outcomes.plan.sizes.seed))
    if results.chained:
        sections.append(_chain(outcomes, results))
    if results.sampled is not None:
        sections.append(
            Section(
                "100 Hz, and gyroscope samples summed between star frames",
                text="The same run, the same samples.",
                tables=(TitledTable("Sampling", tables.sampling_table(results.sampled)),),
            )
        )
    return sections


def _chain(outcomes: Outcomes, results: Results) -> Section:
    shown = {variant: outcomes.chain(variant, NAVIGATED)[0] for variant in VARIANTS}
    return Section(
        "The chain: absolute navigation feeds relative navigation, Figures 11 and 12",
        text="XMM 30 m ahead, turning at 1 deg/s about x; corners with the noise of Pesce et al. "
        "2019, 1 Hz. The chaser navigates for itself, from a minute before, or knows "
        "its state; both see the same corners. The paper's attitude error stays below "
        f"{PAPER_DEG:g} deg.",
        figures=(Figure(svg_address(chain_figure(shown)), "Figures 11 and 12: relative errors"),),
        tables=(TitledTable("Navigated and true chasers", _chained(outcomes, results), wide=True),),
        note="Errors after the first fifth of each run, root mean square. NEES over six.",
    )


def _stars(results: Results, seed: int) -> Section:
    return Section(
        "A star sensor that sees",
        text="Star images of 20 deg: stars to magnitude 6.5, the sky, the Sun's light past the "
        "baffle, particles, hot pixels. Each is identified by itself, without a prior, and solved; "
        "a frame that is not sure is refused. The bound is that of all stars' places in a frame.",
        figures=(
            Figure(
                svg_address(star_figure.star_figure(seed)),
                "A star frame, its identified stars circled",
                f"The first attitude of: {star_figure.SHOWN_SKY}. The names are the stars' numbers "
                "in the Hipparcos catalogue.",
            ),
        ),
        tables=(
            TitledTable("Attitudes without a prior", star_tables.survey_table(results.surveyed),
                        wide=True, heading=True),
            TitledTable("The filter on star images, LEO, best",
                        star_tables.star_flight_table(results.flights["stars"]),
                        wide=True, heading=True),
        ),
        note="Wrong: further off than 100 arcsec about any axis. What limits sensors of this class "
        "in flight, a calibration that drifts, is not simulated.",
    )  # fmt: skip
