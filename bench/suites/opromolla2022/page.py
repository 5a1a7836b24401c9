"""The page of the suite, of the house's parts: the paper's tables and figures with ours beside."""

from __future__ import annotations

from collections.abc import Sequence as Many
from pathlib import Path
from typing import Any

from bench.report.numbers import number
from bench.report.page import Page, write_page
from bench.report.parts import Card, Figure, Section, TitledTable
from bench.report.plot import svg_address
from bench.report.run_table import RunTable, with_runs
from bench.report.table import Table
from bench.suites.opromolla2022 import figures, tables
from bench.suites.opromolla2022.asked_tables import counts_asked, parameters_asked, tally
from bench.suites.opromolla2022.cases import Sequence
from bench.suites.opromolla2022.results import FlownSequence, Outcomes, Results
from bench.suites.opromolla2022.runs import runs_of
from bench.suites.told_settings import told_settings

SHARED = (
    "All runs of a sequence share its rendered frames; each has its own first pose, calibration, "
    "survey of the markers, and its own detector noise round the markers. Elsewhere in the image, "
    "and in what light itself errs by, they are alike: so the mean over the runs does not shrink "
    "as with frames of their own. Exposure times are those of one plan for all runs."
)
TABLES = {
    12: "Table 12: seven Suns",
    14: "Table 14: twice the prior's error",
    15: "Table 15: two and three pixels of calibration error",
    16: "Table 16: markers installed wrongly",
    17: "Table 17: the eye-in-hand camera, Sun behind the target",
    18: "Table 18: twice the prior's error",
    19: "Table 19: two and three pixels of calibration error",
    20: "Table 20: markers installed wrongly",
}
FIGURES = {
    "S1": 13, "S7": 15, "I": 17, "C1": 18, "C2": 18, "M1": 19, "E-SB": 20, "E-I": 23, "E-C1": 25,
    "E-C2": 25, "E-M1": 26,
}  # fmt: skip
CENTROID_FIGURES = {"S3": 14, "S7": 16, "E-SB": 21}
Behind = dict[Sequence, dict[str, RunTable]]
SENSITIVITY_TEXT = (
    "Each error by itself, next to exact knowledge (none: everything told as it is, and the first "
    "pose to a twentieth of Table 5), those of Table 5 and all together (realistic). A mission "
    "knows the sigma of each, and so do the pipelines. Lamps and lens drift on the rendered side: "
    "nobody is told but of their sigmas. The camera's mount moves the pose of what carries it; a "
    "stamp that is late is judged by where the target was when the stamp says."
)


ASKED_TEXT = (
    "Of best, in each sequence and under each error: what was found, and what it may be at most. "
    "Not judged: means of a single run, and intervals from fewer than six frames or runs."
)


def write_suite_page(
    path: Path, outcomes: Outcomes, results: Results, settings: dict[str, Any]
) -> Path:
    """Write ``suite.html``.

    Parameters
    ----------
    path : Path
    outcomes : Outcomes
        For the figures, which draw every frame.
    results : Results
    settings : dict
        What was run.

    Returns
    -------
    Path
        The file.
    """
    flown = results.sequences
    behind = {own.sequence: runs_of(outcomes, own.sequence) for own in flown}
    for studied in results.studies.values():
        behind |= {own.sequence: runs_of(outcomes, own.sequence) for own in studied}
    after = [
        *_asked(results),
        *_tables(flown),
        *_hidden(flown, behind),
        *_sensitivity(results, behind),
        *_map(results),
        *_figures(outcomes, flown),
    ]
    write_page(
        path,
        Page(
            title="Opromolla et al. 2022",
            heading="Fiducial markers, two cameras",
            lead="Opromolla et al. 2022: retroreflectors before the chaser's camera, white dots "
            "before the one in the arm's hand; the paper's sequences, and errors beyond them",
            label="best",
            cards=_cards(results),
            headline_title="Best beside the paper's algorithm, on the same frames",
            headline=_headline(flown, behind),
            after=after,
            facts=told_settings(settings),
            explained=True,
        ),
    )
    return path


def _headline(flown: Many[FlownSequence], behind: Behind) -> Table:
    rows = [
        {
            column: behind[own.sequence][variant]
            for variant, columns in (("best", (1, 3, 5)), ("paper", (2, 4, 6)))
            for column in columns
        }
        for own in flown
    ]
    return with_runs(tables.headline_table(flown), rows)


def _frames(flown: Many[FlownSequence], behind: Behind, by_runs: bool = False) -> Table:
    rows = [
        dict.fromkeys((2, 4, 5, 7, 8), behind[own.sequence][variant])
        for own in flown
        for variant in tables.SHOWN
    ]
    return with_runs(tables.frame_table(flown, by_runs), rows)


