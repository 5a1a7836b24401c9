"""The unscented transformation: exact where all is linear, and right to second order."""

import numpy as np
import pytest

from pipelines.filters.kalman import predict
from pipelines.filters.unscented import (
    SigmaPoints,
    cross_covariance,
    square_root,
    weighted_mean,
)

SIZE = 5
CHOICES = [(0.3, 2.0, 0.0), (1.0, 2.0, 0.0), (1e-2, 2.0, 0.0), (1.0, 0.0, -2.0)]


def gaussian(seed=0):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(SIZE, SIZE))
    return rng.normal(size=SIZE), root @ root.T


@pytest.mark.parametrize(("alpha", "beta", "kappa"), CHOICES)
def test_a_linear_function_is_kalmans(alpha, beta, kappa):
    state, covariance = gaussian()
    matrix = np.random.default_rng(1).normal(size=(SIZE, SIZE))
    chosen = SigmaPoints(SIZE, alpha, beta, kappa)
    carried = chosen.around(state, covariance) @ matrix.T
    mean = weighted_mean(carried, chosen)
    away = carried - mean
    expected, spread = predict(state, covariance, matrix, np.zeros((SIZE, SIZE)))
    np.testing.assert_allclose(mean, expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(cross_covariance(away, away, chosen), spread, rtol=1e-7, atol=1e-7)


def test_the_mean_of_a_square_holds_the_variance():
    state, covariance = gaussian()
    chosen = SigmaPoints(SIZE, 0.3, 2.0, 0.0)
    squares = chosen.around(state, covariance) ** 2
    expected = state**2 + np.diag(covariance)
    np.testing.assert_allclose(weighted_mean(squares, chosen), expected, rtol=1e-9)


def test_a_root_is_a_root_whatever_the_units_and_though_rounding_took_the_sign():
    _, covariance = gaussian()
    scale = np.diag([1e-9, 1.0, 1e6, 1.0, 1.0])
    scaled = scale @ covariance @ scale
    root = square_root(scaled)
    np.testing.assert_allclose(root @ root.T / scaled, 1.0, rtol=1e-9)
    flat = np.outer(np.ones(3), np.ones(3)) - 1e-14 * np.eye(3)
    assert np.isfinite(square_root(flat)).all()
