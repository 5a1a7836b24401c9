"""An Earth-pointing satellite turns with the Earth, wings north and south."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.sky.earth_pointing import GEO_RATE_DEG_H, earth_pointing, rotation_from_wxyz, turned
from models.sky.star_catalogue import direction_in_icrs

SIDEREAL_DAY_S = 86164.1
ROUNDING = 1e-12
ORBIT_DEG = 0.01  # in a day: the orbit's radius has five digits, its rate four decimals
RATE = (0.0, -GEO_RATE_DEG_H, 0.0)


@given(st.floats(0.0, 360.0, exclude_max=True))
def test_z_is_up_and_the_wings_lie_north_and_south(zenith_deg: float) -> None:
    rotation = earth_pointing(zenith_deg)
    up, north = direction_in_icrs(zenith_deg, 0.0), direction_in_icrs(0.0, 90.0)
    backward = -np.cross(north, up)  # GEO satellites fly east
    np.testing.assert_allclose(rotation @ up, [0.0, 0.0, 1.0], atol=ROUNDING)
    np.testing.assert_allclose(rotation @ north, [0.0, -1.0, 0.0], atol=ROUNDING)
    np.testing.assert_allclose(rotation @ backward, [1.0, 0.0, 0.0], atol=ROUNDING)


@given(st.floats(0.0, 300.0), st.floats(0.0, 7200.0))
def test_it_turns_as_its_zenith_wanders_east(zenith_deg: float, time_s: float) -> None:
    later = earth_pointing(zenith_deg + GEO_RATE_DEG_H * time_s / 3600.0)
    np.testing.assert_allclose(turned(earth_pointing(zenith_deg), RATE, time_s), later, atol=1e-9)


def test_after_a_sidereal_day_it_stands_as_before() -> None:
    start = earth_pointing(100.0)
    left = turned(start, RATE, SIDEREAL_DAY_S) @ start.T
    assert Rotation.from_matrix(left).magnitude() < np.deg2rad(ORBIT_DEG)


def test_a_quaternion_is_scalar_first() -> None:
    half = np.sqrt(0.5)
    found = rotation_from_wxyz((half, 0.0, 0.0, half)) @ [1.0, 0.0, 0.0]
    assert found == pytest.approx([0.0, 1.0, 0.0])
