"""Aberration: Lorentz's angle, its way back, and the Earth's own 20.5 arcsec."""

from datetime import UTC, datetime

import numpy as np
import pytest

from models.sensors.camera_chip import LIGHT_SPEED_M_S
from models.sky.aberration import aberrated, earth_velocity_m_s
from models.sky.sun_ephemeris import sun_dir_in_inertial

ARCSEC = np.deg2rad(1.0 / 3600.0)
EPOCH = datetime(2026, 3, 20, 12, tzinfo=UTC)


@pytest.mark.parametrize("share", [1e-4, 0.1, 0.6])
def test_angles_are_lorentz_s(share):
    """Hold cos a' = (cos a + b) / (1 + b cos a), whatever the speed."""
    velocity = share * LIGHT_SPEED_M_S * np.array([0.0, 0.6, 0.8])
    sky = np.random.default_rng(0).standard_normal((50, 3))
    sky /= np.linalg.norm(sky, axis=1, keepdims=True)
    seen = aberrated(sky, velocity)
    before, after = sky @ [0.0, 0.6, 0.8], seen @ [0.0, 0.6, 0.8]
    np.testing.assert_allclose(after, (before + share) / (1.0 + share * before), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(seen, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(aberrated(seen, -velocity), sky, atol=1e-10)


def test_the_constant_of_aberration_is_the_earth_s():
    """20.496 arcsec, and 1.7 % of it with the seasons' changing speed."""
    velocity = earth_velocity_m_s(EPOCH)
    course = velocity / np.linalg.norm(velocity)
    aside = np.cross(course, [0.0, 0.0, 1.0])
    aside /= np.linalg.norm(aside)
    moved = np.linalg.norm(aberrated(aside, velocity) - aside) / ARCSEC
    assert moved == pytest.approx(20.496, rel=0.018)


def test_the_earth_flies_across_the_sun_s_light_and_eastward():
    """In March the Sun stands at 0 h; the Earth moves to where the ecliptic's south-west is."""
    velocity, sun = earth_velocity_m_s(EPOCH), sun_dir_in_inertial(EPOCH)
    assert abs(velocity @ sun) < 0.02 * np.linalg.norm(velocity)
    assert np.cross(-sun, velocity)[2] > 0.0  # about the Sun, anticlockwise as seen from north
