"""The bright stars: where they stand in the ICRS and how bright they are.

The table's header says where it comes from. It has 1171 stars: all to V = 4.4 but for fourteen
close pairs of fainter ones (against Hipparcos: 800 of 815), and two in five from there to 5.0.
Fainter ones are not there however long an exposure is, nor are the 20 arcsec of the aberration of
light (0.2 px of the chaser's camera) or proper motion since 2016.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from models.arrays import Floats
from models.sky.star_light import irradiance_w_m2

TABLE = Path(__file__).resolve().parent / "bright_stars.csv"


@dataclass(frozen=True, eq=False)
class Stars:
    """Stars, brightest in V first.

    Attributes
    ----------
    numbers : tuple of n ints
        In the Bright Star Catalogue (HR).
    directions_in_icrs : (n, 3) array
        Unit vectors towards them.
    visual_mag : (n,) array
        V.
    irradiance_w_m2 : (n,) array, W/m2
        In the passband, on a surface that faces the star; see ``models.sky.star_light``.
    """

    numbers: tuple[int, ...]
    directions_in_icrs: Floats
    visual_mag: Floats
    irradiance_w_m2: Floats

    def row(self, number: int) -> int:
        """Return the row of a star by its number in the Bright Star Catalogue."""
        return self.numbers.index(number)


def direction_in_icrs(right_ascension_deg: float, declination_deg: float) -> Floats:
    """Return the unit vector towards a place in the sky, (3,)."""
    alpha, delta = np.deg2rad([right_ascension_deg, declination_deg])
    return np.array([np.cos(delta) * np.cos(alpha), np.cos(delta) * np.sin(alpha), np.sin(delta)])


@lru_cache(maxsize=1)
def bright_stars() -> Stars:
    """Return the stars of the table."""
    with TABLE.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    light = [(float(row["v_mag"]), float(row["b_v"]), row["red_class"]) for row in rows]
    return Stars(
        numbers=tuple(int(row["hr"]) for row in rows),
        directions_in_icrs=np.array(
            [direction_in_icrs(float(row["ra_deg"]), float(row["dec_deg"])) for row in rows]
        ),
        visual_mag=np.array([visual for visual, _, _ in light]),
        irradiance_w_m2=np.array([irradiance_w_m2(*one) for one in light]),
    )
