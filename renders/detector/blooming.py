"""Full wells and what runs over them: charge that a CCD's columns spill, up and down.

Potential wells are fenced by channel stops between columns and only by a clock's voltage between
rows, so what a well cannot hold runs along its column (Janesick 2001, Scientific Charge-Coupled
Devices, section 4.2). An anti-blooming drain takes a share of it first.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats


def bloom(charge: Floats, full_well_e: float, share: float) -> Floats:
    """Clip at the full well; ``share`` of the excess runs along the column, half each way.

    A spill fills the next pixel up to its own full well and what is left runs on; what reaches
    the end of a column is lost. Where two spills want the same room neither comes first: the
    frame is the mean of both orders, so that a frame upside down blooms upside down.

    Parameters
    ----------
    charge : (height, width) array, e
        Not changed.
    full_well_e : float, e
    share : float
        0, where a drain takes all, to 1, where there is none.

    Returns
    -------
    (height, width) array, e
    """
    held = np.minimum(charge, full_well_e)
    columns = np.flatnonzero((charge > full_well_e).any(axis=0))
    if share <= 0.0 or columns.size == 0:
        return held
    wells = held[:, columns]
    each_way = 0.5 * share * (charge[:, columns] - wells)
    upside_down = np.s_[::-1]
    down_first, up_first = wells.copy(), wells.copy()
    _spill(down_first, each_way, full_well_e)
    _spill(down_first[upside_down], each_way[upside_down], full_well_e)
    _spill(up_first[upside_down], each_way[upside_down], full_well_e)
    _spill(up_first, each_way, full_well_e)
    held[:, columns] = 0.5 * (down_first + up_first)
    return held


def _spill(wells: Floats, spilled: Floats, full_well_e: float) -> None:
    """Let what each row spills run to the rows that follow it, in place."""
    carried = np.zeros(wells.shape[1])
    for row, own in zip(wells, spilled, strict=True):
        taken = np.minimum(carried, full_well_e - row)
        row += taken
        carried += own - taken
