"""Records of a flight by hand: what is measured without draws, and by how much one moves it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.gnss.range_errors import RangeErrors
from models.gnss.receiver_clock import ReceiverClock
from models.gnss.signal_path import ionospheric_delay_m
from models.gnss.tracking_noise import TrackingLoops
from models.navigation_records import coned_turn
from models.quaternions import from_rotation_vector, multiplied, to_rotation_vector
from models.sensors.inertial_unit import InertialUnit
from models.sensors.star_sensor import StarSensor
from renders.flight import sensing
from renders.flight.faults import Faults
from renders.flight.sensing import Sensors

SENSORS = Sensors(
    InertialUnit(), StarSensor(), TrackingLoops(), RangeErrors(), ReceiverClock(), Faults()
)
CN0 = np.array([45.0, 38.0, 41.0])
SENDERS = np.array(
    [
        [2.6e7, 0.0, 1.0e6, 100.0, 3800.0, -50.0], [0.0, 2.6e7, 0.0, -3800.0, 0.0, 20.0],
        [1.0e7, 1.5e7, 1.9e7, 10.0, -900.0, 2800.0],
    ]
)  # fmt: skip
LOW = np.array(
    [[6.9e6, 1.0e5, -3.0e5, 200.0, 7400.0, 900.0], [6.9e6, 2.0e5, -3.0e5, 200.0, 7400.0, 0.0]]
)
TRACKED = np.array([2, 0])


def epoch(state: np.ndarray, clock: np.ndarray, draws: np.ndarray, off_m: np.ndarray):
    return sensing._epoch(SENSORS, 7.0, TRACKED, CN0, SENDERS, state, clock, draws, off_m)


def test_ranges_are_distances_and_rates_their_slopes_with_the_clock() -> None:
    clock = np.array([[12.0, 0.3], [-5.0, 0.1]])
    found = epoch(LOW, clock, np.zeros((2, 3, 3)), np.zeros((2, 3)))
    assert found.time_s == 7.0
    np.testing.assert_array_equal(found.satellite, TRACKED)
    np.testing.assert_array_equal(found.cn0_dbhz, CN0[TRACKED])
    np.testing.assert_array_equal(found.sent_from_m, SENDERS[TRACKED, :3])
    np.testing.assert_array_equal(found.sent_at_m_s, SENDERS[TRACKED, 3:])
    for run in range(2):
        for column, sender in enumerate(SENDERS[TRACKED]):
            away = [
                np.linalg.norm(LOW[run, :3] + t * LOW[run, 3:] - sender[:3] - t * sender[3:])
                for t in (-1e-2, 0.0, 1e-2)
            ]
            assert found.pseudorange_m[run, column] == pytest.approx(away[1] + clock[run, 0])
            rate = (away[2] - away[0]) / 2e-2
            told = found.range_rate_m_s[run, column]
            assert told == pytest.approx(rate + clock[run, 1], abs=1e-5)


@pytest.mark.parametrize("kind", [0, 1, 2, 3])
def test_each_draw_moves_a_range_by_its_own_sigma(kind: int) -> None:
    """Code noise, what is new at every epoch, frequency noise, and what lasts as it comes."""
    draws, off_m = np.zeros((2, 3, 3)), np.zeros((2, 3))
    one = np.array([[1.0, -2.0, 0.5], [0.3, 0.7, -1.1]])
    if kind < 3:
        draws[:, kind] = one
    else:
        off_m[:] = one
    still = epoch(LOW, np.zeros((2, 2)), np.zeros((2, 3, 3)), np.zeros((2, 3)))
    moved = epoch(LOW, np.zeros((2, 2)), draws, off_m)
    own, cn0 = one[:, TRACKED], CN0[TRACKED]
    loops = SENSORS.loops
    sigmas = [loops.code_sigma_m(cn0), SENSORS.errors.white_m, loops.rate_sigma_m_s(cn0), 1.0]
    ranges = moved.pseudorange_m - still.pseudorange_m
    rates = moved.range_rate_m_s - still.range_rate_m_s
    np.testing.assert_allclose(ranges, 0.0 if kind == 2 else own * sigmas[kind], atol=1e-7)
    np.testing.assert_allclose(rates, own * sigmas[kind] if kind == 2 else 0.0, atol=1e-9)


@pytest.mark.parametrize(("radius_m", "late"), [(1.99e7, False), (2.01e7, True), (4.2e7, True)])
def test_high_orbits_meet_the_ionosphere(radius_m: float, late: bool) -> None:
    """Where a signal that grazes the Earth comes from the other side of it."""
    state = np.zeros((2, 6))
    state[:, 0] = radius_m
    places = [[-2.0e7, 1.3e7, 0.0], [2.6e7, 1.0, 0.0], [-2.0e7, 1.0e7, 0.0]]
    senders = np.column_stack([places, np.zeros((3, 3))])
    nothing = np.zeros((2, 2)), np.zeros((2, 3, 3)), np.zeros((2, 3))
    found = sensing._epoch(SENSORS, 0.0, np.arange(3), CN0, senders, state, *nothing)
    distance = np.linalg.norm(senders[:, :3] - state[0, :3], axis=1)
    expected = ionospheric_delay_m(np.tile(state[0, :3], (3, 1)), senders[:, :3])
    assert expected.max() > 10.0
    longer = found.pseudorange_m[0] - distance
    np.testing.assert_allclose(longer, expected if late else 0.0, atol=1e-6)


def test_a_frames_samples_are_records_of_their_own_or_one_sum() -> None:
    measured = 1e-3 * np.random.default_rng(1).standard_normal((2, 4, 3))
    (whole,) = [record for record, _ in sensing._inertial(SENSORS, measured, 3.0, 0.4)]
    assert (whole.time_s, whole.duration_s) == (3.0, 0.4)
    np.testing.assert_allclose(whole.turn_rad, coned_turn(measured))
    each = replace(SENSORS, each_sample=True, unit=replace(SENSORS.unit, rate_hz=10.0))
    parts = [record for record, _ in sensing._inertial(each, measured, 3.0, 0.4)]
    assert [round(part.time_s, 9) for part in parts] == [2.7, 2.8, 2.9, 3.0]
    assert {part.duration_s for part in parts} == {0.1}
    for place, part in enumerate(parts):
        np.testing.assert_array_equal(part.turn_rad, measured[:, place])


def test_draws_are_keyed_by_run_sensor_and_block() -> None:
    both = sensing._draws(5, (3, 8), 2, 4, (6,))
    assert both.shape == (2, 6)
    np.testing.assert_array_equal(both[1:], sensing._draws(5, (8,), 2, 4, (6,)))
    keys = ((6, (3,), 2, 4), (5, (3,), 1, 4), (5, (3,), 2, 5))
    others = [sensing._draws(*key, (6,)) for key in keys]
    assert all((other != both[0]).all() for other in others)
    many = sensing._draws(5, (1,), 0, 0, (4000,))
    assert abs(many.mean()) < 0.06
    assert many.std() == pytest.approx(1.0, abs=0.05)


def test_a_star_sensor_errs_by_its_data_sheet() -> None:
    """Draws times its sigmas, about its own axes: the covariance that it tells."""
    truth = from_rotation_vector(np.array([0.3, -0.7, 1.1]))
    rng = np.random.default_rng(2)
    draws = rng.standard_normal((3000, 3))
    found = sensing._star_attitude(SENSORS, 2.0, truth, draws, np.zeros((3000, 4, 3)), 0.25)
    assert found is not None
    assert found.time_s == 2.0
    inverse = truth * np.array([1.0, -1.0, -1.0, -1.0])
    seen = found.q_inertial_from_body_wxyz
    off = to_rotation_vector(multiplied(np.tile(inverse, (3000, 1)), seen))
    scale = np.sqrt(np.diag(found.covariance_rad2))
    balance = np.outer(scale, scale)
    np.testing.assert_allclose(
        off.T @ off / 3000 / balance, found.covariance_rad2 / balance, atol=0.08
    )
