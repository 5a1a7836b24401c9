"""Disturbances against slopes of potentials, areas counted out, and what a table's maker knew."""

from __future__ import annotations

import numpy as np
import pytest

from models.gravity import disturbances as tested
from models.gravity.field import MU_M3_S2
from models.sky.moon_ephemeris import MOON_MU_M3_S2
from models.sky.sun_ephemeris import ASTRONOMICAL_UNIT_M

SUN = ASTRONOMICAL_UNIT_M * np.array([0.36, 0.48, 0.8])
ANYWHERE = np.array([4.1e6, -3.9e6, 5.2e6])


def test_constants_are_those_of_the_iau_and_of_wgs_84() -> None:
    """Sun's GM and radius (IAU 2015 B3), light's pressure at 1 au, and the ellipsoid."""
    assert pytest.approx(1.3271244e20, rel=1e-7) == tested.SUN_MU_M3_S2
    assert pytest.approx(6.957e8, rel=1e-9) == tested.SUN_RADIUS_M
    solar_constant, light_m_s = 1366.1, 299_792_458.0  # ASTM E490
    assert pytest.approx(solar_constant / light_m_s, rel=2e-3) == tested.SOLAR_PRESSURE_N_M2
    polar_m = 6_356_752.3142
    assert pytest.approx(6_378_137.0, abs=1e-6) == tested.EARTH_RADIUS_M
    found_m = tested.EARTH_RADIUS_M * (1.0 - tested.EARTH_FLATTENING)
    assert found_m == pytest.approx(polar_m, abs=1e-3)


@pytest.mark.parametrize("mu_m3_s2", [1.0e20])
def test_a_third_body_pulls_by_the_slope_of_its_disturbing_function(mu_m3_s2: float) -> None:
    """R = mu (1 / |s - r| - r s / |s|^3), with a body near enough that no term is small."""
    body = np.array([1.1e7, 2.3e7, -1.7e7])

    def function(place: np.ndarray) -> float:
        apart, far = np.linalg.norm(body - place), np.linalg.norm(body)
        return float(mu_m3_s2 * (1.0 / apart - place @ body / far**3))

    slope = [
        (function(ANYWHERE + step) - function(ANYWHERE - step)) / 20.0 for step in 10.0 * np.eye(3)
    ]
    found = tested.third_body(ANYWHERE, body, mu_m3_s2)
    np.testing.assert_allclose(found, slope, rtol=1e-5)
    both = tested.third_body(np.stack([ANYWHERE, -ANYWHERE]), body, mu_m3_s2)
    np.testing.assert_allclose(both[0], found)


@pytest.mark.parametrize("share_of_disc", [-0.9, -0.4, 0.0, 0.3, 0.8])
@pytest.mark.parametrize("radius_m", [6.8e6, 4.2e7])
def test_what_is_seen_of_the_sun_is_what_points_of_its_disc_say(
    share_of_disc: float, radius_m: float
) -> None:
    """A plane drawing of two discs, dotted; the formula's own approximation is that it is plane."""
    sun_rad = np.arcsin(tested.SUN_RADIUS_M / ASTRONOMICAL_UNIT_M)
    earth_rad = np.arcsin(tested.EARTH_RADIUS_M / radius_m)
    angle = earth_rad + share_of_disc * sun_rad  # between the two centres
    sun = np.array([ASTRONOMICAL_UNIT_M, 0.0, 0.0])
    place = radius_m * np.array([-np.cos(angle), 0.0, np.sin(angle)])
    to_sun = sun - place
    apart = np.arccos(-(place @ to_sun) / (radius_m * np.linalg.norm(to_sun)))
    grid = (np.arange(-400, 400) + 0.5) / 400.0
    x, y = np.meshgrid(grid, grid)
    of_sun = x**2 + y**2 <= 1.0
    covered = (x * sun_rad + apart) ** 2 + (y * sun_rad) ** 2 <= earth_rad**2
    expected = 1.0 - (of_sun & covered).sum() / of_sun.sum()
    assert tested.sunlit_share(place, sun) == pytest.approx(expected, abs=2e-3)


