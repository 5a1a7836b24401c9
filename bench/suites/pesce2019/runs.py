"""What each run of a cell came to, for the tables of the page to lead to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.report.run_table import Column, RunTable, run_table
from bench.suites.consistency import root_mean_square
from bench.suites.pesce2019.comparison import row_title
from bench.suites.pesce2019.plan import RATE_HZ, Cell
from bench.suites.pesce2019.results import AcquiredCase, Outcomes, Results
from bench.suites.pesce2019.suite_tables import SHOWN, WINDOWS, cell_title, every_cell
from bench.suites.pesce2019.summaries import settled, stacked, steady

TRACKED = {"position, m": "position_m", "attitude, deg": "attitude_deg",
           "velocity, m/s": "velocity_m_s", "rate, deg/s": "rate_deg_s"}  # fmt: skip
ACQUIRED = {"attitude, deg": "attitude_deg", "position, m": "position_m",
            "nearest alike, deg": "attitude_symmetric_deg", "images": "images",
            "moment, s": "epoch_s"}  # fmt: skip


@dataclass(frozen=True)
class RunsOfCells:
    """The runs behind the tables.

    Attributes
    ----------
    tracked : dict
        By title of the cell, then by window and variant.
    acquired : dict
        By key of the case, then by variant.
    by_row : dict
        By table and row of the paper's, then by variant.
    """

    tracked: dict[str, dict[tuple[str, str], RunTable]]
    acquired: dict[str, dict[str, RunTable]]
    by_row: dict[tuple[str, str], dict[str, RunTable]]


def runs_of_cells(outcomes: Outcomes, results: Results) -> RunsOfCells:
    """Read the runs behind all tables.

    Parameters
    ----------
    outcomes : Outcomes
    results : Results
    """
    tracked = {cell_title(own.cell): _tracked(outcomes, own.cell) for own in every_cell(results)}
    acquired = {own.case.key: _acquired(outcomes, own) for own in results.table5}
    by_row = {
        ("table5", row_title("table5", own)): acquired[own.case.key] for own in results.table5
    }
    for table, cells, window in (
        ("table6", results.table6, "steady"),
        ("table7", results.table7, "settled"),
        ("table8", results.table8, "settled"),
    ):
        for one in cells:
            found = tracked[cell_title(one.cell)]
            by_row[table, row_title(table, one)] = {v: found[window, v] for v in SHOWN}
    return RunsOfCells(tracked, acquired, by_row)


def _tracked(outcomes: Outcomes, cell: Cell) -> dict[tuple[str, str], RunTable]:
    frames, found = outcomes.plan.sizes.frames, {}
    windows = {"steady": steady(frames), "settled": settled(frames, RATE_HZ)}
    for variant in SHOWN:
        runs = outcomes.tracking(cell, variant)
        errors = {name: stacked(runs, key) for name, key in TRACKED.items()}
        for window, own in windows.items():
            columns: dict[str, Column] = {
                name: [root_mean_square(row[own]) for row in each] for name, each in errors.items()
            }
            lost = ~np.isfinite(errors["position, m"][:, own])
            columns["frames without a state"] = lost.sum(axis=1).tolist()
            found[window, variant] = run_table(
                f"{cell_title(cell)}; {variant}, {WINDOWS[window]}",
                f"Root mean square over the window; {_seeds(outcomes)}",
                columns,
            )
    return found


def _acquired(outcomes: Outcomes, acquired: AcquiredCase) -> dict[str, RunTable]:
    found = {}
    for variant in SHOWN:
        done = outcomes.acquisitions(acquired.case, variant)
        columns = {
            name: np.concatenate([each.values[key] for each in done]).astype(np.float64)
            for name, key in ACQUIRED.items()
        }
        title = f"case {acquired.case.key}, {acquired.case.name}: acquisitions, {variant}"
        found[variant] = run_table(title, _seeds(outcomes), columns)
    return found


def _seeds(outcomes: Outcomes) -> str:
    return f"run n draws by (seed {outcomes.plan.sizes.seed}, n)"
