"""The page of the study: what is asked and what came, every tumble, every image's belief."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure as Drawing
from matplotlib.patches import Patch

from bench.report.numbers import count, number
from bench.report.page import Page, write_page
from bench.report.parts import Card, Figure, Section, TitledTable
from bench.report.plot import drawn_svg, svg_address
from bench.report.table import TITLES, Table
from bench.suites.told_settings import told_settings
from bench.suites.uncooperative_suns.figures import FOUND, REFUSED, WRONG
from bench.suites.uncooperative_suns.results import LIT_ENOUGH, WRONG_DEG, WRONG_SHARE
from bench.suites.uncooperative_tumbles.plan import Plan
from bench.suites.uncooperative_tumbles.results import (
    HONEST_NEES,
    MOST_HELD,
    Followed,
    Summary,
)

LEADS = "best"
KINDS = (("no state", REFUSED), ("right", FOUND), ("wrong", WRONG))
ROW_IN = 0.16
TERMS = {
    "acquired": "Tumbles with a right state at some image.",
    "wrong": f"States off by more than {WRONG_DEG:g} deg, the target's symmetries aside, or by "
    f"more than {100 * WRONG_SHARE:g} % of the range.",
    "most in a row": "Most images in a row with a wrong state.",
    "NEES/n": "Of right states: mean squared error over what the covariance allows, over six; 1 "
    "is honest. Mean over tumbles.",
    "filter worse": "Tumbles in which the state's root mean square error is above that of the "
    "images' own poses, over images with both, right.",
}


def write_suite_page(
    path: Path,
    plan: Plan,
    results: dict[str, dict[str, list[Followed]]],
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
    write_page(
        path,
        Page(
            title="Tumbles",
            heading="An uncooperative target through tumbles that nobody chose",
            lead="Attitudes even over all, 0.1 to 3 deg/s about any axis, images 1 to 20 s apart, "
            "Suns at phase angles of 0 to 170 deg, the target a quarter to a twentieth of the "
            "field across, half of them with the Earth's light; "
            f"{plan.sizes.images} metered images, the first without a prior. "
            "Sun, finishes and the level of white are told, each with its "
            "error.",
            label=LEADS,
            cards=_cards(leading),
            headline_title="How tumbles went",
            headline=_counts(summaries),
            after=[
                Section(
                    "What is asked",
                    text="Of every target, of fifty tumbles: a wrong state is never held for "
                    "long, covariances are honest, and the filter is worth having.",
                    tables=(TitledTable("Asked", _asked(leading)),),
                ),
                *(_target(target, own) for target, own in results.items()),
            ],
            facts=told_settings(settings),
            explained=True,
        ),
    )
    return path


def asked_of(one: Summary) -> list[tuple[str, str, bool | None]]:
    """Return what is asked of a target, what came, and whether it holds; None where none can say.

    Parameters
    ----------
    one : Summary
    """
    low, high = HONEST_NEES
    rows: list[tuple[str, str, bool | None]] = [
        (
            f"no wrong state for more than {MOST_HELD} images",
            f"{one.held} of {one.tumbles} tumbles held one, for {one.longest_wrong} at most",
            one.held == 0,
        )
    ]
    for what in ("translation", "rotation"):
        nees: float | None = getattr(one, f"nees_{what}")
        holds = None if nees is None else low <= nees <= high
        rows.append((f"NEES/n of {what} from {low:g} to {high:g}", number(nees), holds))
    for what, (worse, of) in one.filter_worse.items():
        title = f"the filter's {what.split('_')[0]} never worse than the pose's"
        rows.append((title, f"worse in {worse} of {of}", None if not of else worse == 0))
    return rows


def _cards(leading: dict[str, Summary]) -> list[Card]:
    every = list(leading.values())
    tumbles, lit = sum(one.tumbles for one in every), sum(one.lit for one in every)
    return [
        Card(f"{sum(one.acquired for one in every)} of {tumbles}", "tumbles", "acquired",
             TERMS["acquired"]),
        Card(f"{sum(one.acquired_lit for one in every)} of {lit}", "tumbles", "acquired where lit",
             f"{100 * LIT_ENOUGH:g} % of the silhouette above three sigmas in half of the images"),
        Card(f"{sum(one.held for one in every)} of {tumbles}", "tumbles",
             f"held a wrong state for more than {MOST_HELD} images", TERMS["wrong"]),
        Card(number(max(one.seconds[1] for one in every)), "s", "longest image", "of one core"),
    ]  # fmt: skip


def _counts(summaries: dict[str, dict[str, Summary]]) -> Table:
    head = ["", "tumbles", "acquired", "acquired where lit", "images", "right", "wrong", "no state",
            "most in a row", "position, m", "attitude, deg", "NEES/n", "filter worse"]  # fmt: skip
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    for target, own in summaries.items():
        sections[len(rows)] = target
        for variant, one in reversed(own.items()):
            worse = "; ".join(f"{bad} of {of}" for bad, of in one.filter_worse.values())
            rows.append(
                [
                    TITLES[variant], count(one.tumbles), count(one.acquired),
                    f"{one.acquired_lit} of {one.lit}", count(one.images), count(one.right),
                    count(one.wrong), count(one.without), count(one.longest_wrong),
                    number(one.median_position_m), number(one.median_attitude_deg),
                    f"{number(one.nees_translation)}, {number(one.nees_rotation)}", worse,
                ]
            )  # fmt: skip
    return Table(head, rows, TERMS, sections)


def _asked(leading: dict[str, Summary]) -> Table:
    words = {True: "holds", False: "does not hold", None: "nothing to judge"}
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    for target, one in leading.items():
        sections[len(rows)] = target
        rows += [[asked, came, words[holds]] for asked, came, holds in asked_of(one)]
    return Table(["", "what came", ""], rows, {}, sections)


def _target(target: str, results: dict[str, list[Followed]]) -> Section:
    figures = tuple(
        Figure(
            svg_address(_beliefs(tumbles)),
            f"What each image of {target} believed, {TITLES[variant]}",
            f"{target}, {TITLES[variant]}: a row a tumble",
        )
        for variant, tumbles in reversed(results.items())
    )
    tables = (TitledTable(f"{target}: every tumble, {LEADS}", _tumbles(results[LEADS])),)
    return Section(target, figures=figures, tables=tables)


def _beliefs(tumbles: list[Followed]) -> str:
    """Draw every image of every tumble: no state, a right one, a wrong one, as SVG."""
    cells = np.array([np.where(one.wrong, 2, np.where(one.right, 1, 0)) for one in tumbles])

    def draw(figure: Drawing) -> None:
        axes = figure.subplots()
        colours = ListedColormap([colour for _, colour in KINDS])
        rows, images = cells.shape
        sides = (0.5, images + 0.5, rows - 0.5, -0.5)  # images count from 1
        axes.imshow(
            cells, colours, vmin=0, vmax=2, aspect="auto", interpolation="nearest", extent=sides
        )
        axes.set_xlabel("image")
        axes.set_ylabel("tumble")
        handles = [Patch(color=colour, label=name) for name, colour in KINDS]
        figure.legend(handles=handles, loc="outside lower center", ncols=len(KINDS))

    return drawn_svg(draw, (7.0, 1.4 + ROW_IN * len(tumbles)))


def _tumbles(tumbles: list[Followed]) -> Table:
    head = ["", "deg/s", "s apart", "phase angle, deg", "width of the field, %", "lit, %",
            "first right", "right", "wrong", "most in a row", "NEES/n"]  # fmt: skip
    rows = [
        [
            str(place), number(one.drawn.rate_deg_s), number(one.drawn.step_s),
            number(one.drawn.phase_deg), number(100.0 * one.drawn.share),
            number(100.0 * float(one.lit.mean())), number(one.first_right),
            count(int(one.right.sum())), count(int(one.wrong.sum())), count(one.longest_wrong),
            f"{number(one.nees('translation'))}, {number(one.nees('rotation'))}",
        ]
        for place, one in enumerate(tumbles)
    ]  # fmt: skip
    return Table(head, rows, {"wrong": TERMS["wrong"], "NEES/n": TERMS["NEES/n"]}, {})
