from __future__ import annotations

import numpy as np
import pytest

from models.arrays import Floats
from models.motion.prior import (
    CHASER_FIXED_SIGMA_DEG,
    CHASER_FIXED_SIGMA_M,
    EYE_IN_HAND_SIGMA_DEG,
    EYE_IN_HAND_SIGMA_M,
    draw_prior,
)
from models.pose import RigidTransform, pose_error, rotation_from_euler_321

DRAWS = 2000
SIGMAS_ALLOWED = 5.0  # one false alarm in 2e6 for each number; the seed is fixed anyway
TRUTH = RigidTransform(
    rotation_from_euler_321([179.9, 2.0, -1.0]), np.array([-0.4, 0.8, 6.7])
)  # alpha at the seam


def errors() -> Floats:
    """(draws, 6): translation, then (alpha, beta, gamma), in units of their sigmas."""
    rng = np.random.default_rng(2022)
    rows = []
    for _ in range(DRAWS):
        prior = draw_prior(TRUTH, CHASER_FIXED_SIGMA_M, CHASER_FIXED_SIGMA_DEG, rng)
        error = pose_error(prior, TRUTH)
        rows.append(
            [
                *(error.position_m / CHASER_FIXED_SIGMA_M),
                *(error.euler_deg / CHASER_FIXED_SIGMA_DEG),
            ]
        )
    return np.array(rows)


def test_table_5() -> None:
    assert CHASER_FIXED_SIGMA_M == (0.017, 0.017, 0.05)
    assert CHASER_FIXED_SIGMA_DEG == (1.0, 1.0, 1.0)
    assert EYE_IN_HAND_SIGMA_M == (0.010, 0.010, 0.010)
    assert EYE_IN_HAND_SIGMA_DEG == (0.667, 0.667, 0.667)


def test_all_six_errors_are_gaussian_independent_and_have_table_5s_sigmas() -> None:
    scaled = errors()
    of_mean = SIGMAS_ALLOWED / np.sqrt(DRAWS)
    np.testing.assert_allclose(scaled.mean(axis=0), 0.0, atol=of_mean)
    np.testing.assert_allclose(scaled.std(axis=0), 1.0, atol=of_mean / np.sqrt(2.0))
    np.testing.assert_allclose(np.corrcoef(scaled.T), np.eye(6), atol=of_mean)
    share = (np.abs(scaled) < 1.0).mean(axis=0)  # a Gaussian has 68.27 % within one sigma
    spread = SIGMAS_ALLOWED * np.sqrt(0.6827 * 0.3173 / DRAWS)
    np.testing.assert_allclose(share, 0.6827, atol=spread)


def test_no_uncertainty_is_the_truth() -> None:
    prior = draw_prior(TRUTH, [0.0] * 3, [0.0] * 3, np.random.default_rng(0))
    np.testing.assert_array_equal(prior.translation, TRUTH.translation)
    np.testing.assert_allclose(prior.rotation, TRUTH.rotation, atol=1e-14)


def test_one_seed_gives_one_prior() -> None:
    first, again = (
        draw_prior(TRUTH, [0.1] * 3, [1.0] * 3, np.random.default_rng(7)) for _ in range(2)
    )
    np.testing.assert_array_equal(first.rotation, again.rotation)
    np.testing.assert_array_equal(first.translation, again.translation)


@pytest.mark.parametrize(
    ("sigma_m", "sigma_deg"),
    [
        ([-0.1, 0.0, 0.0], [1.0] * 3),
        ([0.1] * 3, [1.0, float("nan"), 1.0]),
        ([0.1] * 2, [1.0] * 2),
        ([0.1] * 2, [1.0] * 3),
    ],
)
def test_impossible_sigmas_are_refused(sigma_m: list[float], sigma_deg: list[float]) -> None:
    with pytest.raises(ValueError, match="three sigmas in m and three in deg"):
        draw_prior(TRUTH, sigma_m, sigma_deg, np.random.default_rng(0))
