"""The Maxar-1300 as one that nobody prepared: no markers, and a frame at its centre of mass.

Axes are those of the marked one's TGFF: z out of the launch adaptor ring, wings along +-y.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from models.spacecraft.maxar1300 import CENTRE_OF_MASS_M, maxar1300
from models.spacecraft.part import Spacecraft
from models.spacecraft.solids import shifted

NAME = "maxar1300_unmarked"
MARKER_SUPPORTS = "marker_supports"


@lru_cache(maxsize=1)
def maxar1300_unmarked() -> Spacecraft:
    """Return the satellite without its markers and what carries them; built once."""
    whole, to_ring = maxar1300(), -np.array(CENTRE_OF_MASS_M)
    return replace(
        whole,
        name=NAME,
        parts=tuple(
            replace(part, mesh=shifted(part.mesh, to_ring))
            for part in whole.parts
            if part.name != MARKER_SUPPORTS
        ),
        markers=None,
        centre_of_mass=np.zeros(3),
    )
