"""Sun grids are even, whole and can be typed back; lists of Suns say what they cannot read."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import ScenarioError
from models.lights.sun import SUN_CASES_DEG, direction_from_azimuth, sun_direction
from models.lights.sun_grid import azimuth_elevation_deg, chosen_suns, read_sun, sun_at, sun_grid

STEPS_DEG = [10.0, 15.0, 22.5, 30.0, 45.0]
TYPED_RAD = 2e-6  # six digits of each component


def directions(step_deg: float) -> np.ndarray:
    return np.array([sun.direction_in_target for sun in sun_grid(step_deg)])


def test_fifteen_degrees_are_some_two_hundred_suns():
    """A sphere holds 41253 square degrees: 183 of 15 x 15, and each ring is rounded up."""
    assert len(sun_grid(15.0)) == 188
    assert len(sun_grid(45.0)) == 1 + 6 + 8 + 6 + 1
    assert len(sun_grid(90.0)) == 1 + 4 + 1


@pytest.mark.parametrize("step_deg", STEPS_DEG)
def test_no_direction_is_farther_than_a_cell_from_a_sun(step_deg):
    """Random directions lie within half a cell's diagonal of a Sun, and every Sun is needed."""
    grid = directions(step_deg)
    asked = np.random.default_rng(1).standard_normal((20_000, 3))
    asked /= np.linalg.norm(asked, axis=1, keepdims=True)
    cosine = asked @ grid.T
    nearest_deg = np.rad2deg(np.arccos(np.clip(cosine.max(axis=1), -1.0, 1.0)))
    assert nearest_deg.max() < step_deg / np.sqrt(2.0) + 1e-6
    # Shares of the sphere: each Sun's is near the mean. Rings rounded up, and the poles' caps,
    # account for the rest; a plain grid of azimuth and elevation has shares of 0 to 1.6.
    share = np.bincount(cosine.argmax(axis=1), minlength=len(grid)) / len(asked) * len(grid)
    assert share.min() > 0.5
    assert share.max() < 1.6


@pytest.mark.parametrize("step_deg", STEPS_DEG)
def test_neighbours_of_a_ring_are_no_farther_apart_than_the_step(step_deg):
    rings: dict[float, list[float]] = {}
    for sun in sun_grid(step_deg):
        rings.setdefault(sun.elevation_deg, []).append(sun.azimuth_deg)
    assert sorted(rings) == pytest.approx(np.arange(-90.0, 90.1, step_deg))
    for elevation_deg, azimuths_deg in rings.items():
        apart_deg = 360.0 / len(azimuths_deg) * np.cos(np.deg2rad(elevation_deg))
        assert apart_deg <= step_deg * (1.0 + 1e-9)
        assert np.ptp(np.diff(azimuths_deg)) < 1e-9 if len(azimuths_deg) > 1 else True
    assert len(rings[90.0]) == len(rings[-90.0]) == 1


@pytest.mark.parametrize("step_deg", [0.0, -15.0, 0.5, 7.0, 100.0, 180.0, np.nan, np.inf])
def test_a_step_that_cannot_be_is_refused_with_one_that_can(step_deg):
    with pytest.raises(ScenarioError, match="is the nearest") as refused:
        sun_grid(step_deg)
    sun_grid(float(str(refused.value).split("; ")[-1].split(" is ")[0]))


@given(st.floats(0.0, 359.0), st.floats(-89.0, 89.0))
def test_a_sun_typed_from_its_text_is_the_same_to_the_bit(azimuth_deg, elevation_deg):
    sun = sun_at(azimuth_deg, elevation_deg)
    np.testing.assert_array_equal(sun.direction_in_target, sun_direction(sun.text))
    exact = direction_from_azimuth(azimuth_deg, elevation_deg)
    assert np.linalg.norm(sun.direction_in_target - exact) < TYPED_RAD
    found = azimuth_elevation_deg(sun.direction_in_target)
    np.testing.assert_allclose(direction_from_azimuth(*found), exact, atol=TYPED_RAD)


def test_azimuth_of_a_pole_is_zero():
    for z in (1.0, -1.0):
        assert azimuth_elevation_deg(np.array([0.0, 0.0, z])) == (0.0, 90.0 * z)
    assert sun_at(123.0, 90.0) == sun_at(0.0, 90.0)
    assert "-0" not in sun_at(180.0, 0.0).text.replace("-0.", "")


def test_lists_of_suns():
    assert [sun.name for sun in chosen_suns(("paper",))] == list(SUN_CASES_DEG)
    assert [sun.name for sun in chosen_suns(("s1,S3", "S6"))] == ["S1", "S3", "S6"]
    mixed = chosen_suns(("0,0,2", "270/45,S3", "-1,0,0"))
    assert [sun.name for sun in mixed] == ["0/90", "270/45", "S3"]  # the last is S3
    np.testing.assert_allclose(mixed[1].direction_in_target, sun_direction("S2"), atol=TYPED_RAD)
    assert len(chosen_suns(("S1", "S1,S1"))) == 1
    assert read_sun("0.2,-0.5,1").text == "0.2,-0.5,1"


@pytest.mark.parametrize("text", ["S9", "S1,S9", "1,2", "0,0,0", "12/", "0/91", "nan/0", "a/b"])
def test_what_is_no_sun_is_refused(text):
    with pytest.raises(ScenarioError, match="expected a Sun"):
        chosen_suns((text,))
    with pytest.raises(ScenarioError, match="at least one Sun"):
        chosen_suns(())
