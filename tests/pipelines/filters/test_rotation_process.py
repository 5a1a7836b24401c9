from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.tumble import Tumble
from pipelines.filters.navigation_options import BEST, PAPER, NavigationOptions
from pipelines.filters.rotation_process import (
    FreeBody,
    RotationProcess,
    RotationState,
    turn_between,
)

XMM = np.array([[7052.0, -820.0, -3991.0], [-820.0, 129129.0, 0.0], [-3991.0, 0.0, 131196.0]])
LEO = KeplerOrbit(7.1431e6, 1.4e-4, 1.7, 1.38, 1.5, 0.0)
FAR = replace(LEO, semi_major_axis_m=1e11)  # whose local frame does not turn
OMEGA = np.deg2rad([0.5, -0.3, 0.2])
CARRIED_RAD = 1e-8  # after a hundred steps of fourth order, at 0.6 deg/s
TUMBLE = Tumble(LEO, np.array([0.0, 30.0, 0.0]), np.zeros(3), OMEGA, XMM, 120.0)
COVARIANCE = np.diag(np.deg2rad([0.2, 0.3, 0.1, 0.02, 0.01, 0.03])) ** 2


def true_state(process: RotationProcess, time_s: float) -> RotationState:
    truth = TUMBLE.state(time_s)
    return process.state_from_relative(
        truth.R_lvlh_from_target, truth.omega_target_wrt_lvlh_in_target, COVARIANCE, LEO, time_s
    )


@pytest.mark.parametrize("step_s", [1.0, 10.0])
def test_with_the_inertia_it_follows_a_tumble(step_s: float) -> None:
    process = RotationProcess(BEST, XMM)
    state, time_s = true_state(process, 0.0), 0.0
    while time_s < 100.0:
        state = process.predict(state, LEO, time_s, time_s + step_s)
        time_s += step_s
    truth = TUMBLE.state(time_s)
    omega, _ = process.relative_from_state(state, LEO, time_s)
    turn = turn_between(state.R_lvlh_from_target, truth.R_lvlh_from_target)
    np.testing.assert_allclose(turn, 0.0, atol=CARRIED_RAD)
    np.testing.assert_allclose(
        omega, truth.omega_target_wrt_lvlh_in_target, atol=1e-2 * CARRIED_RAD
    )


def test_the_scale_of_the_inertia_does_not_matter() -> None:
    one, other = (RotationProcess(BEST, scale * XMM) for scale in (1.0, 1e-4))
    state = true_state(one, 0.0)
    ours, theirs = one.predict(state, LEO, 0.0, 1.0), other.predict(state, LEO, 0.0, 1.0)
    np.testing.assert_allclose(ours.R_lvlh_from_target, theirs.R_lvlh_from_target, atol=1e-14)
    np.testing.assert_allclose(ours.covariance, theirs.covariance, rtol=1e-9)


@pytest.mark.parametrize("options", [PAPER, BEST], ids=["paper", "best"])
def test_without_it_the_rate_stays_and_the_attitude_turns_by_it(
    options: NavigationOptions,
) -> None:
    """A second of a constant rate misses the truth by half the acceleration, no more."""
    process = RotationProcess(options)
    ahead = process.predict(true_state(process, 50.0), LEO, 50.0, 51.0)
    truth = TUMBLE.state(51.0)
    off_deg = np.rad2deg(turn_between(ahead.R_lvlh_from_target, truth.R_lvlh_from_target))
    assert 1e-5 < np.linalg.norm(off_deg) < 5e-3


@pytest.mark.parametrize("inertia", [None, XMM], ids=["constant rate", "Euler"])
@pytest.mark.parametrize(("options", "orbit"), [(PAPER, FAR), (BEST, LEO)], ids=["paper", "best"])
def test_the_covariance_follows_the_derivatives(
    inertia: Floats | None, options: NavigationOptions, orbit: KeplerOrbit
) -> None:
    process = RotationProcess(replace(options, asymmetry=0.0, inertia_accuracy=0.0), inertia)
    state = replace(true_state(process, 0.0), covariance=COVARIANCE)
    ahead = process.predict(state, orbit, 0.0, 3.0)
    step = 1e-5
    derivative = np.zeros((6, 6))
    for k, axis in enumerate(step * np.eye(6)):
        moved = process.predict(state.turned(axis, COVARIANCE), orbit, 0.0, 3.0)
        derivative[:3, k] = turn_between(ahead.R_lvlh_from_target, moved.R_lvlh_from_target) / step
        derivative[3:, k] = (moved.omega_in_target - ahead.omega_in_target) / step
    expected = derivative @ COVARIANCE @ derivative.T
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    # Euler's equation is taken at the mean rate of the step.
    np.testing.assert_allclose(ahead.covariance / scale, expected / scale, atol=2e-3)


