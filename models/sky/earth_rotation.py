"""How the Earth turns under an orbit: about the z axis of the ICRS, evenly.

Precession since 2000, nutation and the motion of the pole are left out: truth and filters share
one inertial frame, whose z axis is the Earth's.

References
----------
IERS Conventions 2010, equation 5.15: the Earth rotation angle.
"""

from __future__ import annotations

from datetime import datetime

import numpy as np

from models.arrays import Floats
from models.sky.sun_ephemeris import J2000, SECONDS_A_DAY

EARTH_RATE_RAD_S = 7.292115146706979e-5
ANGLE_AT_J2000_TURNS, TURNS_A_DAY = 0.7790572732640, 1.00273781191135448


def earth_angle_rad(epoch: datetime, time_s: float) -> float:
    """Return the Earth rotation angle some time after an epoch, rad, in [0, 2 pi)."""
    days = (epoch - J2000).total_seconds() / SECONDS_A_DAY
    at_epoch = 2.0 * np.pi * ((ANGLE_AT_J2000_TURNS + TURNS_A_DAY * days) % 1.0)
    return float((at_epoch + EARTH_RATE_RAD_S * time_s) % (2.0 * np.pi))


def earth_from_inertial(epoch: datetime, time_s: float) -> Floats:
    """Return the (3, 3) rotation to the axes that turn with the Earth: x to Greenwich, z north."""
    angle = earth_angle_rad(epoch, time_s)
    s, c = np.sin(angle), np.cos(angle)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
