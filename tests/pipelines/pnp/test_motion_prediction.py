"""Predictions of a motion that turns and moves at an even pace, which they follow exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.pose import RigidTransform
from pipelines.pnp.motion_prediction import MotionPrediction, Prediction
from tests.support.synthetic_pair import Scene, knowledge_of

TURN_DEG_S, SHIFT_M_S = np.array([3.0, -5.0, 2.0]), np.array([0.01, 0.02, -0.05])
COVARIANCE = np.diag([1e-6] * 3 + [1e-4] * 3)


@dataclass(frozen=True)
class Options:
    prediction: Prediction = "constant_velocity"
    acceleration_m_s2: float = 0.0
    acceleration_deg_s2: float = 0.0
    velocity_m_s: float = 0.1
    velocity_deg_s: float = 1.0


def pose_at(time_s: float) -> RigidTransform:
    """Return a pose that turns in the camera's axes, about the target's origin."""
    first = RigidTransform(
        Rotation.from_rotvec([0.4, 0.1, -0.7]).as_matrix(), np.array([0.1, -0.2, 5.0])
    )
    return first.perturbed(np.deg2rad(TURN_DEG_S) * time_s, SHIFT_M_S * time_s)


def prediction(options: Options | None = None) -> MotionPrediction:
    return MotionPrediction(knowledge_of(Scene(), RigidTransform.identity()), options or Options())


def same(one: RigidTransform, other: RigidTransform) -> bool:
    turn = Rotation.from_matrix(one.rotation @ other.rotation.T).magnitude()
    return bool(turn < 1e-12) and np.allclose(one.translation, other.translation, atol=1e-12)


def test_two_poses_are_carried_on() -> None:
    motion = prediction()
    motion.found(0.0, pose_at(0.0), COVARIANCE)
    motion.found(2.0, pose_at(2.0), COVARIANCE)
    assert same(motion.predict(5.0).pose, pose_at(5.0))
    assert same(motion.predict(1.0).pose, pose_at(2.0))  # never back


@pytest.mark.parametrize("ago_s", [0.1, 1.0, 2.0])
def test_shortly_before_is_on_the_way(ago_s: float) -> None:
    motion = prediction()
    motion.found(3.0, pose_at(3.0), COVARIANCE)
    before = motion.shortly_before(5.0, pose_at(5.0), ago_s)
    assert before is not None
    assert same(before, pose_at(5.0 - ago_s))
    assert motion.shortly_before(3.0, pose_at(3.0), ago_s) is None


def test_the_covariance_is_that_of_a_line_through_two_points() -> None:
    """Errors of both poses, independent, carried on by the same line."""
    motion = prediction()
    motion.found(0.0, pose_at(0.0), COVARIANCE)
    motion.found(2.0, pose_at(2.0), 4.0 * COVARIANCE)
    ahead = motion.predict(3.0).covariance
    np.testing.assert_allclose(ahead, (1.5**2 * 4.0 + 0.5**2) * COVARIANCE, rtol=1e-12)


def test_a_prior_grows_old_until_there_is_a_pose() -> None:
    """It is of the first frame; a second later the target may have moved as far as its speed."""
    motion, options = prediction(), Options()
    first = motion.predict(10.0).covariance
    later = motion.predict(13.0).covariance
    grown = np.deg2rad(options.velocity_deg_s * 3.0) ** 2, (options.velocity_m_s * 3.0) ** 2
    np.testing.assert_allclose(np.diag(later - first), [*3 * [grown[0]], *3 * [grown[1]]])
    np.testing.assert_array_equal(motion.predict(9.0).covariance, first)  # never surer
