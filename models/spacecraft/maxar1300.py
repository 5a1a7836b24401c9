"""The Maxar-1300, whole: a geostationary communication satellite, deployed.

Target frame TGFF: origin at the launch adaptor ring's centre in its plane, z out of that plane
(towards the chaser, away from Earth), wings along +-y, reflectors on +-x. Sizes are those of the
class: a 2.4 by 2.4 by 3.6 m bus, a span of 29 m; what public sources leave open is ours.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from models.spacecraft.anti_earth_deck import anti_earth_deck_parts
from models.spacecraft.apogee_engine import apogee_engine_parts
from models.spacecraft.bus import bus_parts
from models.spacecraft.earth_deck import earth_deck_parts
from models.spacecraft.launch_adaptor_ring import launch_adaptor_ring_parts
from models.spacecraft.marker_support import marker_support_parts
from models.spacecraft.offset_reflector import offset_reflector_parts
from models.spacecraft.part import Spacecraft
from models.spacecraft.radiator import radiator_parts
from models.spacecraft.retroreflector_layout import RETROREFLECTORS
from models.spacecraft.solar_wing import solar_wing_parts
from models.spacecraft.thruster import thruster_parts

# Opromolla et al. 2022, section 4.1: the centre of mass lies 1.8 m behind the ring plane.
CENTRE_OF_MASS_M = (0.0, 0.0, -1.8)


@lru_cache(maxsize=1)
def maxar1300() -> Spacecraft:
    """Build the satellite; built once, the same triangles every time."""
    return Spacecraft(
        name="maxar1300",
        parts=(
            *bus_parts(),
            *launch_adaptor_ring_parts(),
            *apogee_engine_parts(),
            *marker_support_parts(RETROREFLECTORS),
            *thruster_parts(),
            *anti_earth_deck_parts(),
            *radiator_parts(1.0),
            *radiator_parts(-1.0),
            *solar_wing_parts(1.0),
            *solar_wing_parts(-1.0),
            *offset_reflector_parts(1.0),
            *offset_reflector_parts(-1.0),
            *earth_deck_parts(),
        ),
        markers=RETROREFLECTORS,
        centre_of_mass=np.array(CENTRE_OF_MASS_M),
    )
