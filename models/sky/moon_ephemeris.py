"""Where the Moon stands on a date: a short series, good to some arc minutes and 500 km.

References
----------
O. Montenbruck and E. Gill, Satellite Orbits, 2000, section 3.3.2, equations 3.47 to 3.51; mean
equinox and ecliptic of 2000.
"""

from __future__ import annotations

from datetime import datetime

import numpy as np

from models.arrays import Floats
from models.sky.sun_ephemeris import (
    DAYS_A_CENTURY,
    J2000,
    OBLIQUITY_DEG,
    SECONDS_A_DAY,
    TERRESTRIAL_MINUS_UTC_S,
)

MOON_MU_M3_S2 = 4.902800066e12  # of the JPL ephemeris DE430
PRECESSION_DEG_A_CENTURY = 1.3972

# Multiples of the anomalies of Moon and Sun, of the argument of latitude and of the elongation.
LONGITUDE_ARCSEC = (
    (22640.0, 1, 0, 0, 0), (769.0, 2, 0, 0, 0), (-4586.0, 1, 0, 0, -2), (2370.0, 0, 0, 0, 2),
    (-668.0, 0, 1, 0, 0), (-412.0, 0, 0, 2, 0), (-212.0, 2, 0, 0, -2), (-206.0, 1, 1, 0, -2),
    (192.0, 1, 0, 0, 2), (-165.0, 0, 1, 0, -2), (148.0, 1, -1, 0, 0), (-125.0, 0, 0, 0, 1),
    (-110.0, 1, 1, 0, 0), (-55.0, 0, 0, 2, -2),
)  # fmt: skip
LATITUDE_ARCSEC = (
    (-526.0, 0, 0, 1, -2), (44.0, 1, 0, 1, -2), (-31.0, -1, 0, 1, -2), (-23.0, 0, 1, 1, -2),
    (11.0, 0, -1, 1, -2), (-25.0, -2, 0, 1, 0), (21.0, -1, 0, 1, 0),
)  # fmt: skip
DISTANCE_KM = (
    (-20905.0, 1, 0, 0, 0), (-3699.0, -1, 0, 0, 2), (-2956.0, 0, 0, 0, 2), (-570.0, 2, 0, 0, 0),
    (246.0, 2, 0, 0, -2), (-205.0, 0, 1, 0, -2), (-171.0, 1, 0, 0, 2), (-152.0, 1, 1, 0, -2),
)  # fmt: skip
MEAN_DISTANCE_KM = 385_000.0


def moon_position_in_inertial(epoch: datetime, time_s: float = 0.0) -> Floats:
    """Return the Moon's place from the Earth's centre, (3,), m, ICRS.

    Parameters
    ----------
    epoch : datetime
        With its time zone.
    time_s : float, s
        After it.
    """
    elapsed_s = (epoch - J2000).total_seconds() + time_s + TERRESTRIAL_MINUS_UTC_S
    century = elapsed_s / SECONDS_A_DAY / DAYS_A_CENTURY
    mean_longitude_deg = 218.31617 + (481_267.88088 - PRECESSION_DEG_A_CENTURY) * century
    arguments = np.deg2rad(
        [
            134.96292 + 477_198.86753 * century,
            357.52543 + 35_999.04944 * century,
            93.27283 + 483_202.01873 * century,
            297.85027 + 445_267.11135 * century,
        ]
    )
    off_arcsec = _series(LONGITUDE_ARCSEC, arguments, np.sin)
    longitude = np.deg2rad(mean_longitude_deg + off_arcsec / 3600.0)
    sun_and_node_arcsec = 412.0 * np.sin(2.0 * arguments[2]) + 541.0 * np.sin(arguments[1])
    from_node = arguments[2] + np.deg2rad((off_arcsec + sun_and_node_arcsec) / 3600.0)
    latitude_arcsec = 18520.0 * np.sin(from_node) + _series(LATITUDE_ARCSEC, arguments, np.sin)
    latitude = np.deg2rad(latitude_arcsec / 3600.0)
    distance_m = 1e3 * (MEAN_DISTANCE_KM + _series(DISTANCE_KM, arguments, np.cos))
    in_ecliptic = np.array(
        [
            np.cos(longitude) * np.cos(latitude),
            np.sin(longitude) * np.cos(latitude),
            np.sin(latitude),
        ]
    )
    tilt = np.deg2rad(OBLIQUITY_DEG)
    s, c = np.sin(tilt), np.cos(tilt)
    x, y, z = distance_m * in_ecliptic
    return np.array([x, c * y - s * z, s * y + c * z])


def _series(
    terms: tuple[tuple[float, int, int, int, int], ...], arguments: Floats, wave: np.ufunc
) -> float:
    table = np.array(terms)
    return float(table[:, 0] @ wave(table[:, 1:] @ arguments))
