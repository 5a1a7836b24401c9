"""The Sun at published equinoxes and solstices, and what is refused as an instant."""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np
import pytest

from models.errors import ScenarioError
from models.sky.sun_ephemeris import sun_in_icrs, utc_from_text

ACCURACY_DEG = 0.015  # the Almanac's 0.01 deg; nutation and aberration left out take the rest
YEARLY_PRECESSION_DEG = 50.29 / 3600.0


@pytest.mark.parametrize(
    ("text", "longitude_deg"),
    [
        ("2000-03-20T07:35", 0.0),
        ("2026-03-20T14:46", 0.0),
        ("2026-06-21T08:25", 90.0),
        ("2026-09-23T00:05", 180.0),
        ("2026-12-21T20:50", 270.0),
    ],
)
def test_the_seasons_begin_when_they_are_published_to(text: str, longitude_deg: float) -> None:
    """Longitudes are of date: since J2000 the equinox has moved by 50.29 arcsec a year."""
    instant = utc_from_text(text)
    years = (instant - datetime(2000, 1, 1, 12, tzinfo=UTC)).days / 365.25
    longitude = np.deg2rad(longitude_deg - years * YEARLY_PRECESSION_DEG)
    tilt = np.deg2rad(23.4393)
    x, y = np.cos(longitude), np.sin(longitude)
    expected = np.array([x, y * np.cos(tilt), y * np.sin(tilt)])
    off_deg = np.rad2deg(np.linalg.norm(sun_in_icrs(instant) - expected))
    assert off_deg < ACCURACY_DEG


def test_an_instant_is_utc_unless_it_says_otherwise() -> None:
    assert utc_from_text("2026-03-20T14:46:00") == utc_from_text("2026-03-20T15:46:00+01:00")


@pytest.mark.parametrize("text", ["", "noon", "1900-01-01T00:00:00", "2099-01-01T00:00:00"])
def test_what_is_no_instant_is_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match="expected an instant"):
        utc_from_text(text)
