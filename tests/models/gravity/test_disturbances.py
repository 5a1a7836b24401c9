"""Sun, Moon, light and air against closed forms and published sizes."""

import numpy as np
import pytest

from models.gravity.disturbances import (
    EARTH_RADIUS_M,
    SOLAR_PRESSURE_N_M2,
    SUN_MU_M3_S2,
    SUN_RADIUS_M,
    air_density,
    drag,
    solar_pressure,
    sunlit_share,
    third_body,
)
from models.sky.earth_rotation import EARTH_RATE_RAD_S, earth_angle_rad, earth_from_inertial
from models.sky.moon_ephemeris import MOON_MU_M3_S2, moon_position_in_inertial
from models.sky.sun_ephemeris import ASTRONOMICAL_UNIT_M, epoch_of, sun_position_in_inertial

SUN = np.array([ASTRONOMICAL_UNIT_M, 0.0, 0.0])
NEW_YEAR = epoch_of("2000-01-01T12:00:00Z")


def test_a_tide_is_twice_as_strong_towards_the_body_as_across():
    place = np.array([4.2e7, 0.0, 0.0])
    scale = SUN_MU_M3_S2 / ASTRONOMICAL_UNIT_M**3 * 4.2e7
    assert third_body(place, SUN, SUN_MU_M3_S2)[0] == pytest.approx(2.0 * scale, rel=1e-3)
    across = third_body(np.roll(place, 1), SUN, SUN_MU_M3_S2)
    assert across[1] == pytest.approx(-scale, rel=1e-3)


def test_tides_in_geo_have_the_sizes_of_the_textbook():
    """Montenbruck and Gill, figure 3.1: some 1e-5 by the Moon, half of it by the Sun, m/s2."""
    place = np.array([4.2164e7, 0.0, 0.0])
    moon = third_body(place, moon_position_in_inertial(NEW_YEAR), MOON_MU_M3_S2)
    sun = third_body(place, sun_position_in_inertial(NEW_YEAR), SUN_MU_M3_S2)
    assert 2e-6 < np.linalg.norm(moon) < 1.2e-5
    assert 1e-6 < np.linalg.norm(sun) < 4e-6


def test_the_moon_goes_round_in_a_sidereal_month_at_its_distances():
    days = np.arange(0.0, 27.321_661 * 13, 0.5)
    places = np.array([moon_position_in_inertial(NEW_YEAR, 86_400.0 * day) for day in days])
    distance_km = 1e-3 * np.linalg.norm(places, axis=1)
    assert 356_000.0 < distance_km.min() < 370_500.0
    assert 404_000.0 < distance_km.max() < 407_000.0
    longitude = np.unwrap(np.arctan2(places[:, 1], places[:, 0]))
    month = 2.0 * np.pi / np.polyfit(days, longitude, 1)[0]
    assert month == pytest.approx(27.32, abs=0.05)


def test_eclipses_take_place():
    """Total solar eclipse of 2026-08-12, 17:46 UTC: Moon before Sun, as seen from the centre."""
    epoch = epoch_of("2026-08-12T17:46:00Z")
    sun, moon = sun_position_in_inertial(epoch), moon_position_in_inertial(epoch)
    cosine = sun @ moon / (np.linalg.norm(sun) * np.linalg.norm(moon))
    assert np.rad2deg(np.arccos(cosine)) < 1.0  # gamma is 0.90 Earth radii: 0.86 deg


def test_the_shadow_is_a_cone_with_a_penumbra():
    """Full light before the Earth, none behind it, half where its limb halves the Sun."""
    radius = 4.2e7
    assert sunlit_share(np.array([radius, 0.0, 0.0]), SUN) == 1.0
    assert sunlit_share(np.array([-radius, 0.0, 0.0]), SUN) == 0.0
    limb = np.arcsin(EARTH_RADIUS_M / radius)
    edge = radius * np.array([-np.cos(limb), np.sin(limb), 0.0])
    assert sunlit_share(edge, SUN) == pytest.approx(0.5, abs=0.02)  # the limb is not straight
    sun_rad = np.arcsin(SUN_RADIUS_M / ASTRONOMICAL_UNIT_M)
    for turn, share in ((1.3 * sun_rad, 1.0), (-1.3 * sun_rad, 0.0)):
        angle = limb + turn
        place = radius * np.array([-np.cos(angle), np.sin(angle), 0.0])
        assert sunlit_share(place, SUN) == share


def test_light_pushes_away_from_the_sun_with_its_pressure():
    pushed = solar_pressure(np.array([7e6, 0.0, 0.0]), SUN, 0.02)
    assert pushed == pytest.approx([-0.02 * SOLAR_PRESSURE_N_M2, 0.0, 0.0], rel=1e-3)


def test_air_is_thinner_higher_and_densest_behind_noon():
    def density(height_m: float, hours_after_noon: float) -> float:
        angle = np.deg2rad(15.0 * hours_after_noon)
        place = (EARTH_RADIUS_M + height_m) * np.array([np.cos(angle), np.sin(angle), 0.0])
        return air_density(place, SUN)

    around = [density(500e3, hour) for hour in range(24)]
    assert np.argmax(around) == 2
    assert density(500e3, 2) == pytest.approx(2.042e-12, rel=1e-6)  # table 3.8
    assert density(500e3, 14) == pytest.approx(3.916e-13, rel=1e-6)
    assert density(800e3, 2) < density(700e3, 2)
    assert density(1100e3, 2) == 0.0
    with pytest.raises(ValueError, match="at least 400 km"):
        density(300e3, 0)


@pytest.mark.parametrize("declination_deg", [-23.0, 23.0])
@pytest.mark.parametrize("right_ascension_deg", [0.0, 140.0])
def test_air_is_densest_two_hours_behind_a_sun_that_stands_over_a_tropic(
    declination_deg, right_ascension_deg
):
    def towards(hours, declination_deg):
        lon, lat = np.deg2rad([right_ascension_deg + 15.0 * hours, declination_deg])
        return np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])

    sun = 1.5e11 * towards(0.0, declination_deg)
    hours = np.arange(0.0, 24.0, 0.5)
    along = [air_density(6_900e3 * towards(hour, 0.0), sun) for hour in hours]
    assert hours[np.argmax(along)] == 2.0
    np.testing.assert_allclose(along, np.roll(along[::-1], 9), rtol=1e-9)  # even about it


def test_air_that_turns_along_does_not_brake():
    place = np.array([7e6, 0.0, 0.0])
    with_it = np.array([0.0, 7e6 * EARTH_RATE_RAD_S, 0.0])
    assert np.abs(drag(place, with_it, 1e-12, 0.02)).max() < 1e-25
    assert drag(place, np.array([0.0, 7500.0, 0.0]), 1e-12, 0.02)[1] < 0.0


def test_the_earth_turns_once_in_a_sidereal_day():
    assert np.rad2deg(earth_angle_rad(NEW_YEAR, 0.0)) == pytest.approx(280.4606, abs=1e-3)
    day = earth_from_inertial(NEW_YEAR, 86_164.0989) @ earth_from_inertial(NEW_YEAR, 0.0).T
    assert day == pytest.approx(np.eye(3), abs=1e-7)
    quarter = earth_from_inertial(NEW_YEAR, 21_541.0) @ earth_from_inertial(NEW_YEAR, 0.0).T
    assert quarter[0, 1] == pytest.approx(1.0, abs=1e-6)  # eastward
