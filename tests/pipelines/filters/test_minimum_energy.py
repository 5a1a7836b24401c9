from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.motion.kepler_orbit import KeplerOrbit
from pipelines.filters import minimum_energy, multiplicative_ekf
from pipelines.filters.minimum_energy import (
    NoMinimumEnergy,
    reference_vectors,
    residual,
    second_order_term,
)
from pipelines.filters.navigation_options import NavigationOptions
from pipelines.filters.rotation_process import RotationProcess, RotationState, skew, turn_between
from tests.support.strategies import vectors

SOME = Rotation.from_rotvec([0.4, -1.0, 2.0]).as_matrix()
NOISE = np.diag(np.deg2rad([0.2, 0.3, 0.25])) ** 2
COVARIANCE = np.diag(np.deg2rad([1.0, 2.0, 1.5, 0.3, 0.2, 0.4])) ** 2
COVARIANCE[0, 3] = COVARIANCE[3, 0] = 0.3 * np.deg2rad(1.0) * np.deg2rad(0.3)


def turned(rotvec_deg: Floats | list[float]) -> Floats:
    return SOME @ Rotation.from_rotvec(np.asarray(rotvec_deg), degrees=True).as_matrix()


def information_of(noise: Floats) -> Floats:
    references, weights = reference_vectors(noise, SOME)
    seen = references @ SOME
    return second_order_term(seen, seen, weights)


@given(vectors(1.0), st.lists(st.floats(0.5, 1.0), min_size=3, max_size=3))
def test_three_vectors_tell_what_the_measured_attitude_tells(
    turn: Floats, information: list[float]
) -> None:
    """No information here exceeds the sum of the two others."""
    axes = Rotation.from_rotvec(turn).as_matrix()
    noise = axes @ np.diag(1e-4 / np.array(information)) @ axes.T
    references, weights = reference_vectors(noise, SOME)
    np.testing.assert_allclose(references @ references.T, np.eye(3), atol=1e-12)
    assert (weights >= 0.0).all()
    np.testing.assert_allclose(information_of(noise) @ noise, np.eye(3), atol=1e-9)


def test_what_no_three_vectors_can_tell_is_given_up() -> None:
    """A boresight known ten times better than the rest: no weight negative, nothing invented."""
    noise = np.diag(np.deg2rad([0.3, 0.4, 0.03])) ** 2
    _, weights = reference_vectors(noise, SOME)
    assert weights.min() >= 0.0
    told, known = information_of(noise), np.linalg.inv(noise)
    assert np.linalg.eigvalsh(known - told)[0] >= -1e-9 * np.linalg.norm(known)
    np.testing.assert_allclose(told[:2, :2], known[:2, :2], atol=1e-9 * np.linalg.norm(known))


@given(vectors(0.02))
def test_the_residual_points_from_the_expected_to_the_measured(error: Floats) -> None:
    """To first order r^R is the information times the error in target axes: the sign is right."""
    references, weights = reference_vectors(NOISE, SOME)
    measured = SOME @ Rotation.from_rotvec(error).as_matrix()
    found = residual(references @ measured, references @ SOME, weights)
    scale = np.linalg.norm(np.linalg.inv(NOISE))
    np.testing.assert_allclose(found, np.linalg.solve(NOISE, error), atol=3e-4 * scale)


@given(vectors(1.0))
def test_e_with_its_minus_sign_is_positive_below_a_right_angle(error: Floats) -> None:
    references, weights = reference_vectors(np.deg2rad(1.0) ** 2 * np.eye(3), SOME)
    measured = SOME @ Rotation.from_rotvec(0.5 * np.pi / np.sqrt(3.0) * error).as_matrix()
    term = second_order_term(references @ measured, references @ SOME, weights)
    assert np.linalg.eigvalsh(term)[0] > -1e-6 * np.linalg.norm(term)


def test_as_printed_e_makes_the_gain_indefinite_at_the_first_step() -> None:
    """Pesce et al. 2019, Table 2, has a plus: the Riccati equation then loses information."""
    gain = np.linalg.inv(COVARIANCE)
    gain[:3, :3] -= information_of(NOISE)
    assert np.linalg.eigvalsh(gain)[0] < 0.0


@settings(max_examples=30)
@given(vectors(0.05), vectors(0.01))
def test_close_by_it_is_the_multiplicative_ekf(error_deg: Floats, omega: Floats) -> None:
    state = RotationState(SOME, omega, COVARIANCE)
    measured = turned(error_deg)
    ours = minimum_energy.update(state, measured, NOISE)
    theirs = multiplicative_ekf.update(state, measured, NOISE)
    assert ours
    apart = turn_between(ours.state.R_lvlh_from_target, theirs.state.R_lvlh_from_target)
    size = np.deg2rad(np.linalg.norm(error_deg))
    np.testing.assert_allclose(apart, 0.0, atol=1e-3 * size + 1e-12)
    np.testing.assert_allclose(
        ours.state.omega_in_target, theirs.state.omega_in_target, atol=1e-3 * size + 1e-12
    )
    scale = np.sqrt(np.outer(np.diag(COVARIANCE), np.diag(COVARIANCE)))
    np.testing.assert_allclose(
        ours.state.covariance / scale, theirs.state.covariance / scale, atol=2e-3
    )
    assert ours.nis == theirs.nis


