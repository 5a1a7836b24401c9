"""How much of the Sun is seen past the Earth, against limiting cases and areas counted out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.gravity.disturbances import sunlit_share
from models.lights.earth import EARTH_RADIUS_KM
from models.lights.eclipse import (
    PENUMBRA,
    SUNLIT,
    UMBRA,
    free_share,
    lighting,
    share_past_earth,
)
from models.sky.sun_ephemeris import ASTRONOMICAL_UNIT_M

SUN_RAD = np.deg2rad(0.2665)
COUNTED = 2e-3  # of a disc, by 800 x 800 dots
ROUNDING = 1e-9
STRAIGHT = 1e-3  # of the disc, cut by a limb whose radius is a thousand times its own
RADII = st.floats(0.01, 1.0)


def test_full_light_beside_and_none_behind() -> None:
    assert free_share(0.31, 0.1, 0.2) == 1.0
    assert free_share(0.1, 0.1, 0.2) == 0.0
    assert free_share(0.0, 0.1, 0.1) == 0.0


def test_a_small_cover_leaves_a_ring() -> None:
    assert free_share(0.02, 0.1, 0.05) == pytest.approx(0.75, abs=ROUNDING)


def test_a_straight_limb_through_the_middle_leaves_half() -> None:
    assert free_share(1000.0, 1.0, 1000.0) == pytest.approx(0.5, abs=STRAIGHT)


@pytest.mark.parametrize("height", [-0.7, -0.2, 0.4, 0.9])
def test_a_straight_limb_leaves_a_segment(height: float) -> None:
    """Above a height h over the middle of a unit disc: (arccos h - h sqrt(1 - h^2)) / pi."""
    above = (np.arccos(height) - height * np.sqrt(1.0 - height**2)) / np.pi
    assert free_share(1e4 - height, 1.0, 1e4) == pytest.approx(above, abs=STRAIGHT)


@given(RADII, st.floats(0.001, 1.999))
def test_two_equal_discs_share_the_textbooks_lens(radius: float, apart: float) -> None:
    """2 r^2 arccos(d / 2r) - d / 2 sqrt(4 r^2 - d^2)."""
    d = apart * radius
    lens = 2.0 * radius**2 * np.arccos(d / (2.0 * radius))
    lens -= 0.5 * d * np.sqrt(4.0 * radius**2 - d**2)
    expected = 1.0 - lens / (np.pi * radius**2)
    assert free_share(d, radius, radius) == pytest.approx(expected, abs=1e-6)


@given(RADII, RADII, st.floats(0.0, 2.5), st.floats(0.0, 0.5))
def test_farther_apart_is_no_darker(disc: float, cover: float, apart: float, more: float) -> None:
    near, far = free_share(apart, disc, cover), free_share(apart + more, disc, cover)
    assert -ROUNDING <= near <= far + 1e-7
    assert far <= 1.0 + ROUNDING


@given(RADII, RADII, st.floats(0.0, 2.5))
def test_what_each_hides_of_the_other_is_one_area(one: float, other: float, apart: float) -> None:
    hidden = (1.0 - free_share(apart, one, other)) * one**2
    assert hidden == pytest.approx((1.0 - free_share(apart, other, one)) * other**2, abs=1e-7)


@pytest.mark.parametrize("distance_km", [6778.0, 7143.1, 42164.0])
@pytest.mark.parametrize("sun_radii", [-0.8, -0.3, 0.0, 0.5])
def test_a_disc_of_rays_past_a_ball_says_the_same(distance_km: float, sun_radii: float) -> None:
    """Rays to places of the Sun's disc either meet the Earth's ball or not: no plane drawing."""
    limb = np.arcsin(EARTH_RADIUS_KM / distance_km)
    off = limb + sun_radii * SUN_RAD
    down = np.array([0.0, 0.0, 1.0])
    sun = np.array([np.sin(off), 0.0, np.cos(off)])
    across = np.array([np.cos(off), 0.0, -np.sin(off)])
    grid = (np.arange(-400, 400) + 0.5) / 400.0
    x, y = np.meshgrid(grid, grid)
    inside = x**2 + y**2 <= 1.0
    rays = sun + np.tan(SUN_RAD) * (
        x[inside][:, None] * across + y[inside][:, None] * np.array([0.0, 1.0, 0.0])
    )
    cosines = rays @ down / np.linalg.norm(rays, axis=1)
    met = distance_km * np.sqrt(1.0 - cosines**2) < EARTH_RADIUS_KM
    found = share_past_earth(sun, down, distance_km, SUN_RAD)
    assert found == pytest.approx(1.0 - met.mean(), abs=COUNTED)


def test_light_and_its_pressure_go_by_one_share() -> None:
    """That of two directions is that of two places."""
    place = 7.0e6 * np.array([-np.cos(1.15), np.sin(1.15), 0.0])
    sun = np.array([ASTRONOMICAL_UNIT_M, 0.0, 0.0])
    for turn in np.linspace(-0.01, 0.01, 9):
        c, s = np.cos(turn), np.sin(turn)
        at = np.array([c * place[0] - s * place[1], s * place[0] + c * place[1], 0.0])
        towards = (sun - at) / np.linalg.norm(sun - at)
        radius_rad = float(np.arcsin(6.957e8 / np.linalg.norm(sun - at)))
        found = share_past_earth(towards, -at / 7.0e6, 7.0e3, radius_rad)
        assert found == pytest.approx(sunlit_share(at, sun), abs=ROUNDING)


def test_shares_have_names() -> None:
    assert [lighting(share) for share in (0.0, 0.3, 1.0)] == [UMBRA, PENUMBRA, SUNLIT]
