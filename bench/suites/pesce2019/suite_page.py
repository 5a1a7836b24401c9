"""The page of a suite: tables beside the paper's, figures, consistency and failures, all in it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jinja2

from bench.report.explorer.inlined import policy
from bench.report.numbers import count, number, share
from bench.report.parts import Card
from bench.report.plot import svg_address
from bench.report.table import Table
from bench.suites.pesce2019 import suite_figures, suite_tables
from bench.suites.pesce2019.cases import case, published
from bench.suites.pesce2019.comparison import Compared, table5_note
from bench.suites.pesce2019.results import AcquiredCase, Outcomes, Results, TrackedCell
from models.atomic_file import write_text
from models.camera import camera_preset
from models.spacecraft.wireframes import wireframe_by_name

TEMPLATE = "suite_page.html.jinja"
STYLES = Path(__file__).parents[2] / "report"
VINAG_DEG = 3.0  # VINAG 2018, section 5.2: below it throughout
TARGETS = ("1", "5")  # the cases whose targets are listed: XMM and Hispasat


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
        For the figures, which draw every frame.
    results : Results
    cells : list of Compared
    settings : dict
        What was run, to be listed.

    Returns
    -------
    Path
        The file.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([Path(__file__).parent, STYLES]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    text = environment.get_template(TEMPLATE).render(_context(outcomes, results, cells, settings))
    write_text(path, text)
    return path


def _context(
    outcomes: Outcomes, results: Results, cells: list[Compared], settings: dict[str, Any]
) -> dict[str, Any]:
    sizes = outcomes.plan.sizes
    tracked = suite_tables.every_cell(results)
    return {
        "policy": policy(()),
        "sizes": sizes,
        "frames": sizes.frames,
        "camera": camera_preset(settings["camera"]),
        "cards": _cards(results, cells),
        "table5": _table5(results.table5, cells),
        "table5_notes": [table5_note(own) for own in results.table5],
        "table6": _tracking_table(results.table6, cells, "table6"),
        "table7": _tracking_table(results.table7, cells, "table7"),
        "table8": _tracking_table(results.table8, cells, "table8"),
        "vinag": results.vinag,
        "vinag_verdicts": _vinag(results.vinag),
        "filters": suite_tables.filter_table(tracked, "steady") if tracked else None,
        "windows": suite_tables.window_table(tracked) if tracked else None,
        "consistency": suite_tables.consistency_table(tracked, "steady") if tracked else None,
        "failures": suite_tables.failure_table(results),
        "explained": [cell for cell in cells if cell.explanation is not None],
        "figures": _figures(outcomes, results),
        "targets": _targets(),
        "settled": published()["settled"],
        "settings": settings,
    }


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


def _table5(cases: tuple[AcquiredCase, ...], cells: list[Compared]) -> dict[str, Table] | None:
    if not cases:
        return None
    return {
        "beside": suite_tables.cell_table(cells, "table5"),
        "all": suite_tables.acquisition_table(cases),
    }


def _tracking_table(
    tracked: tuple[TrackedCell, ...], cells: list[Compared], name: str
) -> Table | None:
    return suite_tables.cell_table(cells, name) if tracked else None


def _vinag(tracked: TrackedCell | None) -> list[str]:
    """Say of each variant whether the attitude error stays below 3 deg from 50 s on."""
    if tracked is None:
        return []
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


def _figures(outcomes: Outcomes, results: Results) -> dict[str, str]:
    figures = {}
    if results.table5:
        figures["acquisition"] = suite_figures.acquisition_figure(outcomes)
    if results.table6:
        figures["filter"] = suite_figures.filter_figure(outcomes)
        figures["mean"] = suite_figures.mean_error_figure(outcomes)
        figures["consistency"] = suite_figures.consistency_figure(outcomes)
    return {name: svg_address(svg) for name, svg in figures.items()}


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
