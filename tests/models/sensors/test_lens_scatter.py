"""Sunlight that a lens scatters: the law in closed form, and the hood."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from models.sensors.camera_chip import Optics
from models.sensors.lens_scatter import LensScatter

CLEAN = LensScatter(peak_1_sr=10.0)
OPTICS = Optics(f_number=16.0, transmission=0.8)


def cosine(off_axis_deg: float) -> np.ndarray:
    return np.array(np.cos(np.deg2rad(off_axis_deg)))


def test_the_law_by_hand() -> None:
    """At the shoulder a square law is down to a half, at 30 deg to 1 / (1 + (0.5 / sin)^2)."""
    assert CLEAN.scattered(cosine(0.0)) == pytest.approx(10.0)
    assert CLEAN.scattered(cosine(0.6)) == pytest.approx(5.0, rel=1e-9)
    expected = 10.0 / (1.0 + (0.5 / np.sin(np.deg2rad(0.6))) ** 2)
    assert CLEAN.scattered(cosine(30.0)) == pytest.approx(expected, rel=1e-9)
    assert expected == pytest.approx(4.4e-3, rel=0.01)
    assert CLEAN.scattered(cosine(90.0001)) == 0.0


@given(slope=st.floats(0.5, 3.5), shoulder_deg=st.floats(0.05, 2.0))
def test_far_out_it_falls_by_its_slope(slope: float, shoulder_deg: float) -> None:
    scatter = replace(CLEAN, slope=slope, shoulder_deg=shoulder_deg)
    near, far = np.deg2rad([25.0, 80.0])
    found = scatter.scattered(np.cos(near)) / scatter.scattered(np.cos(far))
    power = (np.sin(far) / np.sin(near)) ** slope
    shoulder = (np.sin(np.deg2rad(shoulder_deg)) / np.sin(near)) ** 2
    assert found == pytest.approx(power, rel=0.5 * slope * shoulder + 1e-9)


def test_all_that_a_clean_lens_scatters_is_a_few_percent() -> None:
    """Integrated over the half space by scipy, and in closed form for a slope of two."""
    found = quad(
        lambda angle: float(CLEAN.scattered(np.cos(angle)) * np.cos(angle) * np.sin(angle)),
        0.0,
        np.pi / 2.0,
        points=[0.01, 0.1],
        limit=200,
    )[0]
    shoulder2 = np.sin(np.deg2rad(0.6)) ** 2
    expected = 10.0 * np.pi * shoulder2 * np.log(1.0 + 1.0 / shoulder2)
    assert 2.0 * np.pi * found == pytest.approx(expected, rel=1e-6)
    assert 0.02 < expected < 0.05


def test_point_source_transmittance_by_hand() -> None:
    """Solid angle of the lens seen from the chip, times scatter, times the lens's slant."""
    solid_angle = 0.8 * np.pi / (4.0 * 256.0)
    for angle in (0.0, 5.0, 26.0, 70.0):
        expected = solid_angle * np.cos(np.deg2rad(angle)) * float(CLEAN.scattered(cosine(angle)))
        assert CLEAN.point_source_transmittance(OPTICS, angle) == pytest.approx(expected)
    assert CLEAN.point_source_transmittance(OPTICS, 30.0) == pytest.approx(9.3e-6, rel=0.02)
    wide = replace(OPTICS, f_number=8.0)
    assert CLEAN.point_source_transmittance(wide, 30.0) == pytest.approx(3.7e-5, rel=0.02)


def test_a_hood_shades_a_sun_beyond_its_cut_off() -> None:
    hooded = replace(CLEAN, hood_deg=40.0, hood_leak=1e-3)
    bare = CLEAN.point_source_transmittance
    assert hooded.point_source_transmittance(OPTICS, 39.9) == bare(OPTICS, 39.9)
    for angle in (40.0, 60.0, 89.0):
        found = hooded.point_source_transmittance(OPTICS, angle)
        assert found == pytest.approx(1e-3 * bare(OPTICS, angle))
    assert replace(hooded, hood_leak=0.0).point_source_transmittance(OPTICS, 45.0) == 0.0
    assert [hooded.point_source_transmittance(OPTICS, angle) for angle in (90.0, 120.0)] == [0, 0]
