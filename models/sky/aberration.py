"""Aberration of light: who moves sees the stars nearer to where he goes, by up to 20.5 arcsec.

References
----------
P. K. Seidelmann (ed.), Explanatory Supplement to the Astronomical Almanac, 1992, equation 3.252-3:
the exact, relativistic form.
"""

from __future__ import annotations

from datetime import datetime

import numpy as np

from models.arrays import Floats
from models.sensors.camera_chip import LIGHT_SPEED_M_S
from models.sky.sun_ephemeris import sun_position_in_inertial

DIFFERENCE_S = 3600.0  # over which the Earth's way bends by 2e-4 of its speed, 4 mas


def aberrated(directions: Floats, velocity_m_s: Floats) -> Floats:
    """Return where stars seem to stand, (..., 3); with ``-velocity_m_s`` the way back.

    Parameters
    ----------
    directions : (..., 3) array
        Unit vectors to where they are.
    velocity_m_s : (3,) array, m/s
        Of the observer against the solar system's barycentre, same axes.
    """
    beta = np.asarray(velocity_m_s, dtype=np.float64) / LIGHT_SPEED_M_S
    along = (directions @ beta)[..., None]
    slow = np.sqrt(1.0 - float(beta @ beta))
    return (slow * directions + (1.0 + along / (1.0 + slow)) * beta) / (1.0 + along)


def earth_velocity_m_s(epoch: datetime, time_s: float = 0.0) -> Floats:
    """Return the Earth's velocity about the Sun, (3,), m/s, ICRS.

    To 0.1 % or 20 mas of aberration: the Sun's own 13 m/s about the barycentre are left out, and
    what the low-precision ephemeris leaves out.

    Parameters
    ----------
    epoch : datetime
        With its time zone.
    time_s : float, s
        After it.
    """
    half = 0.5 * DIFFERENCE_S
    before = sun_position_in_inertial(epoch, time_s - half)
    after = sun_position_in_inertial(epoch, time_s + half)
    return (before - after) / DIFFERENCE_S
