from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given

from models.arrays import Floats
from models.errors import ScenarioError
from models.lights.sun import (
    ANGULAR_DIAMETER_DEG,
    NAMED_SUNS,
    PASSBAND_IRRADIANCE_W_M2,
    SUN_CASES_DEG,
    direction_from_azimuth,
    sun_direction,
    unit_direction,
)
from models.lights.sun_names import SUN_NAMES
from tests.support.strategies import vectors

ROUNDING = 1e-15
HALF, ROOT = 0.5, np.sqrt(0.5)
# Opromolla et al. 2022, Table 6, worked out by hand: azimuth clockwise from +y seen from +z.
EXPECTED = {
    "S1": [0.0, 0.0, 1.0],  # straight behind the chaser
    "S2": [-ROOT, 0.0, ROOT],
    "S3": [-1.0, 0.0, 0.0],  # grazing the face
    "S4": [-HALF, 0.0, -np.sqrt(3.0) / 2.0],  # below the face
    "S5": [ROOT, 0.0, ROOT],
    "S6": [np.sin(np.deg2rad(10.0)), 0.0, np.cos(np.deg2rad(10.0))],
}


@pytest.mark.parametrize("name", EXPECTED)
def test_the_papers_suns(name: str) -> None:
    np.testing.assert_allclose(sun_direction(name), EXPECTED[name], atol=ROUNDING)


def test_s6_and_s7_stand_10_and_15_deg_off_the_approach() -> None:
    for name, off_deg in (("S6", 10.0), ("S7", 15.0)):
        assert np.rad2deg(np.arccos(sun_direction(name)[2])) == pytest.approx(off_deg, abs=1e-12)


def test_s7_stands_over_plus_x_and_plus_y() -> None:
    x, y, _ = sun_direction("S7")
    assert np.rad2deg(np.arctan2(x, y)) == pytest.approx(67.0, abs=1e-12)


def test_azimuth_runs_clockwise_from_plus_y() -> None:
    np.testing.assert_allclose(direction_from_azimuth(0.0, 0.0), [0, 1, 0], atol=ROUNDING)
    np.testing.assert_allclose(direction_from_azimuth(90.0, 0.0), [1, 0, 0], atol=ROUNDING)


def test_names_are_read_however_they_are_typed() -> None:
    assert set(SUN_CASES_DEG) == {f"S{k}" for k in range(1, 8)}
    np.testing.assert_array_equal(sun_direction(" s4 "), sun_direction("S4"))


def test_a_typed_vector_is_scaled_to_length_one() -> None:
    np.testing.assert_allclose(sun_direction("0, 3, -4"), [0.0, 0.6, -0.8], atol=ROUNDING)


@given(vectors(1e300))
def test_any_vector_with_a_length_becomes_a_unit_vector_along_it(vector: Floats) -> None:
    assume(np.abs(vector).max() > 1e-6)
    direction = unit_direction(vector)
    assert np.linalg.norm(direction) == pytest.approx(1.0, abs=4 * ROUNDING)
    scaled = vector / np.abs(vector).max()
    np.testing.assert_allclose(direction * np.linalg.norm(scaled), scaled, atol=4 * ROUNDING)


@pytest.mark.parametrize("text", ["0,0,0", "0,0,1e-13"])
def test_a_sun_of_no_length_is_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match=r"with a length.*give the vector from the target"):
        sun_direction(text)


@pytest.mark.parametrize("text", ["1,0", "1,0,0,0", "nan,0,1", "inf,0,0"])
def test_a_sun_that_is_not_three_finite_numbers_is_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match="three finite numbers"):
        sun_direction(text)


@pytest.mark.parametrize("text", ["S8", "", "noon", "1;0;0"])
def test_an_unknown_sun_is_told_which_there_are(text: str) -> None:
    with pytest.raises(
        ScenarioError, match=r"S1 to S7, E-SB, E-S1 to E-S36 \(`rvbench list`\) or a vector x,y,z"
    ):
        sun_direction(text)


def test_the_words_for_all_suns_leave_none_out() -> None:
    """One text is shown wherever Suns are told of: in help, in start files, in the reference."""
    told: list[str] = []
    for part in SUN_NAMES.split(", "):
        first, _, last = part.partition(" to ")
        stem, start = first.rstrip("0123456789"), first.lstrip("ES-B")
        ends = range(int(start), int(last.removeprefix(stem)) + 1) if last else ()
        told += [f"{stem}{number}" for number in ends] if last else [first]
    assert told == list(NAMED_SUNS)


def test_the_disc_and_its_light() -> None:
    """From the Sun's radius and distance, and from Planck's law near 825 nm."""
    solar_radius_m, astronomical_unit_m, photosphere_k = 6.957e8, 1.495978707e11, 5772.0
    diameter_deg = np.rad2deg(2.0 * np.arcsin(solar_radius_m / astronomical_unit_m))
    assert pytest.approx(diameter_deg, abs=5e-4) == ANGULAR_DIAMETER_DEG  # three figures
    wavelength_m, h, c, k = 825e-9, 6.62607015e-34, 299792458.0, 1.380649e-23
    radiance = 2 * h * c**2 / wavelength_m**5 / np.expm1(h * c / (wavelength_m * k * photosphere_k))
    solid_angle = np.pi * np.sin(np.deg2rad(diameter_deg / 2.0)) ** 2
    black_body_w_m2 = radiance * solid_angle * 70e-9
    # The photosphere is brighter than its effective temperature's black body by some 7 % there.
    assert black_body_w_m2 == pytest.approx(PASSBAND_IRRADIANCE_W_M2, rel=0.1)
