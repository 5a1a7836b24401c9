"""The page of the suite, of the house's parts: tables beside the paper's, figures, consistency."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from bench.report.numbers import count, number, share
from bench.report.page import Page, write_page
from bench.report.parts import Card, Figure, Section, TitledTable
from bench.report.plot import svg_address
from bench.report.run_table import with_runs
from bench.report.table import Table
from bench.suites.pesce2019 import suite_figures, suite_tables
from bench.suites.pesce2019.cases import case, published
from bench.suites.pesce2019.comparison import Compared, table5_note
from bench.suites.pesce2019.plan import Sizes
from bench.suites.pesce2019.results import AcquiredCase, Outcomes, Results, TrackedCell
from bench.suites.pesce2019.runs import RunsOfCells, runs_of_cells
from bench.suites.told_settings import told_settings
from models.camera import camera_preset
from models.spacecraft.wireframes import wireframe_by_name

VINAG_DEG = 3.0  # VINAG 2018, section 5.2: below it throughout
TARGETS = ("1", "5")  # the cases whose targets are listed: XMM and Hispasat
POINTS = (
    "Both variants get the same points. All landmarks are projected, those behind the target too, "
    "as in the paper; corners are shaken by Gaussian noise, outliers are uniform in the rectangle "
    "about the target, nothing is named and the order is mixed. The chaser's orbit is known to "
    "10 m and 0.1 m/s per axis, drawn anew for every frame."
)
ACQUIRED_NOTE = (
    "Wrong is more than 10 deg or 1 m. Of those, symmetric are the ones at a pose that the "
    "target's own symmetry makes alike. Times are of one core, and the paper's of its authors' "
    "MATLAB: they do not compare. The figure has every acquisition, wrong ones too: what the "
    "paper's Figure 4 shows run by run."
)
BETWEEN_TEXT = (
    "Root mean square over the last {end_s:.0f} s. A filter that is worth its name is better than "
    "the poses it takes; none can be better than the recursive Cramér–Rao bound of a filter that "
    "knows motion and inertia exactly. A pose over its own bound is 1 for the best that one image "
    "allows."
)
CONSISTENCY_TEXT = (
    "NEES and NIS over their degrees of freedom: 1 is honest, above is overconfident. Errors of "
    "one run hang together over time, those of different runs do not, so each instant is judged "
    "over the runs: inside is the share of instants at which the mean over the runs lies where an "
    "honest filter's lies 95 times in 100. What an H-infinity or a minimum-energy filter states is "
    "a bound or a gain, not a covariance: its row is no verdict. NIS is computed from the "
    "estimate's own pose and state, and has a dash where the pose's covariance is not what the "
    "filter took for it."
)


def write_suite_page(
    path: Path,
    outcomes: Outcomes,
    results: Results,
    cells: list[Compared],
    settings: dict[str, Any],
) -> Path:
    """Write ``suite.html``.

    Parameters
    ----------
    path : Path
    outcomes : Outcomes
        For figures and runs, which tell of every frame.
    results : Results
    cells : list of Compared
    settings : dict
        What was run, to be listed.

    Returns
    -------
    Path
        The file.
    """
    sizes, behind = outcomes.plan.sizes, runs_of_cells(outcomes, results)
    write_page(
        path,
        Page(
            title="Pesce et al. 2019",
            heading="An uncooperative target from corners, on points",
            lead=_lead(sizes),
            label="best",
            cards=_cards(results, cells),
            headline_title="How the paper's cells stand",
            headline=suite_tables.standing_table(cells),
            before=[Section("What both get", text=POINTS)],
            after=[
                *_acquisition(outcomes, results, cells, behind),
                *_tracking(outcomes, results, cells, behind),
                *_vinag_section(results, outcomes),
                Section(
                    "Where the paper variant is off by more than a factor of two",
                    tables=(TitledTable("Explanations", suite_tables.why_table(cells),
                                        prose=True),),
                    nothing="Nowhere.",
                ),
                *_filters(outcomes, results, behind),
            ],
            facts=_facts(settings),
            explained=True,
        ),
    )  # fmt: skip
    return path


def _lead(sizes: Sizes) -> str:
    fewer = ""
    if sizes.paper_runs:
        fewer = f"; of the paper variant, which takes far longer, at most {sizes.paper_runs} each"
    return (
        "Pesce et al. 2019, Tables 5 to 8, and VINAG's relative case: "
        f"{sizes.acquisitions} acquisitions a case, {sizes.runs} runs of {sizes.duration_s:g} s a "
        f"case of Table 6, {sizes.seeds} a cell elsewhere, at 1 Hz{fewer}"
    )


def _cards(results: Results, cells: list[Compared]) -> list[Card]:
    judged = [cell for cell in cells if "std" not in cell.quantity]
    below = sum(cell.best_verdict == "at or below" for cell in judged)
    near = sum(cell.paper_verdict == "within two" for cell in judged)
    ratios = [cell.best_ratio for cell in judged if cell.best_ratio is not None]
    cards = [
        Card(f"{below} of {len(judged)}", "cells", "best at or below the paper's figure",
             f"the largest ratio is {number(max(ratios, default=None))}"),
        Card(f"{near} of {len(judged)}", "cells", "paper variant within a factor of two",
             "the others are explained below"),
    ]  # fmt: skip
    if results.table5:
        runs = sum(own.whole["best"].runs for own in results.table5)
        wrong = sum(own.whole["best"].wrong for own in results.table5)
        slowest = max(own.seconds["best"][0] for own in results.table5)
        cards += [
            Card(f"{wrong} of {runs}", "runs", "acquisitions of best that are wrong",
                 "by more than 10 deg or 1 m"),
            Card(number(slowest), "s", "time to acquire, best, on one core",
                 "mean of the slowest case"),
        ]  # fmt: skip
    if results.table6:
        states = sum(own.settled["best"].frames for own in results.table6)
        lost = sum(own.settled["best"].no_state * own.settled["best"].frames
                   for own in results.table6)  # fmt: skip
        cards.append(
            Card(share(lost / states), "", "frames without a state, best, Table 6",
                 f"{count(states)} frames")
        )  # fmt: skip
    return cards


def _acquisition(
    outcomes: Outcomes, results: Results, cells: list[Compared], behind: RunsOfCells
) -> list[Section]:
    if not results.table5:
        return []
    most = min(outcomes.plan.sizes.acquisitions, 100)
    return [
        Section(
            "Table 5: acquisition without a prior pose",
            text=f"Mean and standard deviation of the error over the first {most} runs, at moments "
            "of the tumble drawn at random; noise of 1 px and one outlier. "
            + " ".join(map(table5_note, results.table5)),
            figures=(_figure(suite_figures.acquisition_figure(outcomes),
                             "Share of acquisitions better than an error"),),
            tables=(
                TitledTable("Table 5", suite_tables.cell_table(cells, "table5", behind.by_row)),
                TitledTable("All acquisitions", _all_acquisitions(results.table5, behind),
                            wide=True, heading=True),
            ),
            note=ACQUIRED_NOTE,
        )
    ]  # fmt: skip


def _all_acquisitions(cases: tuple[AcquiredCase, ...], behind: RunsOfCells) -> Table:
    runs = [behind.acquired[own.case.key][v] for own in cases for v in suite_tables.SHOWN]
    columns = suite_tables.ACQUIRED_OF_RUNS
    return with_runs(
        suite_tables.acquisition_table(cases), [dict.fromkeys(columns, own) for own in runs]
    )


def _tracking(
    outcomes: Outcomes, results: Results, cells: list[Compared], behind: RunsOfCells
) -> list[Section]:
    sizes, sections = outcomes.plan.sizes, []
    if results.table6:
        sections.append(
            Section(
                "Table 6: tracking and filter",
                text=f"Root mean square over the last {_end_s(sizes):.0f} s and all {sizes.runs} "
                "runs, noise of 2 px, one outlier; each run starts from the truth with an error "
                "drawn from the paper's Table 5, its rates unknown.",
                figures=(
                    _figure(suite_figures.filter_figure(outcomes),
                            "Figure 5: with and without the filter, case 1, run 0"),
                    _figure(suite_figures.mean_error_figure(outcomes),
                            "Figure 6: mean errors of the three LEO cases"),
                ),
                tables=(TitledTable("Table 6", suite_tables.cell_table(
                    cells, "table6", behind.by_row)),),
            )
        )  # fmt: skip
    for name, title, text, there in (
        ("table7", "Table 7: noise",
         "Case 1, root mean square from 50 s on. The paper has one run a cell; these are "
         f"{sizes.seeds}, with the same starts and the same noise but for its size. The corner "
         "noise is known to the pipeline.", results.table7),
        ("table8", "Table 8: outliers",
         f"Case 1, 2 px, root mean square from 50 s on; {sizes.seeds} runs a cell.",
         results.table8),
    ):  # fmt: skip
        if there:
            own = TitledTable(title, suite_tables.cell_table(cells, name, behind.by_row))
            sections.append(Section(title, text=text, tables=(own,)))
    return sections


def _vinag_section(results: Results, outcomes: Outcomes) -> list[Section]:
    if results.vinag is None:
        return []
    return [
        Section(
            "VINAG's relative case",
            text="A circular orbit of 7158 km, XMM at 30 m, 1 deg/s about its long axis, "
            f"{outcomes.plan.sizes.seeds} runs. VINAG 2018 reports an attitude error below "
            "3 deg throughout. " + " ".join(_vinag(results.vinag)),
        )
    ]


def _vinag(tracked: TrackedCell) -> list[str]:
    """Say of each variant whether the attitude error stays below 3 deg from 50 s on."""
    said = []
    for variant in suite_tables.SHOWN:
        one = tracked.settled[variant]
        largest = one.largest_attitude_deg
        if largest is None:
            said.append(f"{variant}: no state at all.")
            continue
        held = "stays" if largest < VINAG_DEG and one.no_state == 0.0 else "does not stay"
        said.append(
            f"{variant} {held} below {VINAG_DEG:g} deg from 50 s on in {one.runs} runs: the "
            f"largest error is {number(largest)} deg, the rms {number(one.attitude_deg)} deg and "
            f"{number(one.position_m)} m; {share(one.no_state)} of the frames have no state."
        )
    return said


def _filters(outcomes: Outcomes, results: Results, behind: RunsOfCells) -> list[Section]:
    tracked = suite_tables.every_cell(results)
    if not tracked:
        return []
    figures: tuple[Figure, ...] = ()
    if results.table6:
        figures = (_figure(suite_figures.consistency_figure(outcomes), "NEES over time"),)
    return [
        Section(
            "The filter between its poses and its bound",
            text=BETWEEN_TEXT.format(end_s=_end_s(outcomes.plan.sizes)),
            tables=(
                TitledTable("Filters and bounds", suite_tables.filter_table(tracked, "steady"),
                            wide=True),
            ),
        ),
        Section(
            "Consistency",
            text=CONSISTENCY_TEXT,
            figures=figures,
            tables=(
                TitledTable("Consistency", suite_tables.consistency_table(tracked, "steady"),
                            wide=True),
            ),
        ),
        Section(
            "Both windows, every error",
            tables=(TitledTable("Both windows", _windows(tracked, behind), wide=True),),
        ),
        Section(
            "Frames without a pose",
            tables=(
                TitledTable("Frames without a pose", suite_tables.failure_table(results),
                            prose=True),
            ),
            nothing="None.",
        ),
    ]  # fmt: skip


def _windows(tracked: list[TrackedCell], behind: RunsOfCells) -> Table:
    rows = [
        dict.fromkeys(suite_tables.WINDOW_OF_RUNS, behind.tracked[title][window, variant])
        for title in (suite_tables.cell_title(own.cell) for own in tracked)
        for variant in suite_tables.SHOWN
        for window in suite_tables.WINDOWS
    ]
    return with_runs(suite_tables.window_table(tracked), rows)


def _end_s(sizes: Sizes) -> float:
    return sizes.duration_s * 1000.0 / 1800.0


def _figure(svg: str, alt: str) -> Figure:
    return Figure(svg_address(svg), alt, f"{alt}.")


def _facts(settings: dict[str, Any]) -> list[tuple[str, str]]:
    camera = camera_preset(settings["camera"])
    facts = [
        ("camera", f"{camera.width} × {camera.height} px, focal length {camera.fx:.2f} px"),
        *(("target", line) for line in _targets()),
        *((f"settled: {key}", str(value)) for key, value in published()["settled"].items()),
    ]
    facts += told_settings(settings)
    return [*facts, ("every step of every run", "units, as NumPy archives; numbers: suite.json")]


def _targets() -> list[str]:
    said = []
    for key in TARGETS:
        target = wireframe_by_name(case(key).target)
        turns = len(target.symmetries)
        alike = f"{turns} symmetries" if turns > 1 else "one symmetry" if turns else "no symmetry"
        said.append(
            f"{target.name}: {len(target)} landmarks, {int(target.appendage.sum())} of them on "
            f"appendages, {alike}, {number(target.radius_m)} m from the centre of mass to the "
            "outermost"
        )
    return said
