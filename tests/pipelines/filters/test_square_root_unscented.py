"""The square-root filter against Kalman's on linear problems, and its covariance's health."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipelines.filters.kalman import predict
from pipelines.filters.rodrigues_error import error_parameters, error_quaternion
from pipelines.filters.square_root_unscented import (
    UnscentedWeights,
    lower_factor,
    measurement_update,
    predicted_factor,
    sigma_deviations,
)

EQUAL = 1e-9


class Linear:
    """A linear problem, by Kalman's equations and by sigma points."""

    def __init__(self, seed: int, size: int = 5, count: int = 3) -> None:
        rng = np.random.default_rng(seed)
        self.rng = rng
        self.weights = UnscentedWeights(size, alpha=0.9, beta=2.0, kappa=1.0)
        self.step = np.eye(size) + 0.1 * rng.standard_normal((size, size))
        self.slopes = rng.standard_normal((count, size))
        self.noise = 0.1 * np.tril(rng.standard_normal((size, size))) + 0.2 * np.eye(size)
        self.measured_noise = np.diag(rng.uniform(0.5, 1.0, count))
        self.state = rng.standard_normal(size)
        self.factor = np.eye(size)

    def kalman(self, state, covariance, measured):
        state, covariance = predict(state, covariance, self.step, self.noise @ self.noise.T)
        whole = self.slopes @ covariance @ self.slopes.T + self.measured_noise**2
        gain = np.linalg.solve(whole, self.slopes @ covariance).T
        innovation = measured - self.slopes @ state
        after = covariance - gain @ whole @ gain.T
        return state + gain @ innovation, after, innovation @ np.linalg.solve(whole, innovation)

    def unscented(self, state, factor, measured):
        spread = sigma_deviations(factor, self.weights) @ self.step.T
        state = self.step @ state
        factor = predicted_factor(spread, self.noise, self.weights)
        spread = sigma_deviations(factor, self.weights)
        update = measurement_update(
            spread,
            spread @ self.slopes.T,
            self.measured_noise,
            measured - self.slopes @ state,
            self.weights,
        )
        return state + update.correction, update.factor, update.nis


@pytest.mark.parametrize("seed", range(5))
def test_it_is_kalmans_filter_on_a_linear_problem(seed):
    own = Linear(seed)
    state, covariance = own.state, own.factor @ own.factor.T
    other, factor = own.state, own.factor
    for _ in range(50):
        measured = own.rng.standard_normal(3)
        state, covariance, nis = own.kalman(state, covariance, measured)
        other, factor, other_nis = own.unscented(other, factor, measured)
        assert other == pytest.approx(state, abs=EQUAL)
        assert factor @ factor.T == pytest.approx(covariance, abs=EQUAL)
        assert other_nis == pytest.approx(nis, abs=EQUAL)


def test_runs_of_a_batch_know_nothing_of_one_another():
    rng = np.random.default_rng(3)
    weights = UnscentedWeights(4)
    factors = np.tril(rng.standard_normal((6, 4, 4))) + 2.0 * np.eye(4)
    slopes, innovations = rng.standard_normal((2, 4)), rng.standard_normal((6, 2))
    spread = sigma_deviations(factors, weights)
    noise = np.broadcast_to(np.eye(2), (6, 2, 2))
    batch = measurement_update(spread, spread @ slopes.T, noise, innovations, weights)
    for run in range(6):
        alone = sigma_deviations(factors[run], weights)
        one = measurement_update(alone, alone @ slopes.T, np.eye(2), innovations[run], weights)
        assert batch.correction[run] == pytest.approx(one.correction, abs=1e-13)
        assert batch.factor[run] == pytest.approx(one.factor, abs=1e-13)


@given(st.integers(1, 30), st.floats(0.2, 1.0), st.floats(0.0, 3.0))
def test_weights_keep_mean_and_covariance(size, alpha, kappa):
    beta = max(2.0, size / (alpha**2 * (size + kappa)))
    weights = UnscentedWeights(size, alpha, beta, kappa)
    spread = sigma_deviations(np.eye(size), weights)
    assert weights.mean.sum() == pytest.approx(1.0)
    assert weights.mean @ spread == pytest.approx(np.zeros(size), abs=1e-12)
    assert (spread.T * weights.covariance) @ spread == pytest.approx(np.eye(size), abs=1e-12)


def test_weights_below_nothing_are_refused():
    with pytest.raises(ValueError, match="no negative weight of the covariance"):
        UnscentedWeights(17, alpha=1e-3)
    with pytest.raises(ValueError, match="above zero"):
        UnscentedWeights(17, kappa=-17.0)


def test_a_perfect_measurement_leaves_a_covariance():
    """Kalman's own form goes indefinite here: prior 1e14 times the measurement's variance."""
    weights = UnscentedWeights(2)
    spread = sigma_deviations(np.diag([1e7, 1.0]), weights)
    update = measurement_update(
        spread, spread @ np.array([[1.0], [1.0]]), np.array([[1.0]]), np.zeros(1), weights
    )
    covariance = update.factor @ update.factor.T
    assert np.linalg.eigvalsh(covariance).min() == pytest.approx(0.5 * (3.0 - np.sqrt(5.0)))
    assert covariance[0, 0] == pytest.approx(2.0, rel=1e-6)
    assert lower_factor(update.factor) @ lower_factor(update.factor).T == pytest.approx(covariance)


@given(st.lists(st.floats(-2.0, 2.0), min_size=3, max_size=3).map(np.array))
def test_attitude_errors_come_back_and_small_ones_are_angles(error):
    quaternion = error_quaternion(error)
    assert np.linalg.norm(quaternion) == pytest.approx(1.0)
    assert error_parameters(quaternion) == pytest.approx(error, abs=1e-12)
    assert error_parameters(-quaternion) == pytest.approx(error, abs=1e-12)
    small = error_quaternion(1e-4 * error)
    assert 2.0 * small[1:] == pytest.approx(1e-4 * error, abs=1e-11)
