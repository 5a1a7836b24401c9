from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chi2

from models.arrays import Floats
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.yamanaka_ankersen import state_transition
from pipelines.filters.kalman import predict, update

LEO = KeplerOrbit(7.1431e6, 1.4e-4, 1.7, 1.38, 1.5, 0.0)
SEEN = np.hstack([np.eye(3), np.zeros((3, 3))])
START = np.diag([0.3, 0.3, 0.3, 0.02, 0.02, 0.02]) ** 2
NOISE = np.array([[4e-4, 1e-4, 0.0], [1e-4, 2e-3, -1e-4], [0.0, -1e-4, 5e-4]])
STEP_S = 10.0
PROCESS = np.diag([1e-6, 2e-6, 1e-6, 1e-8, 1e-8, 3e-8])
ROUNDING = 1e-8  # relative: the batch inverts a matrix of condition 1e6


def joint_gaussian(steps: int) -> tuple[list[Floats], Floats]:
    """Return the transitions, and the covariance of all states and then all measurements."""
    flows = [state_transition(LEO, STEP_S * k, STEP_S * (k + 1)) for k in range(steps - 1)]
    states = np.zeros((6 * steps, 6 * steps))
    spread = START.copy()
    for k in range(steps):
        carried = spread.copy()
        for later in range(k, steps):
            states[6 * later : 6 * later + 6, 6 * k : 6 * k + 6] = carried
            states[6 * k : 6 * k + 6, 6 * later : 6 * later + 6] = carried.T
            if later < steps - 1:
                carried = flows[later] @ carried
        if k < steps - 1:
            spread = flows[k] @ spread @ flows[k].T + PROCESS
    return flows, states


def test_it_is_the_conditional_mean_of_everything_measured() -> None:
    """An independent peer: all states and measurements as one Gaussian, solved at once."""
    steps = 12
    flows, states = joint_gaussian(steps)
    all_seen = np.kron(np.eye(steps), SEEN)
    measured = np.random.default_rng([0, 1]).normal(scale=0.3, size=3 * steps)
    spread = all_seen @ states @ all_seen.T + np.kron(np.eye(steps), NOISE)
    last = states[-6:]
    expected = last @ all_seen.T @ np.linalg.solve(spread, measured)
    left = last[:, -6:] - last @ all_seen.T @ np.linalg.solve(spread, all_seen @ last.T)

    state, covariance = np.zeros(6), START
    for k in range(steps):
        if k:
            state, covariance = predict(state, covariance, flows[k - 1], PROCESS)
        found = update(state, covariance, measured[3 * k : 3 * k + 3], SEEN, NOISE)
        state, covariance = found.state, found.covariance
    np.testing.assert_allclose(state, expected, rtol=ROUNDING)
    np.testing.assert_allclose(covariance, left, atol=ROUNDING * np.abs(left).max())


@given(st.floats(-12.0, 2.0), st.floats(-6.0, 3.0))
def test_the_covariance_stays_positive_whatever_the_noise(log_noise: float, log_p: float) -> None:
    covariance = 10.0**log_p * START
    for _ in range(5):
        covariance = update(
            np.zeros(6), covariance, np.ones(3), SEEN, 10.0**log_noise * np.eye(3)
        ).covariance
    assert np.linalg.eigvalsh(covariance)[0] > 0.0
    np.testing.assert_array_equal(covariance, covariance.T)


def nees_and_nis(told: Floats, runs: int = 60, steps: int = 10) -> tuple[float, float]:
    """Return the mean NEES at the end and the mean NIS, of filters told this noise."""
    errors, innovations = [], []
    root_start, root_process, root_noise = (np.linalg.cholesky(m) for m in (START, PROCESS, NOISE))
    for run in range(runs):
        rng = np.random.default_rng([7, run])
        truth, state, covariance = root_start @ rng.standard_normal(6), np.zeros(6), START
        for k in range(steps):
            flow = state_transition(LEO, STEP_S * k, STEP_S * (k + 1))
            truth = flow @ truth + root_process @ rng.standard_normal(6)
            state, covariance = predict(state, covariance, flow, PROCESS)
            measured = truth[:3] + root_noise @ rng.standard_normal(3)
            found = update(state, covariance, measured, SEEN, told)
            state, covariance = found.state, found.covariance
            innovations.append(found.nis)
        off = truth - state
        errors.append(off @ np.linalg.solve(covariance, off))
    return float(np.mean(errors)), float(np.mean(innovations))


def within(mean: float, freedom: int, count: int) -> bool:
    """Whether the mean of ``count`` chi2 numbers is believable: one false alarm in a thousand."""
    low, high = chi2.ppf([0.0005, 0.9995], freedom * count) / count
    return bool(low < mean < high)


def test_errors_and_innovations_are_as_large_as_it_says() -> None:
    nees, nis = nees_and_nis(NOISE)
    assert within(nees, 6, 60)
    assert within(nis, 3, 600)


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_and_a_wrong_covariance_is_noticed(factor: float) -> None:
    nees, nis = nees_and_nis(factor * NOISE)
    assert not within(nis, 3, 600)
    assert not within(nees, 6, 60)
