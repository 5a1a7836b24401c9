"""What errors come to: sizes, memories, a clock's Allan deviation."""

import numpy as np
import pytest

from models.gnss.range_errors import LastingErrors, RangeErrors
from models.gnss.receiver_clock import ReceiverClock
from models.gnss.tracking_noise import SPEED_OF_LIGHT_M_S

SAMPLE = 0.03  # of some ten thousand draws


def test_white_errors_have_the_size_of_table_3():
    assert RangeErrors().sigma_m == pytest.approx(np.sqrt(1.1**2 + 0.8**2 + 0.2**2))
    low = RangeErrors(ionosphere_m=10.0)
    assert low.white_m == low.sigma_m == pytest.approx(10.09, abs=0.01)
    assert low.lasting == ()


def test_lasting_errors_keep_their_size_and_fade():
    errors = RangeErrors(ionosphere_m=10.0, correlated=True)
    assert errors.white_m == 0.2
    rng = np.random.default_rng(5)
    lasting = LastingErrors(errors)
    series = np.array([lasting.after(60.0, rng.standard_normal((2, 40, 54))) for _ in range(40)])
    sigma = np.sqrt(10.0**2 + 1.1**2 + 0.8**2)
    assert series.std(axis=(1, 2)) == pytest.approx(sigma, rel=SAMPLE)
    after_600_s = np.mean(series[10] * series[20]) / sigma**2
    share = 100.0 / sigma**2
    expected = share * np.exp(-1.0) + (1.0 - share) * np.exp(-600.0 / 7200.0)
    assert after_600_s == pytest.approx(expected, abs=0.05)


def test_a_clock_has_its_allan_deviation():
    """h0 / 2 tau + 2 pi^2 / 3 h-2 tau, of fractional frequency over tau."""
    clock, tau_s, runs = ReceiverClock(bias_s=0.0, drift=0.0), 10.0, 4000
    rng = np.random.default_rng(8)
    state = clock.at_start(runs)
    phases = [state[:, 0]]
    for _ in range(2):
        state = clock.after(state, tau_s, rng.standard_normal((runs, 2)))
        phases.append(state[:, 0])
    second = (phases[2] - 2.0 * phases[1] + phases[0]) / (SPEED_OF_LIGHT_M_S * tau_s)
    expected = 2e-19 / (2.0 * tau_s) + 2.0 * np.pi**2 / 3.0 * 2e-20 * tau_s
    assert 0.5 * np.mean(second**2) == pytest.approx(expected, rel=2 * SAMPLE)


def test_many_small_steps_are_one_large_step():
    clock, rng = ReceiverClock(), np.random.default_rng(2)
    small = clock.at_start(20_000)
    for _ in range(10):
        small = clock.after(small, 0.2, rng.standard_normal((20_000, 2)))
    large = clock.after(clock.at_start(20_000), 2.0, rng.standard_normal((20_000, 2)))
    assert np.cov(small.T) == pytest.approx(np.cov(large.T), rel=2 * SAMPLE)
    assert small.mean(axis=0) == pytest.approx(large.mean(axis=0), abs=0.02)  # four of its sigmas
