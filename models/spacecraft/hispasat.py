"""Hispasat 36W-1, whole: a small geostationary communication satellite, deployed.

Body frame at the centre of mass: z to the Earth, wings along +-y, reflectors on +-x. Sizes and
their sources are in ``hispasat_layout``.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from models.spacecraft import hispasat_layout as at
from models.spacecraft.hispasat_antennas import antenna_parts
from models.spacecraft.hispasat_body import body_parts
from models.spacecraft.part import Spacecraft


@lru_cache(maxsize=1)
def hispasat() -> Spacecraft:
    """Build the satellite; built once, the same triangles every time."""
    return Spacecraft(
        name="hispasat",
        parts=(
            *body_parts(),
            *antenna_parts(),
            *at.WING.parts("plus_y", at.body_from_wing(1.0)),
            *at.WING.parts("minus_y", at.body_from_wing(-1.0)),
        ),
        markers=None,
        centre_of_mass=np.zeros(3),
    )
