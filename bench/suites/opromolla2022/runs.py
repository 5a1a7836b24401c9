"""What each run of a sequence came to, for the tables of the page to lead to."""

from __future__ import annotations

import numpy as np

from bench.report.run_table import RunTable, run_table
from bench.suites.opromolla2022.cases import Sequence
from bench.suites.opromolla2022.results import Outcomes
from bench.suites.opromolla2022.tables import SHOWN
from models.arrays import Floats


def runs_of(outcomes: Outcomes, own: Sequence) -> dict[str, RunTable]:
    """Return the runs of a sequence, by variant.

    Parameters
    ----------
    outcomes : Outcomes
    own : Sequence
    """
    found = {}
    for variant in SHOWN:
        runs = outcomes.runs(own, variant)
        columns = {
            "position, mm rms": _rms(runs.position_mm),
            "attitude, deg rms": _rms(runs.of("attitude_deg").astype(np.float64)),
            "position, mm, largest": _most(runs.position_mm),
            "frames lost": (~np.isfinite(runs.errors[..., 0])).sum(axis=1),
            "missed": runs.of("missed").sum(axis=1),
            "wrong": runs.of("wrong").sum(axis=1),
        }
        found[variant] = run_table(
            f"{own.name}, errors {own.errors.replace('_', ' ')}: {variant}",
            f"All frames of each run; run n draws by (seed {outcomes.plan.sizes.seed}, n)",
            columns,
        )
    return found


def _rms(errors: Floats) -> Floats:
    there = np.isfinite(errors)
    squares = np.where(there, errors, 0.0) ** 2
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.sqrt(squares.sum(axis=1) / there.sum(axis=1)))


def _most(errors: Floats) -> Floats:
    largest = np.where(np.isfinite(errors), errors, -np.inf).max(axis=1)
    return np.where(np.isfinite(largest), largest, np.nan)
