"""How strongly a navigation satellite sends where: main lobe, side lobes, and all between.

One measured pattern stands for all satellites: of Galileo none is public. The table names its
source.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from models.arrays import Floats

TABLE = Path(__file__).resolve().parent / "gps_iir_svn47_gain_db.csv"
AZIMUTH_STEP_DEG = 10.0
BEYOND_DB = -100.0  # behind the last row: nothing is received from there


@lru_cache(maxsize=1)
def _table() -> tuple[Floats, Floats]:
    with TABLE.open(encoding="utf-8") as file:
        lines = [line for line in file if not line.startswith("#")][1:]
    rows = np.array([[float(number) for number in line.split(",")] for line in lines])
    return rows[:, 0], np.concatenate([rows[:, 1:], rows[:, 1:2]], axis=1)


def transmit_gain_db(off_boresight_rad: Floats, azimuth_rad: Floats) -> Floats:
    """Return the gain between the rows and columns of the table, (...,), dB.

    Parameters
    ----------
    off_boresight_rad : (...,) array, rad
        From the direction to the Earth's centre.
    azimuth_rad : (...,) array, rad
        About it, from the satellite's x axis to its y axis.
    """
    rows_deg, gain = _table()
    off_deg = np.rad2deg(off_boresight_rad)
    row = np.clip(np.searchsorted(rows_deg, off_deg, side="right") - 1, 0, len(rows_deg) - 2)
    part = np.clip((off_deg - rows_deg[row]) / (rows_deg[row + 1] - rows_deg[row]), 0.0, 1.0)
    around = np.mod(np.rad2deg(azimuth_rad), 360.0) / AZIMUTH_STEP_DEG
    column = np.minimum(around.astype(np.int64), gain.shape[1] - 2)
    beside = around - column
    low = gain[row, column] + beside * (gain[row, column + 1] - gain[row, column])
    high = gain[row + 1, column] + beside * (gain[row + 1, column + 1] - gain[row + 1, column])
    return np.where(off_deg > rows_deg[-1], BEYOND_DB, low + part * (high - low))


def azimuth_averaged_gain_db(off_boresight_rad: Floats) -> Floats:
    """Return the gain of the power that a whole turn of azimuth takes up, (...,), dB.

    Parameters
    ----------
    off_boresight_rad : (...,) array, rad
    """
    rows_deg, gain = _table()
    mean = 10.0 * np.log10(np.mean(10.0 ** (0.1 * gain[:, :-1]), axis=1))
    return np.interp(np.rad2deg(off_boresight_rad), rows_deg, mean, right=BEYOND_DB)
