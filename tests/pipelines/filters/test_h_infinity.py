from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arrays import Floats
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.yamanaka_ankersen import state_transition
from pipelines.filters import h_infinity, kalman
from pipelines.filters.h_infinity import NoHInfinity, theta_limit, theta_of_share
from pipelines.filters.kalman import LinearUpdate

SEEN = np.hstack([np.eye(3), np.zeros((3, 3))])
NOISE = np.diag([0.01, 0.04, 0.02]) ** 2
COVARIANCE = state_transition(KeplerOrbit(7.1e6, 1e-4, 1.7, 0.0, 0.0, 0.0), 0.0, 20.0)
COVARIANCE = COVARIANCE @ np.diag([0.1, 0.2, 0.1, 0.01, 0.02, 0.01]) ** 2 @ COVARIANCE.T
STATE = np.array([0.1, 30.0, -0.2, 1e-3, 2e-3, 0.0])
MEASURED = np.array([0.15, 30.1, -0.1])
ROUNDING = 1e-10  # relative: one inverse of a matrix of condition 1e5


def updated(theta: float) -> LinearUpdate | NoHInfinity:
    return h_infinity.update(
        STATE, COVARIANCE, MEASURED, SEEN, NOISE, theta=theta, weights=np.eye(6)
    )


def test_without_theta_it_is_kalmans() -> None:
    found = updated(0.0)
    plain = kalman.update(STATE, COVARIANCE, MEASURED, SEEN, NOISE)
    assert isinstance(found, LinearUpdate)
    np.testing.assert_allclose(found.state, plain.state, rtol=ROUNDING)
    np.testing.assert_allclose(found.covariance, plain.covariance, atol=ROUNDING)
    assert found.nis == pytest.approx(plain.nis)


@given(st.floats(0.0, 0.9))
def test_with_a_prediction_it_is_the_papers_table_1(share: float) -> None:
    theta = theta_of_share(share, NOISE)
    flow = state_transition(KeplerOrbit(7.1e6, 1e-4, 1.7, 0.0, 0.0, 0.0), 0.0, 1.0)
    process = 1e-6 * np.eye(6)
    inverse = np.linalg.inv(NOISE)
    bracket = np.linalg.inv(np.eye(6) - theta * COVARIANCE + SEEN.T @ inverse @ SEEN @ COVARIANCE)
    gain = COVARIANCE @ bracket @ SEEN.T @ inverse
    printed = flow @ STATE + flow @ gain @ (MEASURED - SEEN @ STATE)
    printed_covariance = flow @ COVARIANCE @ bracket @ flow.T + process
    found = updated(theta)
    assert isinstance(found, LinearUpdate)
    state, covariance = kalman.predict(found.state, found.covariance, flow, process)
    np.testing.assert_allclose(state, printed, rtol=1e-9)
    np.testing.assert_allclose(covariance, printed_covariance, atol=1e-9)


def test_it_exists_just_below_its_limit_and_not_at_it() -> None:
    information = np.linalg.inv(COVARIANCE) + SEEN.T @ np.linalg.inv(NOISE) @ SEEN
    limit = float(np.linalg.eigvalsh(information)[0])  # for unit weights
    assert theta_limit(information, np.eye(6)) == pytest.approx(limit)
    below = updated(0.999 * limit)
    assert isinstance(below, LinearUpdate)
    assert np.linalg.eigvalsh(below.covariance)[0] > 0.0
    for theta in (1.001 * limit, 1e3 * limit):
        found = updated(theta)
        assert not found
        assert isinstance(found, NoHInfinity)
        assert found.limit == pytest.approx(limit)
        assert "is not below" in found.reason


def test_errors_that_do_not_count_set_no_limit() -> None:
    assert theta_limit(np.eye(2), np.zeros((2, 2))) == np.inf


def test_a_share_is_of_the_worst_position() -> None:
    assert theta_of_share(0.25, NOISE) == pytest.approx(0.25 / 0.04**2)


# A small system whose disturbances can all be tried at once.
FLOW = np.array([[1.0, 1.0], [0.0, 1.0]])
PLACE = np.array([[1.0, 0.0]])
FIRST, PUSH, PIXEL = np.diag([4.0, 1.0]), 0.05 * np.eye(2), np.array([[1.0]])
STEPS = 15


def worst_case(theta: float) -> float:
    """Return the largest ratio of squared a-priori errors to squared disturbances.

    Error is linear in the disturbances (the start, every push, every pixel), each in its own
    sigmas: the ratio's largest value is the square of the matrix's largest singular value.
    """
    inputs = 2 + 3 * STEPS
    state, truth = np.zeros((2, inputs)), np.zeros((2, inputs))
    truth[:, :2] = np.linalg.cholesky(FIRST)
    covariance, errors = FIRST, []
    for k in range(STEPS):
        errors.append(truth - state)
        seen = PLACE @ truth
        seen[0, 2 + 3 * k + 2] += np.sqrt(PIXEL[0, 0])
        found = None
        for column in range(inputs):
            found = h_infinity.update(
                state[:, column],
                covariance,
                seen[:, column],
                PLACE,
                PIXEL,
                theta=theta,
                weights=np.eye(2),
            )
            assert isinstance(found, LinearUpdate)
            state[:, column] = FLOW @ found.state
        assert isinstance(found, LinearUpdate)
        covariance = FLOW @ found.covariance @ FLOW.T + PUSH
        truth = FLOW @ truth
        truth[:, 2 + 3 * k : 2 + 3 * k + 2] += np.linalg.cholesky(PUSH)
    return float(np.linalg.norm(np.vstack(errors), 2) ** 2)


def test_its_worst_case_is_within_the_guarantee_and_better_than_kalmans() -> None:
    """Simon 2006, section 11.3: below 1 / theta; the paper's square root is missing there."""
    theta = 0.12
    kalmans, ours = worst_case(0.0), worst_case(theta)
    assert ours < 1.0 / theta
    assert ours < kalmans


def test_a_theta_that_asks_for_more_than_there_is_does_not_exist() -> None:
    covariance: Floats = FIRST
    for _ in range(STEPS):
        found = h_infinity.update(
            np.zeros(2), covariance, np.zeros(1), PLACE, PIXEL, theta=2.0, weights=np.eye(2)
        )
        if not isinstance(found, LinearUpdate):
            return
        covariance = FLOW @ found.covariance @ FLOW.T + PUSH
    pytest.fail("expected the existence condition to fail")
