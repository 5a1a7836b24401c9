"""The Moon's series against another: ELP 2000-82 as Meeus abridges it, wave by wave.

Both are sums of waves in the same four angles. A fit of our longitude, latitude and distance over
sixty years by waves of Meeus's angles must give Meeus's amplitudes.
"""

from __future__ import annotations

from datetime import timedelta

import numpy as np
import pytest

from models.arrays import Floats
from models.sky.moon_ephemeris import moon_position_in_inertial
from models.sky.sun_ephemeris import J2000, TERRESTRIAL_MINUS_UTC_S

# J. Meeus, Astronomical Algorithms, 2nd edition, tables 47.A and 47.B: multiples of the elongation,
# the Sun's anomaly, the Moon's and its argument of latitude; 1e-6 deg and 1e-3 km.
LONGITUDE = {
    (0, 0, 1, 0): 6288774, (2, 0, -1, 0): 1274027, (2, 0, 0, 0): 658314, (0, 0, 2, 0): 213618,
    (0, 1, 0, 0): -185116, (0, 0, 0, 2): -114332, (2, 0, -2, 0): 58793, (2, -1, -1, 0): 57066,
    (2, 0, 1, 0): 53322, (2, -1, 0, 0): 45758, (0, 1, -1, 0): -40923, (1, 0, 0, 0): -34720,
    (0, 1, 1, 0): -30383, (2, 0, 0, -2): 15327,
}  # fmt: skip
DISTANCE = {
    (0, 0, 1, 0): -20905355, (2, 0, -1, 0): -3699111, (2, 0, 0, 0): -2955968,
    (0, 0, 2, 0): -569925, (2, 0, -2, 0): 246158, (2, -1, 0, 0): -204586, (2, 0, 1, 0): -170733,
    (2, -1, -1, 0): -152138,
}  # fmt: skip
LATITUDE = {
    (0, 0, 0, 1): 5128122, (0, 0, 1, 1): 280602, (0, 0, 1, -1): 277693, (2, 0, 0, -1): 173237,
    (2, 0, -1, 1): 55413, (2, 0, -1, -1): 46271, (2, 0, 0, 1): 32573, (0, 0, 2, 1): 17198,
    (2, 0, 1, -1): 9266, (0, 0, 2, -1): 8822, (2, -1, 0, -1): 8216, (2, 0, -2, -1): 4324,
    (2, 0, 1, 1): 4200,
}  # fmt: skip
OBLIQUITY_DEG = 23.4392911
PRECESSION_DEG = 1.396971  # in a century, along the ecliptic


def centuries() -> Floats:
    return np.random.default_rng(47).uniform(-0.3, 0.3, 1500)


def angles(century: Floats) -> Floats:
    """Meeus, equations 47.2 to 47.5: elongation, anomalies of Sun and Moon, latitude's; (n, 4)."""
    at_2000 = [297.8501921, 357.5291092, 134.9633964, 93.2720950]
    rate = [445267.1114034, 35999.0502909, 477198.8675055, 483202.0175233]
    return np.deg2rad(np.array(at_2000) + np.outer(century, rate))


@pytest.fixture(scope="module")
def seen() -> tuple[Floats, Floats, Floats]:
    """Our longitude past the mean one and latitude, arcsec, and distance, km."""
    century = centuries()
    places = np.array(
        [
            moon_position_in_inertial(
                J2000 + timedelta(days=36525.0 * t, seconds=-TERRESTRIAL_MINUS_UTC_S)
            )
            for t in century.tolist()
        ]
    )
    tilt = np.deg2rad(OBLIQUITY_DEG)
    s, c = np.sin(tilt), np.cos(tilt)
    x, y, z = (places @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])).T
    mean_deg = 218.3164477 + (481267.88123421 - PRECESSION_DEG) * century
    past_deg = (np.rad2deg(np.arctan2(y, x)) - mean_deg + 180.0) % 360.0 - 180.0
    distance = np.linalg.norm(places, axis=1)
    return 3600.0 * past_deg, 3600.0 * np.rad2deg(np.arcsin(z / distance)), 1e-3 * distance


def amplitudes(values: Floats, waves: Floats) -> tuple[Floats, Floats]:
    """Fit a constant and waves; return both together and what is left."""
    basis = np.column_stack([np.ones(len(values)), waves])
    fitted = np.linalg.lstsq(basis, values, rcond=None)[0]
    return fitted, values - basis @ fitted


def test_its_longitude_has_the_waves_of_elp(seen) -> None:
    """Amplitudes are printed to an arc second; Meeus has 668 as 666.4 times an eccentricity."""
    fitted, left = amplitudes(seen[0], np.sin(angles(centuries()) @ np.array(list(LONGITUDE)).T))
    np.testing.assert_allclose(fitted[1:] / 3600e-6, [*LONGITUDE.values()], rtol=0.004, atol=90)
    assert abs(fitted[0]) < 2.0
    assert left.std() < 0.6


def test_its_latitude_has_the_waves_of_elp(seen) -> None:
    """Its form is another, a sine of a disturbed angle, and leaves waves of 6 arc seconds out."""
    fitted, left = amplitudes(seen[1], np.sin(angles(centuries()) @ np.array(list(LATITUDE)).T))
    np.testing.assert_allclose(fitted[1:] / 3600e-6, [*LATITUDE.values()], rtol=0.002, atol=1600)
    assert abs(fitted[0]) < 1.0
    assert left.std() < 19.0


def test_its_distance_has_the_waves_of_elp(seen) -> None:
    """Amplitudes are printed to a kilometre."""
    fitted, left = amplitudes(seen[2], np.cos(angles(centuries()) @ np.array(list(DISTANCE)).T))
    np.testing.assert_allclose(fitted[1:] * 1e3, [*DISTANCE.values()], rtol=1e-4, atol=600)
    assert fitted[0] == pytest.approx(385_000.56, abs=1.0)
    assert left.std() < 0.2
