"""The Sun and the Earth at the epoch of their own formulas, where each is a single number."""

from __future__ import annotations

from datetime import timedelta

import numpy as np
import pytest

from models.sky.sun_ephemeris import (
    J2000,
    right_ascension_over,
    sun_dir_in_inertial,
    sun_position_in_inertial,
)

TERRESTRIAL_S = 69.2  # by which terrestrial time is ahead of UTC since 2017
ROUNDED_DEG = 1e-9
AU_M = 149_597_870_700.0
PRECESSION_DEG = 0.012  # of the equinox of date against that of 2000, along and across, by 2050


def test_at_the_epoch_the_sun_is_where_the_almanacs_constants_say() -> None:
    """Astronomical Almanac, low precision: L 280.460, g 357.528 deg, at noon of terrestrial time.

    A minute of terrestrial time is 7e-4 deg of the Sun: noon by UTC is not that noon.
    """
    noon = J2000 - timedelta(seconds=TERRESTRIAL_S)
    g = np.deg2rad(357.528)
    longitude = np.deg2rad(280.460 + 1.915 * np.sin(g) + 0.020 * np.sin(2.0 * g))
    x, y, z = sun_dir_in_inertial(noon)
    found = np.rad2deg(np.arctan2(np.hypot(y, z), x))
    assert 360.0 - found == pytest.approx(np.rad2deg(longitude), abs=ROUNDED_DEG)
    assert sun_dir_in_inertial(J2000, -TERRESTRIAL_S) == pytest.approx([x, y, z], abs=1e-12)
    distance_au = 1.00014 - 0.01671 * np.cos(g) - 0.00014 * np.cos(2.0 * g)
    place = sun_position_in_inertial(noon)
    assert np.linalg.norm(place) == pytest.approx(AU_M * distance_au, rel=1e-9)


def test_the_earth_is_farthest_and_nearest_when_almanacs_say() -> None:
    """2026: perihelion on 3 January at 0.98330 au, aphelion on 6 July at 1.01664 au."""
    days = np.arange(0.0, 365.0, 0.25)
    start = J2000 + timedelta(days=9496.5)  # 1 January 2026, 0 h
    far_m = [np.linalg.norm(sun_position_in_inertial(start + timedelta(days=d))) for d in days]
    assert days[np.argmin(far_m)] == pytest.approx(2.7, abs=1.5)
    assert days[np.argmax(far_m)] == pytest.approx(186.7, abs=1.5)
    assert min(far_m) / AU_M == pytest.approx(0.98330, abs=2e-4)
    assert max(far_m) / AU_M == pytest.approx(1.01664, abs=2e-4)


@pytest.mark.parametrize("years", [-25, 0, 13, 26, 50])
@pytest.mark.parametrize("east_deg", [0.0, 75.0, -120.0])
def test_the_earth_turns_by_its_rotation_angle(years: int, east_deg: float) -> None:
    """The angle of IAU 2000 from the origin that stays with the equator of 2000 and its equinox."""
    epoch = J2000 + timedelta(days=365.25 * years, hours=7.0)
    days = (epoch - J2000).total_seconds() / 86_400.0
    turned_deg = 360.0 * ((0.7790572732640 + 1.00273781191135448 * days) % 1.0)
    found = right_ascension_over(east_deg, epoch)
    apart = (found - turned_deg - east_deg + 180.0) % 360.0 - 180.0
    assert apart == pytest.approx(0.0, abs=PRECESSION_DEG)
    assert 0.0 <= found < 360.0
