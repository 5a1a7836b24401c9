from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.lights.led_beam import LAMPS_800, LAMPS_850, LedRing

LARGEST_OFFSET_M = 0.05  # beyond it a cube corner's return misses the lens
RING_SHARE_AT_100_M = 1e-6  # (3 cm / 100 m)^2 is 1e-7: the ring is a point
FACING = [[0.0, 0.0, -1.0]]


@pytest.mark.parametrize("half_deg", [10.0, 25.0, 60.0])
def test_the_beam_has_half_its_intensity_at_the_half_angle(half_deg: float) -> None:
    ring = LedRing(850.0, half_intensity_deg=half_deg)
    assert ring.relative_intensity(np.cos(np.deg2rad(half_deg))) == pytest.approx(0.5, abs=1e-14)
    assert ring.relative_intensity(1.0) == 1.0


def test_the_lamps_are_half_as_bright_25_deg_off_axis() -> None:
    for lamps in (LAMPS_800, LAMPS_850):
        assert lamps.relative_intensity(np.cos(np.deg2rad(25.0))) == pytest.approx(0.5, abs=1e-14)
        assert lamps.intensity_w_sr == 12.0


def test_sixty_degrees_is_lamberts_law() -> None:
    assert LedRing(850.0, half_intensity_deg=60.0).exponent == pytest.approx(1.0, abs=1e-14)


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_the_beam_falls_off_axis_and_sends_nothing_backwards(a: float, b: float) -> None:
    low, high = sorted((a, b))
    dim, bright = LAMPS_850.relative_intensity([low, high])
    assert 0.0 <= dim <= bright <= 1.0
    if high <= 0.0:
        assert bright == 0.0


def test_both_wavelengths_stand_in_one_ring_close_to_the_lens_interleaved() -> None:
    rings = [LAMPS_800.points_in_cam, LAMPS_850.points_in_cam]
    for points in rings:
        np.testing.assert_allclose(np.linalg.norm(points, axis=1), LAMPS_850.radius_m)
        np.testing.assert_allclose(points.mean(axis=0), 0.0, atol=1e-16)
        assert (points[:, 2] == 0.0).all()
    assert LAMPS_850.radius_m <= LARGEST_OFFSET_M
    both = np.concatenate(rings)
    angles_deg = np.sort(np.rad2deg(np.arctan2(both[:, 1], both[:, 0])))
    np.testing.assert_allclose(np.diff(angles_deg), 360.0 / len(both), atol=1e-9)
    assert (LAMPS_800.wavelength_nm, LAMPS_850.wavelength_nm) == (800.0, 850.0)


@given(st.floats(0.1, 50.0))
def test_irradiance_on_the_axis_is_the_closed_form_of_a_ring(range_m: float) -> None:
    """All LEDs are alike from the axis: I0 cos^(n+1)(theta) / d^2, theta seen from each."""
    distance = np.hypot(range_m, LAMPS_850.radius_m)
    cosine = range_m / distance
    expected = LAMPS_850.intensity_w_sr * cosine ** (LAMPS_850.exponent + 1.0) / distance**2
    found = LAMPS_850.irradiance([[0.0, 0.0, range_m]], FACING)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@given(st.floats(0.0, 50.0), st.floats(0.0, 360.0), st.floats(0.0, 89.0))
def test_far_away_the_ring_is_a_point_lamp_with_inverse_square(
    off_deg: float, round_deg: float, tilt_deg: float
) -> None:
    off, turn, tilt = np.deg2rad([off_deg, round_deg, tilt_deg])
    ray = np.array([np.sin(off) * np.cos(turn), np.sin(off) * np.sin(turn), np.cos(off)])
    across = np.array([np.cos(off) * np.cos(turn), np.cos(off) * np.sin(turn), -np.sin(off)])
    normal = -np.cos(tilt) * ray + np.sin(tilt) * across
    near = LAMPS_850.irradiance([100.0 * ray], [normal])
    far = LAMPS_850.irradiance([200.0 * ray], [normal])
    expected = 12.0 * np.cos(off) ** LAMPS_850.exponent * np.cos(tilt) / 100.0**2
    # The ring's first moment vanishes by symmetry, its second is (radius / distance)^2.
    slope = 1.0 / np.cos(tilt) ** 2 + LAMPS_850.exponent**2 / np.cos(off) ** 2
    np.testing.assert_allclose(near, expected, rtol=RING_SHARE_AT_100_M * slope)
    np.testing.assert_allclose(near / far, 4.0, rtol=RING_SHARE_AT_100_M * slope)


def test_a_face_turned_away_and_a_point_behind_get_nothing() -> None:
    found = LAMPS_850.irradiance(
        [[0.0, 0.0, 2.0], [0.0, 0.0, -2.0]], [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]
    )
    np.testing.assert_array_equal(found, [0.0, 0.0])


def test_power_through_a_sphere_is_the_beams_integral() -> None:
    """The LEDs' power is 2 pi I0 / (n + 1): integrate the irradiance over a large hemisphere."""
    cosines, weights = np.polynomial.legendre.leggauss(64)
    cosines, weights = 0.5 * (cosines + 1.0), 0.5 * weights
    sines = np.sqrt(1.0 - cosines**2)
    radius = 100.0
    directions = np.stack([sines, np.zeros_like(sines), cosines], axis=-1)
    irradiance = LAMPS_850.irradiance(radius * directions, -directions)
    power_w = 2.0 * np.pi * radius**2 * (weights * irradiance).sum()
    expected_w = 2.0 * np.pi * LAMPS_850.intensity_w_sr / (LAMPS_850.exponent + 1.0)
    assert power_w == pytest.approx(expected_w, rel=1e-5)  # a ring of 3 cm seen at 100 m