def _cards(results: Results) -> list[Card]:
    cards = []
    for name, studied in results.studies.items():
        own = next((each for each in studied if each.sequence.errors == "realistic"), None)
        if own is not None and own.per_frame["best"].position_mm:
            best = own.per_frame["best"]
            cards.append(
                Card(number(best.position_mm[2]), "mm", f"position rms, {name}, realistic errors",
                     f"attitude {number(best.attitude_deg[2])} deg, {best.lost} frames lost")
            )  # fmt: skip
    held, judged = tally(results)
    if judged:
        cards.append(Card(f"{held} of {judged}", "", "of what is asked of best holds",
                          "line by line below"))  # fmt: skip
    if results.suns:
        green = sum(own.verdicts["best"].colour == "green" for own in results.suns)
        cards.append(Card(f"{green} of {len(results.suns)}", "", "Suns with all dots to the end",
                          "best, Figure 22"))  # fmt: skip
    return cards


def _asked(results: Results) -> list[Section]:
    return [
        Section(
            "What is asked",
            text=ASKED_TEXT,
            tables=(
                TitledTable("Each pose parameter", parameters_asked(results), True, True),
                TitledTable("Frames, centroids and covariances", counts_asked(results), True, True),
            ),
        )
    ]


def _tables(flown: Many[FlownSequence]) -> list[Section]:
    found = []
    for table, title in TABLES.items():
        own = [each for each in flown if each.sequence.table == table]
        if own:
            found.append(TitledTable(title, tables.paper_table(own), wide=True, heading=True))
    if not found:
        return []
    centroids = TitledTable(
        "Table 13: centroid errors of run 0", tables.centroid_table(flown), True, True
    )
    return [Section("The paper's tables", text=SHARED, tables=(*found, centroids))]


def _hidden(flown: Many[FlownSequence], behind: Behind) -> list[Section]:
    if not flown:
        return []
    return [
        Section(
            "Frame by frame",
            text="The paper's sigma is that of a mean over a hundred runs; this is what a user of "
            "one run meets.",
            tables=(TitledTable("Frame by frame", _frames(flown, behind), wide=True),),
            note="Inside: share of the instants at which the mean NEES over the runs is where an "
            "honest covariance's is 95 times in 100. Best / paper: over the six parameters, with "
            "the 95 % interval of the worst, frames redrawn in blocks.",
        )
    ]


def _sensitivity(results: Results, behind: Behind) -> list[Section]:
    return [
        Section(
            f"Sensitivity: {name}",
            text=SENSITIVITY_TEXT,
            figures=(
                Figure(svg_address(figures.sensitivity_figure(studied)), f"Sensitivity of {name}"),
            ),
            tables=(
                TitledTable(f"{name} under each error", _frames(studied, behind, True), True),
                TitledTable(
                    "Root mean square of each parameter",
                    tables.rms_table(studied),
                    True,
                    True,
                    True,
                ),
            ),
            note=f"{studied[0].per_frame['best'].runs} runs each; intervals redraw runs.",
        )
        for name, studied in results.studies.items()
    ]


def _map(results: Results) -> list[Section]:
    if not results.suns:
        return []
    return [
        Section(
            "Figure 22: the map of Suns",
            text="One run under each Sun. Elevation is from the orbital plane, azimuth in it; 90 "
            "and 0 is straight behind the chaser. A frame has all dots where truth has at least "
            "90 % of each lit and seen; in such a frame a pose is missed if there is none. In the "
            "others the published pipeline has no pose to find, and best one where the board's "
            "outline makes it observable. Wrong: beyond 5 cm or 5 deg, and beyond what its "
            "covariance allows.",
            figures=(
                Figure(
                    svg_address(figures.sun_figure(results.suns)),
                    "Figure 22",
                    "Beneath a Sun, where frames are lost or the outline helped: poses of how many "
                    "frames, and in brackets those by the outline.",
                ),
            ),
            tables=(
                TitledTable("What holds", tables.sun_rule_table(results.suns), wide=True),
                TitledTable("Each Sun", tables.sun_table(results.suns), wide=True, folded=True),
            ),
        )
    ]


def _figures(outcomes: Outcomes, flown: Many[FlownSequence]) -> list[Section]:
    sections = []
    for own in flown:
        name = own.sequence.name
        like = f", as Figure {FIGURES[name]}" if name in FIGURES else ""
        drawn = [
            Figure(
                svg_address(figures.band_figure(outcomes, own.sequence)),
                f"{name}: pose errors",
                f"Mean over {own.per_frame['best'].runs} runs and three sigmas of them{like}.",
            )
        ]
        if name in CENTROID_FIGURES:
            drawn.append(
                Figure(
                    svg_address(figures.centroid_figure(outcomes, own.sequence)),
                    f"{name}: centroid errors",
                    f"Each marker, run 0, as Figure {CENTROID_FIGURES[name]}; dotted: the paper's "
                    "standard deviation.",
                )
            )
        sections.append(Section(f"{name} over time", figures=tuple(drawn)))
    return sections