def test_with_a_fast_camera_its_gain_is_kalmans_and_bucys() -> None:
    """The continuous filter that the paper writes down, integrated as an ordinary equation."""
    far = KeplerOrbit(1e11, 0.0, 0.0, 0.0, 0.0, 0.0)  # whose local frame does not turn
    options = NavigationOptions(rate_model="relative", asymmetry=0.3)
    process = RotationProcess(options)
    omega, step_s, count = np.deg2rad([1.0, -0.5, 2.0]), 0.02, 250
    density = NOISE * step_s  # of white noise that says as much in a second
    drive = np.zeros((6, 6))
    speed = np.linalg.norm(omega)
    drive[3:, 3:] = 2.0 / speed * process.acceleration_covariance(omega, 0.0)
    flow = np.zeros((6, 6))
    flow[:3, :3], flow[:3, 3:] = -skew(omega), np.eye(3)
    told = np.zeros((6, 6))
    told[:3, :3] = np.linalg.inv(density)

    def riccati(_: float, flat: Floats) -> Floats:
        k = flat.reshape(6, 6)
        return (flow @ k + k @ flow.T - k @ told @ k + drive).ravel()

    solved = solve_ivp(
        riccati, (0.0, step_s * count), COVARIANCE.ravel(), "LSODA", rtol=1e-8, atol=1e-14
    )
    expected = solved.y[:, -1].reshape(6, 6)
    state = RotationState(SOME, omega, COVARIANCE)
    for k in range(count):
        state = process.predict(state, far, step_s * k, step_s * (k + 1))
        found = minimum_energy.update(state, state.R_lvlh_from_target, NOISE)
        assert found
        state = found.state
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    # A camera at 50 Hz over a filter of some tenths of a second: a few per cent are the sampling.
    np.testing.assert_allclose(state.covariance / scale, expected / scale, atol=0.05)


@pytest.mark.parametrize("angle_deg", [5.0, 40.0, 85.0])
def test_far_off_it_still_comes_closer_and_stays_positive(angle_deg: float) -> None:
    axis = np.array([1.0, 2.0, -1.0]) / np.sqrt(6.0)
    wide = np.diag(np.deg2rad([*3 * [60.0], *3 * [1.0]])) ** 2
    found = minimum_energy.update(
        RotationState(SOME, np.zeros(3), wide), turned(angle_deg * axis), NOISE
    )
    assert found
    left = np.linalg.norm(turn_between(found.state.R_lvlh_from_target, turned(angle_deg * axis)))
    assert np.rad2deg(left) < 0.1 * angle_deg
    assert np.linalg.eigvalsh(found.state.covariance)[0] > 0.0


@given(vectors(1.0))
def test_a_right_angle_off_it_says_so(axis: Floats) -> None:
    size = float(np.linalg.norm(axis))
    assume(size > 0.1)
    state = RotationState(SOME, np.zeros(3), COVARIANCE)
    refused = minimum_energy.update(state, turned(91.0 * axis / size), NOISE)
    assert isinstance(refused, NoMinimumEnergy)
    assert not refused
    assert "a right angle or more" in refused.reason


@pytest.mark.parametrize("angle_deg", [5.0, 60.0, 70.0, 74.0, 78.0, 85.0, 88.0, 89.9])
def test_a_sharp_measurement_far_off_does_not_overshoot(angle_deg: float) -> None:
    """Turn and rate nearly one: the rate becomes the turn's, whole steps would go round several.

    At 78 deg they gave 614 deg/s and a gain of -1.4e-6.
    """
    both = 3.04e-4 * np.kron(np.ones((2, 2)), np.eye(3)) + 2e-6 * np.eye(6)
    measured = Rotation.from_rotvec([angle_deg, 0.0, 0.0], degrees=True).as_matrix()
    found = minimum_energy.update(
        RotationState(np.eye(3), np.zeros(3), both), measured, 1e-6 * np.eye(3)
    )
    assert found
    left = turn_between(found.state.R_lvlh_from_target, measured)
    assert np.rad2deg(np.linalg.norm(left)) < 0.01 * angle_deg
    rate_deg_s = np.rad2deg(found.state.omega_in_target)
    np.testing.assert_allclose(rate_deg_s, [angle_deg, 0.0, 0.0], atol=0.02 * angle_deg)
    assert np.linalg.eigvalsh(found.state.covariance)[0] > 0.0


@settings(max_examples=60)
@given(
    vectors(1.0), st.floats(0.0, 89.9), st.integers(0, 2**32 - 1), st.floats(-4.0, -0.5),
    st.floats(-5.0, -1.0),
)  # fmt: skip
def test_whatever_is_measured_the_gain_is_positive_or_it_says_why(
    axis: Floats, angle_deg: float, seed: int, spread: float, noise: float
) -> None:
    size = float(np.linalg.norm(axis))
    assume(size > 0.1)
    rng = np.random.default_rng(seed)
    root, small = rng.standard_normal((6, 6)), rng.standard_normal((3, 3))
    covariance = 10.0 ** (2 * spread) * (root @ root.T) + 1e-12 * np.eye(6)
    told = 10.0 ** (2 * noise) * (small @ small.T) + 1e-12 * np.eye(3)
    state = RotationState(SOME, np.zeros(3), covariance)
    found = minimum_energy.update(state, turned(angle_deg * axis / size), told)
    if isinstance(found, NoMinimumEnergy):
        assert "no positive gain" in found.reason
        assert angle_deg > 20.0  # nearer by, something is always learnt
        return
    scale = np.sqrt(np.diag(found.state.covariance))
    assert np.linalg.eigvalsh(found.state.covariance / np.outer(scale, scale))[0] > 0.0
    assert np.isfinite(found.state.omega_in_target).all()
