"""Where the Sun stands on a date: the low-precision formula of the Astronomical Almanac, 0.01 deg.

It holds from 1950 to 2050. The formula counts longitude from the equinox of date; here it is taken
back to that of 2000, so that axes are those of the ICRS. (The ecliptic itself turns by 0.003 deg in
25 years, which is left out.)

References
----------
The Astronomical Almanac, section C, Low precision formulas for the Sun. Precession in longitude:
Lieske et al. 1977, Astronomy and Astrophysics 58.
"""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import numpy as np

from models.arrays import Floats
from models.errors import ScenarioError

J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)
TERRESTRIAL_MINUS_UTC_S = 69.2  # since 2017; 1 s is 1e-5 deg of the Sun
YEARS = (1950, 2050)
SECONDS_A_DAY, DAYS_A_CENTURY = 86_400.0, 36_525.0
OBLIQUITY_DEG = 23.4393  # of the ecliptic of 2000
ASTRONOMICAL_UNIT_M = 149_597_870_700.0


def epoch_of(text: str) -> datetime:
    """Read a date and time in UTC such as ``2026-03-20T12:00:00Z``.

    Raises
    ------
    ScenarioError
        If it is none, has another or no time zone, or lies outside the years of the formula.
    """
    try:
        epoch = datetime.fromisoformat(text.strip())
    except ValueError as error:
        raise ScenarioError(
            f"expected a date and time in UTC such as 2026-03-20T12:00:00Z, got {text!r}"
        ) from error
    if epoch.utcoffset() != timedelta(0):
        raise ScenarioError(
            f"expected a date and time in UTC, such as 2026-03-20T12:00:00Z, got {text!r}"
        )
    if not YEARS[0] <= epoch.year < YEARS[1]:
        raise ScenarioError(
            f"expected a date from {YEARS[0]} to {YEARS[1] - 1}, of which the Sun's formula knows, "
            f"got {text!r}"
        )
    return epoch


def right_ascension_over(longitude_deg: float, epoch: datetime) -> float:
    """Return the right ascension that stands over a meridian of the Earth at an epoch, deg.

    Greenwich mean sidereal time (Aoki et al. 1982, Astronomy and Astrophysics 105), taken back from
    the equinox of date to that of 2000, as the Sun is: 0.01 deg.

    Parameters
    ----------
    longitude_deg : float, deg
        East.
    epoch : datetime
        With its time zone.

    Returns
    -------
    float, deg
        From 0 to 360, ICRS.
    """
    days = (epoch - J2000).total_seconds() / SECONDS_A_DAY
    sidereal_deg = 280.46062 + 360.98564737 * days
    precessed_deg = 1.2812 * days / DAYS_A_CENTURY  # along the equator
    return float((sidereal_deg + longitude_deg - precessed_deg) % 360.0)


def sun_dir_in_inertial(epoch: datetime, time_s: float = 0.0) -> Floats:
    """Return the unit vector from the Earth towards the Sun, (3,), some time after an epoch.

    Parameters
    ----------
    epoch : datetime
        With its time zone.
    time_s : float, s

    Returns
    -------
    (3,) array, ICRS: x towards the equinox of 2000, z north.
    """
    elapsed_s = (epoch - J2000).total_seconds() + time_s + TERRESTRIAL_MINUS_UTC_S
    days = elapsed_s / SECONDS_A_DAY
    mean_longitude_deg = 280.460 + 0.9856474 * days
    anomaly = np.deg2rad(357.528 + 0.9856003 * days)
    from_the_mean_deg = 1.915 * np.sin(anomaly) + 0.020 * np.sin(2.0 * anomaly)
    precessed_deg = 1.39697 * days / DAYS_A_CENTURY
    longitude = np.deg2rad(mean_longitude_deg + from_the_mean_deg - precessed_deg)
    obliquity = np.deg2rad(OBLIQUITY_DEG)
    sine = np.sin(longitude)
    return np.array([np.cos(longitude), np.cos(obliquity) * sine, np.sin(obliquity) * sine])


def sun_position_in_inertial(epoch: datetime, time_s: float = 0.0) -> Floats:
    """Return the Sun's place from the Earth's centre, (3,), m, ICRS; its distance to 1e-4.

    Parameters
    ----------
    epoch : datetime
        With its time zone.
    time_s : float, s
        After it.
    """
    elapsed_s = (epoch - J2000).total_seconds() + time_s + TERRESTRIAL_MINUS_UTC_S
    anomaly = np.deg2rad(357.528 + 0.9856003 * elapsed_s / SECONDS_A_DAY)
    distance_au = 1.00014 - 0.01671 * np.cos(anomaly) - 0.00014 * np.cos(2.0 * anomaly)
    return ASTRONOMICAL_UNIT_M * distance_au * sun_dir_in_inertial(epoch, time_s)
