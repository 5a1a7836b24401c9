"""The next pose from the last ones, and how far off it may be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from models.arrays import Floats
from models.pose import RigidTransform, pose_error
from pipelines.chaser_fixed.options import options_for
from pipelines.pnp.motion_prediction import MotionPrediction, prior_covariance
from tests.support.synthetic_pair import (
    PRIOR_SIGMA_DEG,
    PRIOR_SIGMA_M,
    Scene,
    drawn_prior,
    facing_pose,
    knowledge_of,
)

KNOWLEDGE = knowledge_of(Scene(), facing_pose(6.7, (179.0, 2.0, 30.0)))
BEST, PAPER = options_for("best"), options_for("paper")
TINY = 1e-10 * np.eye(6)
TURN_RAD_S, SHIFT_M_S = np.array([1e-3, -2e-4, 3e-4]), np.array([0.002, -0.001, -0.015])


def moving(time_s: float) -> RigidTransform:
    """Return the pose of a constant velocity and turn rate."""
    return facing_pose(6.0).perturbed(time_s * TURN_RAD_S, time_s * SHIFT_M_S)


def squared_distance(pose: RigidTransform, from_pose: RigidTransform, covariance: Floats) -> float:
    turn = Rotation.from_matrix(pose.rotation @ from_pose.rotation.T).as_rotvec()
    away = np.concatenate([turn, pose.translation - from_pose.translation])
    return float(away @ np.linalg.solve(covariance, away))


def test_before_the_first_pose_there_is_the_prior() -> None:
    predicted = MotionPrediction(KNOWLEDGE, BEST).predict(12.0)
    assert predicted.pose is KNOWLEDGE.prior
    assert predicted.lost_frames == 0


def test_the_priors_covariance_is_that_of_its_draws() -> None:
    """3-2-1 angles drawn independently, as Table 5 has them, seen as left turns."""
    covariance = prior_covariance(KNOWLEDGE)
    draws = [drawn_prior(KNOWLEDGE.prior, seed) for seed in range(1500)]
    squares = [squared_distance(draw, KNOWLEDGE.prior, covariance) for draw in draws]
    low, high = chi2.ppf([0.0005, 0.9995], 6 * len(draws)) / len(draws)
    assert low < np.mean(squares) < high
    np.testing.assert_allclose(np.diag(covariance)[3:], PRIOR_SIGMA_M**2)
    assert np.sqrt(np.trace(covariance[:3, :3])) == pytest.approx(
        np.sqrt(3) * np.deg2rad(PRIOR_SIGMA_DEG[0]), rel=1e-3
    )


@pytest.mark.parametrize("ahead_s", [0.2, 1.0, 5.0])
def test_constant_velocity_is_carried_on_exactly(ahead_s: float) -> None:
    motion = MotionPrediction(KNOWLEDGE, BEST)
    motion.found(0.0, moving(0.0), TINY)
    motion.found(1.0, moving(1.0), TINY)
    error = pose_error(motion.predict(1.0 + ahead_s).pose, moving(1.0 + ahead_s))
    assert np.linalg.norm(error.position_m) < 1e-12
    assert error.attitude_deg < 1e-6


def test_the_paper_takes_the_last_pose() -> None:
    motion = MotionPrediction(KNOWLEDGE, PAPER)
    motion.found(0.0, moving(0.0), TINY)
    motion.found(1.0, moving(1.0), TINY)
    assert motion.predict(2.0).pose.translation == pytest.approx(moving(1.0).translation)


def test_the_stated_uncertainty_is_that_of_extrapolating_noisy_poses() -> None:
    """Two poses 1 s apart, carried on for 2 s: 3 and -2 times their errors."""
    calm = replace(BEST, acceleration_m_s2=0.0, acceleration_deg_s2=0.0)
    sigma = np.diag([1e-4, 2e-4, 1e-4, 1e-3, 1e-3, 3e-3])
    rng, squares = np.random.default_rng(4), []
    for _ in range(400):
        motion = MotionPrediction(KNOWLEDGE, calm)
        for time_s in (0.0, 1.0):
            step = sigma @ rng.standard_normal(6)
            motion.found(time_s, moving(time_s).perturbed(step[:3], step[3:]), sigma**2)
        predicted = motion.predict(3.0)
        squares.append(squared_distance(predicted.pose, moving(3.0), predicted.covariance))
    low, high = chi2.ppf([0.0005, 0.9995], 6 * 400) / 400
    assert low < np.mean(squares) < high


def test_uncertainty_grows_with_time() -> None:
    motion = MotionPrediction(KNOWLEDGE, BEST)
    motion.found(0.0, moving(0.0), TINY)
    one = [np.trace(motion.predict(time_s).covariance) for time_s in (0.1, 1.0, 10.0)]
    motion.found(0.2, moving(0.2), TINY)
    two = [np.trace(motion.predict(time_s).covariance) for time_s in (0.3, 1.0, 10.0)]
    assert one == sorted(one)
    assert two == sorted(two)
    assert two[1] < one[1]  # a known velocity is worth something


def test_lost_frames_are_counted_until_the_next_pose() -> None:
    motion = MotionPrediction(KNOWLEDGE, BEST)
    motion.lost()
    motion.lost()
    assert motion.predict(0.0).lost_frames == 2
    motion.found(1.0, moving(1.0), TINY)
    assert motion.predict(2.0).lost_frames == 0


@pytest.mark.parametrize("second_s", [1.0, 0.5])
def test_time_that_does_not_go_on_gives_no_velocity(second_s: float) -> None:
    motion = MotionPrediction(KNOWLEDGE, BEST)
    motion.found(1.0, moving(0.0), TINY)
    motion.found(second_s, moving(1.0), TINY)
    predicted = motion.predict(5.0)
    assert predicted.pose.translation == pytest.approx(moving(1.0).translation)
    assert np.isfinite(predicted.covariance).all()


def test_after_a_long_loss_the_prediction_stays_sane() -> None:
    motion = MotionPrediction(KNOWLEDGE, BEST)
    motion.found(0.0, moving(0.0), TINY)
    motion.found(0.2, moving(0.2), TINY)
    assert np.linalg.norm(motion.predict(1e6).pose.translation) < 10.0
