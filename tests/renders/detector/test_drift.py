"""What lamps and lens become: against the definitions of power, slope, falloff and variance."""

import numpy as np
import pytest

from models.camera import Camera
from renders.detector.drift import Drift, drift_sigmas
from renders.detector.point_spread import blur
from renders.scenario.drift_table import DriftTable

CAMERA = Camera.from_fov(129, 129, 50.0)
WHOLE = (slice(0, 129), slice(0, 129))
RUNS = 400


def of(run: int, **shares: float) -> Drift:
    return Drift(run, DriftTable(**shares))


def test_nothing_drifts_without_a_table() -> None:
    assert Drift.of(None, 3) is None
    image = np.random.default_rng(1).uniform(size=(129, 129))
    still = of(5)
    np.testing.assert_array_equal(still.blurred(image, 0.5, CAMERA, WHOLE), blur(image, 0.5))
    assert (still.darkened(CAMERA, WHOLE) == 1.0).all()
    assert (still.of_lamp("lamps_850", CAMERA, WHOLE) == 1.0).all()


def test_a_lamps_power_is_even_over_the_field_and_spread_over_the_runs() -> None:
    factors = np.array(
        [of(run, lamp_power=0.1).of_lamp("lamps_850", CAMERA, WHOLE) for run in range(RUNS)]
    )
    assert np.ptp(factors, axis=(1, 2)).max() < 1e-12
    assert factors[:, 0, 0].std() == pytest.approx(0.1, rel=4.0 / np.sqrt(2.0 * RUNS))


def test_all_colours_of_a_lamp_drift_alike_and_two_rings_do_not() -> None:
    own = of(2, lamp_power=0.1)
    red, blue, other = (
        own.of_lamp(name, CAMERA, WHOLE)[0, 0]
        for name in ("floodlight_red", "floodlight_blue", "lamps_800")
    )
    assert red == blue != other


def test_a_slope_leaves_the_middle_as_it_was() -> None:
    factor = of(4, lamp_tilt=0.1).of_lamp("lamps_850", CAMERA, WHOLE)
    assert factor[64, 64] == pytest.approx(1.0)
    assert factor[64, 0] + factor[64, 128] == pytest.approx(2.0)
    assert abs(factor[64, 128] - 1.0) > 1e-3


def test_shares_are_one_sigma_over_the_runs_at_the_edge_and_the_corner() -> None:
    """A slope of each axis by itself, and a falloff: of a variance from Gaussian draws."""
    many, spread = range(RUNS), 4.0 / np.sqrt(2.0 * RUNS)
    edge = (CAMERA.width - 1) / CAMERA.width
    tilted = [of(run, lamp_tilt=0.1).of_lamp("lamps_850", CAMERA, WHOLE) for run in many]
    right, down = (np.array([each[place] for each in tilted]) for place in ((64, 128), (128, 64)))
    for own in (right, down):
        assert own.std() == pytest.approx(0.1 * edge, rel=spread)
        assert abs(own.mean() - 1.0) < 4.0 * 0.1 / np.sqrt(RUNS)
    assert abs(np.corrcoef(right, down)[0, 1]) < 4.0 / np.sqrt(RUNS)
    darkened = np.array(
        [of(run, vignetting=0.05).darkened(CAMERA, WHOLE)[[0, 64], [0, 0]] for run in many]
    )
    np.testing.assert_allclose(
        darkened.std(axis=0), 0.05 * edge**2 * np.array([1.0, 0.5]), rtol=spread
    )


def test_corners_darken_and_a_part_is_that_of_the_whole() -> None:
    own = of(1, vignetting=0.05)
    whole = own.darkened(CAMERA, WHOLE)
    assert whole[64, 64] == pytest.approx(1.0)
    assert np.abs(whole - 1.0).max() == np.abs(whole[0, 0] - 1.0)
    part = (slice(10, 20), slice(30, 50))
    np.testing.assert_array_equal(own.darkened(CAMERA, part), whole[part])


@pytest.mark.parametrize(("row", "column"), [(64, 64), (20, 20), (110, 64)])
def test_a_point_spreads_by_the_variance_between_middle_and_corner(row: int, column: int) -> None:
    own, point = of(7, blur=0.2, blur_over_field=0.2), np.zeros((129, 129))
    point[row, column] = 1.0
    spread = own.blurred(point, 1.0, CAMERA, WHOLE)
    across = np.arange(129) - column

    def variance(place: tuple[int, int]) -> float:
        alone = np.zeros((129, 129))
        alone[place] = 1.0
        image = own.blurred(alone, 1.0, CAMERA, WHOLE)
        return float((image.sum(axis=0) * (np.arange(129) - place[1]) ** 2).sum())

    share = 0.5 * ((2.0 * (column - 64) / 129) ** 2 + (2.0 * (row - 64) / 129) ** 2)
    between = variance((64, 64)) * (1.0 - share) + variance((126, 126)) * share
    # The corner is not quite reached, and the share varies over the kernel.
    assert (spread.sum(axis=0) * across**2).sum() == pytest.approx(between, rel=0.03)


def test_what_is_told_are_sigmas() -> None:
    told = drift_sigmas(DriftTable(lamp_power=0.1, blur=0.3, blur_over_field=0.4), 0.5)
    assert told == {"lamps.power": 0.1, "optics.psf_sigma_px": pytest.approx(0.25)}
    assert drift_sigmas(None, 0.5) == {}
