"""Where the names of Suns stand beside their marks, so that none lies on another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from models.arrays import Floats

MARK_PT = 3.0  # half a mark
GAP_PT = 4.0  # from a mark's middle to its name
SIDES = ((1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1), (0, 1), (0, -1))
"""Right, left, the corners, above, below: in order of preference."""


def label_offsets(marks_pt: Floats, size_pt: tuple[float, float]) -> list[tuple[float, float]]:
    """Return how far each name's middle stands from its mark.

    Parameters
    ----------
    marks_pt : (n, 2) array
        Across and up, in points.
    size_pt : (float, float)
        Width and height of a name.

    Returns
    -------
    list of (float, float), points
        Names lie on no other name and no mark where any of eight places is free; else to the right.
    """
    taken = [(mark, np.full(2, MARK_PT)) for mark in marks_pt]
    half = 0.5 * np.array(size_pt)
    offsets = []
    for mark in marks_pt:
        places = [mark + np.array(side) * (GAP_PT + half) for side in SIDES]
        free = (place for place in places if not _touches(place, half, taken))
        chosen = next(free, places[0])
        taken.append((chosen, half))
        offsets.append((float(chosen[0] - mark[0]), float(chosen[1] - mark[1])))
    return offsets


def _touches(middle: Floats, half: Floats, taken: Sequence[tuple[Floats, Floats]]) -> bool:
    return any((np.abs(middle - other) < half + own).all() for other, own in taken)
