"""The page of the suite: the paper's tables and figures in its form, bounds, and the studies."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from bench.report.numbers import number, share
from bench.report.page import Page, write_page
from bench.report.parts import Card, Figure, Section, TitledTable
from bench.report.plot import svg_address
from bench.report.run_table import with_runs
from bench.report.table import Table
from bench.suites.volpe2017 import suite_figures, suite_tables
from bench.suites.volpe2017.cases import published
from bench.suites.volpe2017.results import Outcomes, PaperResults, Results, StudiedCase
from bench.suites.volpe2017.runs import runs_of
from bench.suites.volpe2017.summaries import ALLOWED

PAPER_TEXT = (
    "Twelve corners of a box with two panels, all seen in every image and none mistaken, a range "
    "to the centre of mass, a circular orbit of 7000 km and a closed relative one: the paper's "
    "case. Its formulas and tables are lost in the text at hand, orders of magnitude are all that "
    "its prose keeps, and what is lost was settled as listed below. Axes 1, 2, 3 of position and "
    "velocity are the paper's Hill axes (radial, normal, against the motion), of attitude, rate "
    "and inertia the body's."
)


def write_suite_page(
    path: Path, outcomes: Outcomes, results: Results, facts: Sequence[tuple[str, str]]
) -> Path:
    """Write ``suite.html``.

    Parameters
    ----------
    path : Path
    outcomes : Outcomes
        For the figures, which draw every frame.
    results : Results
    facts : sequence of (str, str)
        What was run.

    Returns
    -------
    Path
        The file.
    """
    sections = []
    if results.paper is not None:
        sections += _paper(outcomes, results.paper)
    if results.observability:
        sections.append(_observability(outcomes, results.observability))
    if results.tracks:
        sections.append(_tracks(outcomes, results.tracks))
    if results.frame_ms:
        sections.append(
            Section(
                "Time of a frame",
                text="Best, one core, images at 1 Hz, points spread over the box. The median is of "
                "frames that add to the equations, the longest of those that linearise all anew.",
                tables=(
                    TitledTable("Time of a frame", suite_tables.speed_table(results.frame_ms)),
                ),
            )
        )
    lead = suite_tables.bound_table(results.paper.summary.ends if results.paper else ())
    if results.paper is not None:
        lead = with_runs(lead, {1: runs_of(outcomes, outcomes.plan.paper_case())})
    write_page(
        path,
        Page(
            title="Volpe et al. 2017",
            heading="An unknown target, on points",
            lead="Volpe et al. 2017: position, velocity, attitude, angular velocity, shape and "
            "inertia of a target that nobody has a model of, from a camera and a range finder",
            label="best",
            cards=_cards(results),
            headline_title="Best beside what no estimator beats",
            headline=lead,
            after=sections,
            facts=[*facts, *((f"settled: {k}", v) for k, v in published()["settled"].items())],
            explained=True,
        ),
    )
    return path


def _cards(results: Results) -> list[Card]:
    cards = []
    if results.paper is not None:
        one = results.paper.summary
        held = [end for end in one.ends if end.holds]
        allowed = number(max(end.limit / end.bound for end in one.ends))
        low, high = one.nees.bounds
        cards += [
            Card(f"{len(held)} of {len(one.ends)}", "", "quantities at their bound",
                 f"within {ALLOWED:g} of it and two sampling errors: up to {allowed} of it in "
                 f"{one.runs} runs"),
            Card(number(one.last_nees), "", "NEES of the motion at the end, over 12",
                 f"95 % of honest filters: {number(low)} to {number(high)}"),
        ]  # fmt: skip
    if results.tracks:
        worst = max(results.tracks, key=lambda own: own.summary.worst_position_m)
        cards.append(
            Card(number(worst.summary.worst_position_m), "m", "worst position error, bad tracks",
                 worst.case.name)
        )  # fmt: skip
    if results.frame_ms:
        most = results.frame_ms[-1]
        cards.append(Card(number(most.mean_ms), "ms", f"a frame of {most.points} points, mean",
                          f"longest {number(most.largest_ms)} ms"))  # fmt: skip
    return cards


def _paper(outcomes: Outcomes, paper: PaperResults) -> list[Section]:
    draw = suite_figures.component_figure
    point = (
        ("first_from_chaser_m", "from the chaser, m"),
        ("first_from_centre_m", "from the centre of mass, m"),
    )
    turn = (("attitude_deg", "attitude, deg"), ("rate_deg_s", "angular velocity, deg/s"))
    place = (("position_m", "position, m"), ("velocity_m_s", "velocity, m/s"))
    figures = (
        _figure(draw(outcomes, point), "Figure 6: errors of the first point"),
        _figure(suite_figures.points_figure(outcomes), "Figure 7: points, true and estimated"),
        _figure(draw(outcomes, turn), "Figure 8: errors of attitude and angular velocity"),
        _figure(draw(outcomes, place), "Figure 9a and b: errors of position and velocity"),
        _figure(suite_figures.trajectory_figure(outcomes), "Figure 9c: the relative trajectory"),
        _figure(suite_figures.inertia_figure(outcomes), "Figure 10: errors of the inertia"),
    )
    beside = (
        _figure(suite_figures.bound_figure(outcomes), "Errors over time beside their bounds"),
        _figure(suite_figures.consistency_figure(outcomes), "NEES of the motion over time"),
    )
    return [
        Section(
            "Tables 1 and 2",
            text=PAPER_TEXT,
            tables=(
                TitledTable("Table 2: norms of errors, median over the runs",
                            _improvements(outcomes, paper), wide=True, heading=True),
                TitledTable("Table 1: errors in components at the end, run 0",
                            suite_tables.component_table(paper), wide=True, heading=True),
            ),
            note=_why(paper),
        ),
        Section("Figures 6 to 10, run 0", figures=figures),
        Section("Beside the bound", figures=beside),
    ]  # fmt: skip


def _improvements(outcomes: Outcomes, paper: PaperResults) -> Table:
    case = outcomes.plan.paper_case()
    rows = [
        {2: runs}
        for variant in suite_tables.SHOWN
        for runs in [runs_of(outcomes, case, variant)]
        for _ in paper.table2[variant]
    ]
    return with_runs(suite_tables.improvement_table(paper), rows)


def _studied(
    outcomes: Outcomes, table: Table, cases: Sequence[StudiedCase], columns: Sequence[int]
) -> Table:
    runs = [runs_of(outcomes, own.case) for own in cases]
    return with_runs(table, [dict.fromkeys(columns, each) for each in runs])


def _why(paper: PaperResults) -> str:
    """Say where and why the published filter is as it is, as measured."""
    astray, runs = paper.astray["paper"], paper.runs["paper"]
    if not astray:
        return f"The paper variant ends nearer the truth than it began in all of {runs} runs."
    return (
        f"The paper variant ends worse than it began in {astray} of {runs} runs: in the first "
        "frames depth and rate are so little known that products of their errors are larger than "
        "a pixel, its covariance shrinks all the same, and without process noise it never takes "
        "that back. Best linearises all images anew instead. Rate and inertia of the variant "
        "stop where that overconfidence left them. The scale of the inertia moves nothing that "
        "is measured: the variant carries it along, best has no such unknown."
    )


def _observability(outcomes: Outcomes, cases: tuple[StudiedCase, ...]) -> Section:
    figure = suite_figures.study_figure
    return Section(
        "What motion makes observable",
        text="Best, each beside its bound, at 1 Hz. Without a range the scale is known as well as "
        "the first guess and no better, and is told to be lost; all else is right but for it. A "
        "spin about a principal axis in a high orbit leaves ratios of the inertia open, and they "
        "are told to be lost; in a low one the gravity gradient gives them.",
        figures=(
            _figure(
                figure(outcomes, "observability", "inertia_percent", "inertia, % of the trace"),
                "Inertia over time; bounds dashed",
            ),
            _figure(
                figure(outcomes, "observability", "position_m", "position, m"),
                "Position over time; bounds dashed",
            ),
        ),
        tables=(
            TitledTable(
                "Observability",
                _studied(outcomes, suite_tables.observability_table(cases), cases, (1, 3, 5, 7)),
                wide=True,
            ),
        ),
        note="A quantity is told to be lost whose sigma is more than half of what it was before "
        "any measurement.",
    )


def _tracks(outcomes: Outcomes, cases: tuple[StudiedCase, ...]) -> Section:
    figure = suite_figures.study_figure(outcomes, "tracks", "position_m", "position, m")
    return Section(
        "Tracks and ranges that are not perfect",
        text="Best, a tumble of 1 deg/s at 1 Hz. False matches lie anywhere in the rectangle about "
        "the target; a surface range is to what the boresight meets, never to the centre of mass.",
        figures=(_figure(figure, "Position over time; bounds dashed"),),
        tables=(
            TitledTable(
                "Tracks",
                _studied(outcomes, suite_tables.track_table(cases), cases, (1, 3, 4, 6, 8)),
                wide=True,
            ),
        ),
        note="The bound knows which matches and ranges are false, and has their share less of "
        f"them. Points are counted at the end; of honest filters {share(0.95)} lie in the band.",
    )


def _figure(svg: str, alt: str) -> Figure:
    return Figure(svg_address(svg), alt, f"{alt}.")
