"""The page of the study: counts, maps, how honest the claims were, and a dozen frames."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from bench.report.numbers import count, number, share
from bench.report.page import Page, write_page
from bench.report.parts import Card, Figure, Section, TitledTable
from bench.report.plot import svg_address
from bench.report.run_table import RunTable, with_runs
from bench.report.table import TITLES, Table
from bench.suites.told_settings import told_settings
from bench.suites.uncooperative_suns.cases import IMAGES
from bench.suites.uncooperative_suns.figures import bar_figure, outcome_map, reliability_figure
from bench.suites.uncooperative_suns.frame_pictures import MARKED, frame_pictures
from bench.suites.uncooperative_suns.plan import Plan
from bench.suites.uncooperative_suns.results import (
    LIT_EDGES,
    LIT_ENOUGH,
    PHASE_EDGES_DEG,
    SHARE_EDGES,
    WRONG_DEG,
    WRONG_SHARE,
    Counts,
    Starts,
    Summary,
    bin_places,
)
from bench.suites.uncooperative_suns.runs import found_runs, refused_runs

LEADS = "best"
MOST_REASONS = 8
TERMS = {
    "found": "Starts that ended with a pose that is not wrong.",
    "wrong": f"Poses off by more than {WRONG_DEG:g} deg, the target's symmetries aside, or by more "
    f"than {100 * WRONG_SHARE:g} % of the range.",
    "refused": "Starts without a pose, each with a reason.",
}


def write_suite_page(
    path: Path,
    plan: Plan,
    results: dict[str, dict[str, Starts]],
    summaries: dict[str, dict[str, Summary]],
    settings: dict[str, Any],
) -> Path:
    """Write ``suite.html``.

    Parameters
    ----------
    path : Path
    plan : Plan
    results, summaries : dict
        By target and variant.
    settings : dict
        What was run.

    Returns
    -------
    Path
        The file.
    """
    leading = {target: own[LEADS] for target, own in summaries.items()}
    sections = [
        Section(
            "How honest the claims are",
            text="A pose comes with the probability that it is another than the true one. Claims "
            "of about one probability stand together, the share that was wrong with its 95 % "
            "interval; on the line what was told holds.",
            figures=(
                Figure(
                    svg_address(reliability_figure(leading)), "Share wrong against what was told"
                ),
            )
            if _claims(leading).rows
            else (),
            tables=(TitledTable("Claims", _claims(leading)),),
            nothing="No pose was claimed: there is nothing to hold against what was told.",
        )
    ]
    for target, own in results.items():
        sections.append(_target(target, own, summaries[target]))
    write_page(
        path,
        Page(
            title="Under any Sun",
            heading="An uncooperative target under any Sun, at any attitude",
            lead=f"Starts without a prior: attitudes even over all, Suns at phase angles of 0 to "
            f"170 deg, the target a quarter to a twentieth of the field across, half of them with "
            f"the Earth's light; up to {IMAGES} metered images of a motion of 0.1 to 3 deg/s, 1 to "
            "20 s apart.",
            label=LEADS,
            cards=_cards(leading),
            headline_title="How starts ended",
            headline=_counts(results, summaries),
            after=sections,
            frames=frame_pictures(plan, {t: own[LEADS] for t, own in results.items()}),
            marks=MARKED,
            facts=told_settings(settings),
            explained=True,
        ),
    )
    return path


def _cards(leading: dict[str, Summary]) -> list[Card]:
    every = [one.every for one in leading.values()]
    starts, wrong = sum(c.starts for c in every), sum(c.wrong for c in every)
    lit = [one.lit for one in leading.values()]
    return [
        Card(f"{sum(c.found for c in every)} of {starts}", "starts", "found", "of all"),
        Card(f"{sum(c.found for c in lit)} of {sum(c.starts for c in lit)}", "starts",
             "found where lit", f"{100 * LIT_ENOUGH:g} % of the silhouette above three sigmas"),
        Card(f"{wrong} of {starts}", "starts", "claimed a wrong pose", TERMS["wrong"]),
        Card(number(max(one.seconds[1] for one in leading.values())), "s", "longest start",
             "of one core"),
    ]  # fmt: skip


def _counts(
    results: dict[str, dict[str, Starts]], summaries: dict[str, dict[str, Summary]]
) -> Table:
    head = ["", "starts", "found", "at the first image", "wrong", "refused", "found where lit",
            "attitude, deg", "range, %", "s a start"]  # fmt: skip
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    for target, own in summaries.items():
        sections[len(rows)] = target
        for variant, one in reversed(own.items()):
            off = one.median_range_share
            rows.append(
                [
                    TITLES[variant], count(one.every.starts), count(one.every.found),
                    count(one.first_image), count(one.every.wrong), count(one.every.refused),
                    f"{one.lit.found} of {one.lit.starts}", number(one.median_attitude_deg),
                    number(None if off is None else 100.0 * off), number(one.seconds[0]),
                ]
            )  # fmt: skip
    behind = [
        _behind(f"{target}, {TITLES[variant]}", results[target][variant])
        for target, own in summaries.items()
        for variant in reversed(own)
    ]
    return with_runs(Table(head, rows, TERMS, sections), behind)


def _behind(title: str, starts: Starts) -> dict[int, RunTable]:
    found = found_runs(f"{title}: found", starts, starts.right)
    wrong = found_runs(f"{title}: wrong", starts, starts.wrong)
    refused = refused_runs(f"{title}: refused", starts, ~starts.claimed)
    return {**dict.fromkeys((2, 3, 7, 8), found), 4: wrong, 5: refused}


def _target(target: str, results: dict[str, Starts], summaries: dict[str, Summary]) -> Section:
    figures = []
    for variant in reversed(results):
        starts, summary = results[variant], summaries[variant]
        title = f"{target}, {TITLES[variant]}"
        figures.append(Figure(svg_address(outcome_map(starts)), f"Map of {title}", title))
        figures.append(Figure(svg_address(bar_figure(summary)), f"Counts of {title}", title))
    lead = summaries[LEADS]
    return Section(
        target,
        figures=tuple(figures),
        tables=(
            TitledTable(f"{target}: by bins, {LEADS}", _bins(target, results[LEADS], lead)),
            TitledTable(f"{target}: why starts were refused, {LEADS}", _reasons(lead), folded=True),
        ),
    )


def _bins(target: str, starts: Starts, summary: Summary) -> Table:
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    behind: list[dict[int, RunTable]] = []
    for title, edges, counted, values, factor in (
        ("phase angle, deg", PHASE_EDGES_DEG, summary.phase, starts.phase_deg, 1.0),
        ("width of the field, %", SHARE_EDGES, summary.share, starts.share, 100.0),
        ("lit share of the silhouette, %", LIT_EDGES, summary.lit_share, starts.lit, 100.0),
    ):
        sections[len(rows)] = title
        places = bin_places(values, edges)
        for place, one in enumerate(counted):
            between = f"{factor * edges[place]:g} to {factor * edges[place + 1]:g}"
            which, own = f"{target}, {title} {between}", places == place
            rows.append([between, *_cells(one)])
            behind.append(
                {
                    3: found_runs(f"{which}: wrong", starts, own & starts.wrong),
                    4: refused_runs(f"{which}: refused", starts, own & ~starts.claimed),
                }
            )
    head = ["", "starts", "found", "wrong", "refused"]
    return with_runs(Table(head, rows, {}, sections), behind)


def _cells(one: Counts) -> list[str]:
    return [count(each) for each in (one.starts, one.found, one.wrong, one.refused)]


def _claims(leading: dict[str, Summary]) -> Table:
    rows = [
        [
            target, f"{claim.least:g} to {claim.most:g}", count(claim.claims), count(claim.wrong),
            share(claim.told), f"{share(claim.low)} to {share(claim.high)}",
            "holds" if claim.holds else "does not hold",
        ]
        for target, one in leading.items()
        for claim in one.claims
    ]  # fmt: skip
    head = ["", "told", "claims", "wrong", "mean told", "95 % of what was wrong", ""]
    return Table(head, rows, {}, {})


def _reasons(summary: Summary) -> Table:
    rows = [[reason, count(times)] for reason, times in summary.reasons.items()]
    return Table(["", "starts"], rows[:MOST_REASONS], {}, {})