def test_relative_and_inertial_rates_carry_the_same_error() -> None:
    """A small error of attitude moves the local frame's rate as seen from the target."""
    process = RotationProcess(BEST)
    state = true_state(process, 7.0)
    omega, covariance = process.relative_from_state(state, LEO, 7.0)
    back = process.state_from_relative(state.R_lvlh_from_target, omega, covariance, LEO, 7.0)
    np.testing.assert_allclose(back.omega_in_target, state.omega_in_target, atol=1e-18)
    np.testing.assert_allclose(back.covariance, state.covariance, atol=1e-18)
    step = 1e-6
    for k, axis in enumerate(step * np.eye(6)):
        moved, _ = process.relative_from_state(state.turned(axis, COVARIANCE), LEO, 7.0)
        root = np.zeros((6, 6))
        root[k, k] = 1.0
        lone = RotationState(state.R_lvlh_from_target, state.omega_in_target, root)
        _, spread = process.relative_from_state(lone, LEO, 7.0)
        expected = np.outer(moved - omega, moved - omega) / step**2
        np.testing.assert_allclose(spread[3:, 3:], expected, atol=1e-8)


def test_what_an_inertia_leaves_open_is_what_wrong_inertias_do() -> None:
    """Against inertias drawn wrong: the accelerations they give, and their covariance."""
    accuracy, count = 0.01, 4000
    body, scale = FreeBody(XMM, accuracy), np.sqrt(np.diag(XMM))
    rng = np.random.default_rng(3)
    draws = rng.standard_normal((count, 3, 3))
    draws = np.triu(draws) + np.triu(draws, 1).transpose(0, 2, 1)
    rates = np.array(
        [FreeBody(XMM + accuracy * d * np.outer(scale, scale), 0.0).rate(OMEGA) for d in draws]
    )
    found = np.cov(rates.T)
    expected = body.rate_covariance(OMEGA)
    sigma = np.sqrt(np.diag(expected))
    spread = 5.0 * np.sqrt(2.0 / count)  # five sigmas of a drawn covariance, relative
    np.testing.assert_allclose(
        found / np.outer(sigma, sigma), expected / np.outer(sigma, sigma), atol=spread
    )


def test_the_asymmetry_bounds_what_a_free_body_does() -> None:
    """Equation 10's noise: the acceleration of any body is below its rate squared."""
    rng = np.random.default_rng(4)
    for _ in range(200):
        sides = rng.uniform(0.05, 1.0, size=3)
        moments = np.array([sides[1] + sides[2], sides[0] + sides[2], sides[0] + sides[1]])
        omega = rng.standard_normal(3)
        rate = FreeBody(np.diag(moments), 0.0).rate(omega)
        assert np.linalg.norm(rate) <= omega @ omega


def test_turns_are_small_rotations_on_the_right() -> None:
    start = Rotation.from_rotvec([0.1, 2.0, -0.4]).as_matrix()
    turn = np.array([0.01, -0.02, 0.03])
    np.testing.assert_allclose(
        turn_between(start, start @ Rotation.from_rotvec(turn).as_matrix()), turn, atol=1e-14
    )


@pytest.mark.parametrize("angle_rad", [1e-9, 1e-3, 1.0, 2.6, 2.8, np.pi - 1e-4, np.pi - 1e-9])
def test_turns_of_any_size_are_found_again(angle_rad: float) -> None:
    """Up to half a turn, where the sines alone no longer tell the axis."""
    start = Rotation.from_rotvec([0.1, 2.0, -0.4]).as_matrix()
    for axis in Rotation.random(20, random_state=3).as_matrix()[:, 0]:
        end = start @ Rotation.from_rotvec(angle_rad * axis).as_matrix()
        turn = turn_between(start, end)
        away = Rotation.from_matrix(end.T @ start @ Rotation.from_rotvec(turn).as_matrix())
        assert away.magnitude() < 1e-12 + 1e-7 * angle_rad
        assert np.linalg.norm(turn) == pytest.approx(angle_rad, rel=1e-6)


@pytest.mark.parametrize("inertia", [None, XMM], ids=["constant rate", "Euler"])
def test_the_noise_is_the_integral_over_the_step(inertia: Floats | None) -> None:
    """Accelerations left out, carried on from each instant of the step to its end: quadrature."""
    process = RotationProcess(replace(BEST, asymmetry=0.3, inertia_accuracy=0.2), inertia)
    omega, step_s = np.deg2rad([3.0, -8.0, 5.0]), 4.0
    still = RotationState(np.eye(3), omega, np.zeros((6, 6)))
    ahead = process.predict(still, LEO, 0.0, step_s)
    mean = 0.5 * (omega + ahead.omega_in_target)
    spin = LEO.anomaly_rate(step_s)
    flow = np.zeros((6, 6))
    flow[:3, :3], flow[:3, 3:] = np.cross(np.eye(3), mean), np.eye(3)  # v -> v x omega
    flow[:3, :3] = flow[:3, :3].T
    if inertia is not None:
        slight = 1e-6
        body = FreeBody(inertia, 0.2)
        flow[3:, 3:] = np.stack(
            [
                (body.rate(mean + e) - body.rate(mean - e)) / (2.0 * slight)
                for e in slight * np.eye(3)
            ],
            axis=1,
        )
    density = np.zeros((6, 6))
    density[3:, 3:] = (
        2.0 / max(float(np.linalg.norm(mean)), spin) * process.acceleration_covariance(mean, spin)
    )
    nodes, weights = np.polynomial.legendre.leggauss(12)
    expected = np.zeros((6, 6))
    for node, weight in zip(0.5 * step_s * (nodes + 1.0), 0.5 * step_s * weights, strict=True):
        carried = expm(flow * node)
        expected += weight * carried @ density @ carried.T
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    np.testing.assert_allclose(ahead.covariance / scale, expected / scale, atol=1e-6)
