"""Stars as a star sensor sees them: places and magnitudes of Hipparcos, to its band's 6.5.

The table's header says where it comes from. It is apart from ``models.sky.star_catalogue``, which
knows colours and classes for the chasers' narrow near-infrared band, but no star fainter than 5:
bare silicon sees what Hipparcos saw, so its own magnitude serves here.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from models.arrays import Floats, Indices

TABLE = Path(__file__).resolve().parent / "hipparcos_stars.csv"
COMPLETE_TO_MAG = 6.5


@dataclass(frozen=True, eq=False)
class HipparcosStars:
    """Stars, brightest first.

    Attributes
    ----------
    numbers : (n,) int array
        In the Hipparcos catalogue.
    directions_in_icrs : (n, 3) array
        Unit vectors towards them in 2026, from the solar system's barycentre.
    magnitude : (n,) array
        In Hipparcos's band, Hp.
    """

    numbers: Indices
    directions_in_icrs: Floats
    magnitude: Floats


@lru_cache(maxsize=1)
def hipparcos_stars() -> HipparcosStars:
    """Return the stars of the table."""
    with TABLE.open(encoding="utf-8") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))[1:]
    numbers = np.array([int(row[0]) for row in rows], dtype=np.int64)
    table = np.array([[float(each) for each in row[1:]] for row in rows])
    alpha, delta = np.deg2rad(table[:, 0]), np.deg2rad(table[:, 1])
    directions = np.stack(
        [np.cos(delta) * np.cos(alpha), np.cos(delta) * np.sin(alpha), np.sin(delta)], axis=1
    )
    return HipparcosStars(numbers, directions, table[:, 2])
