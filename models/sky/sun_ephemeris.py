"""Where the Sun stands at an instant, in the axes of the ICRS."""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np

from models.arrays import Floats
from models.errors import ScenarioError

J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)
FIRST_YEAR, LAST_YEAR = 1950, 2050
DAYS_A_CENTURY = 36525.0
OBLIQUITY_DEG = 23.439291  # of J2000
PRECESSION_DEG_A_CENTURY = 1.39697  # in longitude


def utc_from_text(text: str) -> datetime:
    """Read an instant such as ``2026-03-20T14:46:00``, UTC.

    Raises
    ------
    ScenarioError
        If it is none, or of a year before 1950 or after 2050.
    """
    try:
        read = datetime.fromisoformat(text.strip())
    except ValueError as error:
        raise ScenarioError(
            f"expected an instant such as 2026-03-20T14:46:00, UTC, got {text!r:.60}"
        ) from error
    instant = read.replace(tzinfo=UTC) if read.tzinfo is None else read.astimezone(UTC)
    if not FIRST_YEAR <= instant.year <= LAST_YEAR:
        raise ScenarioError(
            f"expected an instant from {FIRST_YEAR} to {LAST_YEAR}, for which the Sun's place is "
            f"known to 0.01 deg, got {text!r:.60}"
        )
    return instant


def sun_in_icrs(instant: datetime) -> Floats:
    """Return the unit vector from the Earth to the Sun, (3,), good to some 0.01 deg.

    References
    ----------
    The Astronomical Almanac, page C5: low-precision formulas, of the mean equinox of date; carried
    back to J2000 by the general precession in longitude.
    """
    days = (instant - J2000).total_seconds() / 86400.0
    mean_longitude = 280.460 + 0.9856474 * days
    anomaly = np.deg2rad(357.528 + 0.9856003 * days)
    of_date = mean_longitude + 1.915 * np.sin(anomaly) + 0.020 * np.sin(2.0 * anomaly)
    longitude = np.deg2rad(of_date - PRECESSION_DEG_A_CENTURY * days / DAYS_A_CENTURY)
    tilt = np.deg2rad(OBLIQUITY_DEG)
    return np.array(
        [
            np.cos(longitude),
            np.cos(tilt) * np.sin(longitude),
            np.sin(tilt) * np.sin(longitude),
        ]
    )
