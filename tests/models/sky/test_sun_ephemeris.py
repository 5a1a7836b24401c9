"""The Sun by the date: against an independent library, and the almanac's own instants."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.errors import ScenarioError
from models.sky.sun_ephemeris import (
    J2000,
    epoch_of,
    right_ascension_over,
    sun_dir_in_inertial,
)

ALMANAC_DEG = 0.015  # the formula is good to 0.01 deg; the ecliptic turns by half of that


def angle_deg(first: np.ndarray, second: np.ndarray) -> float:
    return float(np.rad2deg(np.arctan2(np.linalg.norm(np.cross(first, second)), first @ second)))


@settings(max_examples=40, deadline=None)
@given(days=st.integers(-18_000, 18_000))
def test_it_agrees_with_beyond_on_any_day(days: int) -> None:
    """``beyond`` has Vallado's algorithm 29, and takes it to the axes of 2000 by precession."""
    dates = pytest.importorskip("beyond.dates")
    bodies = pytest.importorskip("beyond.env.solarsystem")
    day = J2000 + timedelta(days=days)
    theirs = np.asarray(
        bodies.get_body("Sun")
        .propagate(dates.Date(day.year, day.month, day.day, 12))
        .copy(frame="EME2000")
    )[:3]
    assert angle_deg(sun_dir_in_inertial(day), theirs / np.linalg.norm(theirs)) < ALMANAC_DEG


@pytest.mark.parametrize(
    ("instant", "longitude_deg"),
    [
        ("2026-03-20T14:46:00Z", 0.0),
        ("2026-06-21T08:24:00Z", 90.0),
        ("2026-09-23T00:05:00Z", 180.0),
        ("2026-12-21T20:50:00Z", 270.0),
    ],
)
def test_it_stands_on_the_almanacs_equinoxes_and_solstices(
    instant: str, longitude_deg: float
) -> None:
    """Published to the minute, in longitude of date; the Sun moves 7e-4 deg a minute.

    From 2000 to the middle of 2026 the equinox precesses by 26.5 x 50.29 arcseconds.
    """
    longitude, tilt = np.deg2rad([longitude_deg - 26.5 * 50.29 / 3600.0, 23.4393])
    x, y = np.cos(longitude), np.sin(longitude)
    expected = np.array([x, y * np.cos(tilt), y * np.sin(tilt)])
    assert angle_deg(sun_dir_in_inertial(epoch_of(instant)), expected) < ALMANAC_DEG


def test_time_goes_on_after_the_epoch() -> None:
    epoch = epoch_of("2026-03-20T00:00:00Z")
    np.testing.assert_allclose(
        sun_dir_in_inertial(epoch, 86_400.0),
        sun_dir_in_inertial(epoch + timedelta(days=1)),
        atol=1e-12,
    )


def test_an_epoch_is_a_date_in_utc() -> None:
    noon = datetime(2026, 3, 20, 12, tzinfo=UTC)
    for text in ("2026-03-20T12:00:00Z", "2026-03-20 12:00:00+00:00", " 2026-03-20T12:00Z "):
        assert epoch_of(text) == noon


@pytest.mark.parametrize(
    "text",
    [
        "",
        "noon",
        "2026-03-20",
        "2026-03-20T12:00:00",
        "2026-03-20T12:00:00+01:00",
        "2026-13-01T00:00Z",
    ],
)
def test_what_is_no_date_in_utc_is_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match="date and time in UTC"):
        epoch_of(text)


@pytest.mark.parametrize("text", ["1949-12-31T00:00:00Z", "2050-01-01T00:00:00Z"])
def test_years_of_which_the_formula_knows_nothing_are_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match="1950 to 2049"):
        epoch_of(text)


@pytest.mark.parametrize("day", [20, 80, 171, 265])
def test_at_true_noon_the_sun_stands_over_the_meridian(day: int) -> None:
    """Where the Sun is overhead: 15 deg an hour from noon, less the equation of time (NOAA's)."""
    epoch = datetime(2024, 1, 1, 9, 30, tzinfo=UTC) + timedelta(days=day - 1)
    turn = 2.0 * np.pi / 366.0 * (day - 1 + (9.5 - 12.0) / 24.0)
    minutes = 229.18 * (
        7.5e-5 + 1.868e-3 * np.cos(turn) - 0.032077 * np.sin(turn)
        - 0.014615 * np.cos(2.0 * turn) - 0.040849 * np.sin(2.0 * turn)
    )  # fmt: skip
    overhead_deg = 15.0 * (12.0 - 9.5 - minutes / 60.0)
    x, y, _ = sun_dir_in_inertial(epoch)
    apart_deg = np.rad2deg(np.arctan2(y, x)) - right_ascension_over(overhead_deg, epoch)
    assert abs((apart_deg + 180.0) % 360.0 - 180.0) < 0.25  # the formula is good to half a minute


def test_a_meridian_is_under_the_same_stars_after_a_sidereal_day() -> None:
    """Sidereal time at noon of 2000 is 280.46062 deg; the equinox moves 1.2812 deg a century."""
    assert right_ascension_over(0.0, J2000) == pytest.approx(280.46062, abs=1e-6)
    assert right_ascension_over(100.0, J2000) == pytest.approx(20.46062, abs=1e-6)
    century = J2000 + timedelta(days=36525)
    turned = right_ascension_over(0.0, century)
    sidereal = (280.46062 + 360.98564737 * 36525) % 360.0 - 1.2812
    assert turned == pytest.approx(sidereal % 360.0, abs=1e-6)
    later = J2000 + timedelta(seconds=86_164.0989)
    assert right_ascension_over(0.0, later) == pytest.approx(280.46062, abs=1e-4)
