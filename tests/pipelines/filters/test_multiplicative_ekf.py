from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from models.motion.kepler_orbit import KeplerOrbit
from models.motion.tumble import Tumble
from pipelines.filters.multiplicative_ekf import update
from pipelines.filters.navigation_options import BEST
from pipelines.filters.rotation_process import RotationProcess, RotationState, turn_between

XMM = np.array([[7052.0, -820.0, -3991.0], [-820.0, 129129.0, 0.0], [-3991.0, 0.0, 131196.0]])
LEO = KeplerOrbit(7.1431e6, 1.4e-4, 1.7, 1.38, 1.5, 0.0)
SIGMA_DEG = np.array([0.1, 0.25, 0.15])
NOISE = np.diag(np.deg2rad(SIGMA_DEG)) ** 2
RUNS, FRAMES = 60, 15
TUMBLE = Tumble(
    LEO, np.array([0.0, 30.0, 0.0]), np.zeros(3), np.deg2rad([0.5, -0.3, 0.2]), XMM, FRAMES + 1.0
)


def believable(mean: float, freedom: int, count: int) -> bool:
    """Whether the mean of ``count`` chi2 numbers is believable: one false alarm in a thousand."""
    low, high = chi2.ppf([0.0005, 0.9995], freedom * count) / count
    return bool(low < mean < high)


def nees_and_nis(factor: float) -> tuple[float, float]:
    """Return both means for filters told ``factor`` times the variance of the measurements."""
    process = RotationProcess(replace(BEST, inertia_accuracy=0.0), XMM)
    first = np.zeros((6, 6))
    first[:3, :3], first[3:, 3:] = factor * NOISE, np.deg2rad(0.5) ** 2 * np.eye(3)
    truth = [TUMBLE.state(float(k)) for k in range(FRAMES + 1)]
    errors, innovations = [], []
    for run in range(RUNS):
        rng = np.random.default_rng([5, run])
        wrong = np.deg2rad(0.5) * rng.standard_normal(3)
        state: RotationState | None = None
        for k, true in enumerate(truth):
            off = Rotation.from_rotvec(np.deg2rad(SIGMA_DEG) * rng.standard_normal(3)).as_matrix()
            measured = true.R_lvlh_from_target @ off
            if state is None:
                omega = true.omega_target_wrt_lvlh_in_target + wrong
                omega = omega + measured.T @ [0.0, 0.0, LEO.anomaly_rate(0.0)]
                state = RotationState(measured, omega, first)
                continue
            found = update(process.predict(state, LEO, k - 1.0, float(k)), measured, factor * NOISE)
            state = found.state
            innovations.append(found.nis)
        assert state is not None
        omega, covariance = process.relative_from_state(state, LEO, float(FRAMES))
        turn = turn_between(state.R_lvlh_from_target, truth[-1].R_lvlh_from_target)
        rate = truth[-1].omega_target_wrt_lvlh_in_target - omega
        error = np.concatenate([turn, rate])
        errors.append(error @ np.linalg.solve(covariance, error))
    return float(np.mean(errors)), float(np.mean(innovations))


def test_on_a_tumbling_body_its_errors_are_as_large_as_it_says() -> None:
    nees, nis = nees_and_nis(1.0)
    assert believable(nees, 6, RUNS)
    assert believable(nis, 3, RUNS * FRAMES)


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_and_a_wrong_covariance_is_noticed(factor: float) -> None:
    nees, nis = nees_and_nis(factor)
    assert not believable(nees, 6, RUNS)
    assert not believable(nis, 3, RUNS * FRAMES)


def test_one_exact_measurement_is_believed() -> None:
    state = RotationState(np.eye(3), np.zeros(3), np.deg2rad(5.0) ** 2 * np.eye(6))
    measured = Rotation.from_rotvec([3.0, -40.0, 10.0], degrees=True).as_matrix()
    found = update(state, measured, 1e-14 * np.eye(3)).state
    np.testing.assert_allclose(found.R_lvlh_from_target, measured, atol=1e-9)
    assert np.linalg.eigvalsh(found.covariance)[0] > 0.0


def test_the_covariance_follows_the_attitude_that_a_large_correction_turns() -> None:
    """Against the derivative of errors about the new attitude by those about the old one.

    For a correction m that is the right Jacobian of rotations, ``I - [m]x / 2 + ...``; its second
    order, 5 % of one at 30 deg, is left out. Turned the wrong way it would be 50 % off.
    """
    spread = np.deg2rad([4.0, 6.0, 9.0])
    before = np.zeros((6, 6))
    before[:3, :3], before[3:, 3:] = np.diag(spread) ** 2, np.deg2rad(0.1) ** 2 * np.eye(3)
    measured = Rotation.from_rotvec([10.0, 20.0, 20.0], degrees=True).as_matrix()
    noise = np.deg2rad([5.0, 3.0, 8.0]) ** 2 * np.eye(3)
    found = update(RotationState(np.eye(3), np.zeros(3), before), measured, noise).state
    turn = turn_between(np.eye(3), found.R_lvlh_from_target)
    assert np.rad2deg(np.linalg.norm(turn)) > 15.0
    plain = np.linalg.inv(np.linalg.inv(before[:3, :3]) + np.linalg.inv(noise))
    step = 1e-6
    derivative = np.stack(
        [
            turn_between(
                found.R_lvlh_from_target, Rotation.from_rotvec(turn + axis).as_matrix()
            ) / step
            for axis in step * np.eye(3)
        ],
        axis=1,
    )  # fmt: skip
    expected = derivative @ plain @ derivative.T
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    np.testing.assert_allclose(found.covariance[:3, :3] / scale, expected / scale, atol=0.06)
    wrong_way = (derivative.T @ plain @ derivative) / scale
    assert np.abs(wrong_way - expected / scale).max() > 0.12
