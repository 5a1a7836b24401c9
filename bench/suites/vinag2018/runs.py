"""What each run of a flight or a chain came to, for the tables of the page to lead to."""

from __future__ import annotations

import numpy as np

from bench.report.run_table import RunTable, run_table
from bench.suites.consistency import root_mean_square
from bench.suites.vinag2018.chain_results import SETTLED
from bench.suites.vinag2018.plan import Cell
from bench.suites.vinag2018.results import Outcomes
from bench.suites.vinag2018.summaries import settled, stacked

CHAIN = {"position, m": "position_m", "attitude, deg": "attitude_deg",
         "images alone, m": "raw_position_m", "images alone, deg": "raw_attitude_deg",
         "chaser, m": "chaser_m"}  # fmt: skip


def flight_runs(outcomes: Outcomes, cell: Cell) -> RunTable:
    """Return the runs of a flight after its first tenth.

    Parameters
    ----------
    outcomes : Outcomes
    cell : Cell
    """
    flown = outcomes.flights(cell)
    own = settled(len(flown[0].values["time_s"]))
    position_m = np.linalg.norm(stacked(flown, "position_m")[own], axis=-1)
    attitude_deg = np.rad2deg(np.linalg.norm(stacked(flown, "attitude_rad")[own], axis=-1))
    velocity_m_s = np.linalg.norm(stacked(flown, "velocity_m_s")[own], axis=-1)
    columns = {
        "position, m rms": np.sqrt(np.mean(position_m**2, axis=0)),
        "position, m, largest": position_m.max(axis=0),
        "velocity, m/s rms": np.sqrt(np.mean(velocity_m_s**2, axis=0)),
        "attitude, deg rms": np.sqrt(np.mean(attitude_deg**2, axis=0)),
        "attitude, deg, largest": attitude_deg.max(axis=0),
    }
    title = f"{cell.case.name}, {cell.variant}: {cell.folder.replace('_', ' ')}"
    return run_table(title, _drawn(outcomes), columns)


def chain_runs(outcomes: Outcomes, variant: str, chaser: str) -> RunTable:
    """Return the runs of the chain after their first fifth.

    Parameters
    ----------
    outcomes : Outcomes
    variant, chaser : str
    """
    runs = [each.values for each in outcomes.chain(variant, chaser)]
    columns = {
        name: [root_mean_square(own[key][round(SETTLED * len(own[key])) :]) for own in runs]
        for name, key in CHAIN.items()
    }
    return run_table(f"{variant}, chaser {chaser}", _drawn(outcomes), columns)


def _drawn(outcomes: Outcomes) -> str:
    return f"Run n draws by (seed {outcomes.plan.sizes.seed}, n)"
