"""The starts behind a count, for the tables of the page to lead to."""

from __future__ import annotations

import numpy as np

from bench.report.run_table import RunTable, run_table
from bench.suites.uncooperative_suns.cases import SUNS
from bench.suites.uncooperative_suns.results import Starts
from models.arrays import Floats, Mask

DRAWN = f"Start n is of motion n // {SUNS}, under Sun n % {SUNS} of it"


def found_runs(title: str, starts: Starts, chosen: Mask) -> RunTable:
    """Return starts that ended with a pose, right or wrong.

    Parameters
    ----------
    title : str
        Which.
    starts : Starts
    chosen : (n,) array of bool
    """
    columns = {
        "attitude, deg": starts.attitude_deg[chosen],
        "range, %": 100.0 * starts.range_share[chosen],
        "told wrong, %": 100.0 * starts.doubt[chosen],
        "image": starts.images[chosen].astype(np.float64),
        **_light(starts, chosen),
    }
    return run_table(title, DRAWN, columns, None, "start", np.flatnonzero(chosen))


def refused_runs(title: str, starts: Starts, chosen: Mask) -> RunTable:
    """Return starts that were refused, with the reason; of many, those that had most light.

    Parameters
    ----------
    title : str
        Which.
    starts : Starts
    chosen : (n,) array of bool
    """
    reasons = [each for each, own in zip(starts.reasons, chosen, strict=True) if own]
    columns, numbers = _light(starts, chosen), np.flatnonzero(chosen)
    return run_table(title, DRAWN, columns, {"reason": reasons}, "start", numbers)


def _light(starts: Starts, chosen: Mask) -> dict[str, Floats]:
    return {
        "lit, %": 100.0 * starts.lit[chosen],
        "width of the field, %": 100.0 * starts.share[chosen],
        "phase angle, deg": starts.phase_deg[chosen],
    }
