"""The Earth: a geostationary orbit turns with it, and its light has two limits in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from models.gravity.field import MU_M3_S2
from models.lights.earth import ALBEDO, EARTH_RADIUS_KM, GEO_RADIUS_KM, facing_share

SIDEREAL_DAY_S = 86_164.0905
PRINTED_KM = 0.05  # half of the last digit
FAR_KM, NEAR_KM = 1e8, EARTH_RADIUS_KM * (1.0 + 1e-6)
FAR_SHARE = 1e-3  # of the law, which is that of an infinite distance; quadrature takes 1e-4
NEAR_SHARE = 3e-3  # the horizon is 0.08 deg down, and seen at a slant


def test_a_geostationary_orbit_turns_once_in_a_sidereal_day() -> None:
    """Kepler's third law."""
    turned_km = 1e-3 * np.cbrt(MU_M3_S2 * (SIDEREAL_DAY_S / (2.0 * np.pi)) ** 2)
    assert pytest.approx(turned_km, abs=PRINTED_KM) == GEO_RADIUS_KM


@pytest.mark.parametrize("phase_deg", [0.0, 40.0, 90.0, 140.0])
def test_from_far_off_the_earth_is_a_lambert_sphere(phase_deg: float) -> None:
    """Russell 1916: 2/3 of albedo and radius squared at full phase, and the law of its phases."""
    phase = np.deg2rad(phase_deg)
    law = (np.sin(phase) + (np.pi - phase) * np.cos(phase)) / np.pi
    expected = 2.0 / 3.0 * ALBEDO * (EARTH_RADIUS_KM / FAR_KM) ** 2 * law
    assert facing_share(float(np.cos(phase)), FAR_KM) == pytest.approx(expected, rel=FAR_SHARE)


@pytest.mark.parametrize("zenith_deg", [0.0, 50.0])
def test_on_the_ground_it_is_a_matt_plane(zenith_deg: float) -> None:
    """A plane without end gives a face over it its albedo, times how squarely the Sun meets it."""
    cosine = float(np.cos(np.deg2rad(zenith_deg)))
    assert facing_share(cosine, NEAR_KM) == pytest.approx(ALBEDO * cosine, rel=NEAR_SHARE)


@pytest.mark.parametrize("radius_km", [6878.0, GEO_RADIUS_KM])
def test_it_gives_less_the_less_of_it_is_lit_and_nothing_when_new(radius_km: float) -> None:
    phases = [facing_share(float(np.cos(angle)), radius_km) for angle in np.linspace(0, np.pi, 9)]
    assert phases == sorted(phases, reverse=True)
    assert phases[-1] == pytest.approx(0.0, abs=1e-12)