def test_light_weakens_with_the_square_and_pushes_straight_away() -> None:
    near, far = (
        tested.solar_pressure(ANYWHERE, scale * SUN + ANYWHERE, 0.02) for scale in (1.0, 3.0)
    )
    np.testing.assert_allclose(near, -0.02 * tested.SOLAR_PRESSURE_N_M2 * SUN / 149597870700.0)
    np.testing.assert_allclose(far, near / 9.0)


def test_air_brakes_by_half_its_density_times_the_square() -> None:
    """Along the way through air that turns eastward with the Earth: 7.292e-5 rad/s."""
    velocity = np.array([1.0e3, -7.0e3, 2.0e3])
    through = velocity - np.cross([0.0, 0.0, 7.292115e-5], ANYWHERE)
    found = tested.drag(ANYWHERE, velocity, 3e-12, 0.02)
    expected = -0.5 * 3e-12 * 0.02 * np.linalg.norm(through) * through
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_height_is_counted_from_the_ellipsoid() -> None:
    """At its pole and half-way up; along the radius, as the textbook counts."""
    sun = np.array([1.0, 0.0, 0.0])
    equator, pole = 6_378_137.0, 6_356_752.3142
    for latitude_deg in (0.0, 45.0, 90.0):
        s, c = np.sin(np.deg2rad(latitude_deg)), np.cos(np.deg2rad(latitude_deg))
        ground = 1.0 / np.hypot(c / equator, s / pole)
        place = (ground + 500e3) * np.array([-c, 0.0, s])
        above = place * (1.0 + 1e-9)
        # At 500 km the table has a row; below and above it the density is the same.
        density = tested.air_density(place, sun)
        assert density == pytest.approx(tested.air_density(above, sun), rel=1e-6)
        cosine = place @ [np.cos(np.deg2rad(30.0)), 0.5, 0.0] / np.linalg.norm(place)
        weight = (0.5 + 0.5 * cosine) ** 3
        expected = 1e-12 * (0.3916 + (2.042 - 0.3916) * weight)
        assert density == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("column", [1, 2])
def test_density_falls_as_smoothly_as_an_atmosphere(column: int) -> None:
    """Each row of the table lies on the quartic of its five nearest, in logarithm.

    Printed to four digits, so to 5e-4; a row that is one percent off stands out. Above 800 km its
    maker changed his formula and his step.
    """
    height, density = tested.DENSITY[:, 0], np.log(tested.DENSITY[:, column])
    for row in range(len(height) - 7):
        near = np.argsort(np.abs(height - height[row]), kind="stable")[1:6]
        quartic = np.polyfit((height[near] - height[row]) / 100.0, density[near], 4)
        assert quartic[-1] == pytest.approx(density[row], abs=2e-3), height[row]
    scale_km = -np.diff(height) / np.diff(density)
    assert (np.diff(scale_km)[:18] > 0.0).all()
    assert (scale_km[19:] > 90.0).all()
    assert (np.diff(height)[:20] == 20.0).all()
    assert (np.diff(height)[20:] == 40.0).all()
    assert height[0] == 400.0


def test_density_between_rows_is_exponential() -> None:
    """On the axis of the bulge, where but one of the two densities counts: behind, and before."""
    bulge = np.array([np.cos(np.deg2rad(30.0)), 0.5, 0.0])
    for side in (-1.0, 1.0):
        low, middle, high = (
            tested.air_density(side * (6_378_137.0 + height) * bulge, np.array([1.0, 0.0, 0.0]))
            for height in (560e3, 570e3, 580e3)
        )
        assert middle == pytest.approx(np.sqrt(low * high), rel=1e-9)
        assert low / high == pytest.approx(1.3, abs=0.07)


def test_the_moon_has_an_eightieth_of_the_earths_mass() -> None:
    """Mass ratio of DE430: 81.30057."""
    assert pytest.approx(81.30057, rel=1e-5) == MU_M3_S2 / MOON_MU_M3_S2
