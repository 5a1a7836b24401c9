"""Errors against scipy's own, and consistency against filters whose truth is drawn."""

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

from bench.scoring.tumble.navigation_errors import (
    innovation_nis,
    navigation_error,
    normalised_square,
    pose_error_sizes,
    rotation_error,
)
from models.estimate import Detections, Estimate, PoseEstimate
from models.motion.relative_state import RelativeState
from models.motion.tumble import CAM_FROM_LVLH
from models.pose import RigidTransform, pose_error
from pipelines.filters import kalman

NOTHING = Detections.none()
ROUNDING = 1e-12


def state(rng, rho=None, attitude=None):
    return RelativeState(
        0.0,
        rng.normal(size=3) if rho is None else rho,
        rng.normal(size=3),
        Rotation.random(rng=rng).as_matrix() if attitude is None else attitude,
        rng.normal(size=3),
    )


def spread(rng, size):
    root = rng.normal(size=(size, size))
    return root @ root.T + 0.1 * np.eye(size)


def test_sizes_are_those_of_pose_error():
    rng = np.random.default_rng(0)
    for _ in range(20):
        one, other = (
            RigidTransform(Rotation.random(rng=rng).as_matrix(), rng.normal(size=3))
            for _ in range(2)
        )
        moved, turned = pose_error_sizes(one, other)
        reference = pose_error(one, other)
        assert moved == pytest.approx(np.linalg.norm(reference.position_m), rel=ROUNDING)
        assert turned == pytest.approx(reference.attitude_deg, rel=1e-9)


def test_equation_16_agrees_where_it_keeps_its_digits():
    rng = np.random.default_rng(1)
    one, other = state(rng), state(rng)
    turn = one.R_lvlh_from_target.T @ other.R_lvlh_from_target
    printed = np.arccos(1.0 - np.trace(np.eye(3) - turn) / 2.0)
    assert np.linalg.norm(rotation_error(one, other)[:3]) == pytest.approx(printed, rel=1e-9)


def test_the_turn_makes_the_estimate_true():
    rng = np.random.default_rng(2)
    estimate, truth = state(rng), state(rng)
    turn = Rotation.from_rotvec(rotation_error(estimate, truth)[:3]).as_matrix()
    np.testing.assert_allclose(
        estimate.R_lvlh_from_target @ turn, truth.R_lvlh_from_target, atol=ROUNDING
    )


def test_normalised_square_is_that_of_the_inverse():
    rng = np.random.default_rng(3)
    error, covariance = rng.normal(size=6), spread(rng, 6)
    expected = error @ np.linalg.inv(covariance) @ error
    assert normalised_square(error, covariance) == pytest.approx(expected, rel=1e-9)
    assert np.isnan(normalised_square(error, -covariance))
    assert np.isnan(normalised_square(error, None))


def test_nees_of_honest_covariances_is_chi_square():
    rng = np.random.default_rng(4)
    truth = state(rng)
    translation, rotation = spread(rng, 6), 1e-8 * spread(rng, 6)
    squares = []
    for _ in range(400):
        moved = rng.multivariate_normal(np.zeros(6), translation)
        turned = rng.multivariate_normal(np.zeros(6), rotation)
        own = RelativeState(
            0.0,
            truth.rho_in_lvlh - moved[:3],
            truth.rho_dot_in_lvlh - moved[3:],
            truth.R_lvlh_from_target @ Rotation.from_rotvec(turned[:3]).as_matrix().T,
            truth.omega_target_wrt_lvlh_in_target - turned[3:],
        )
        states = own.named(translation, rotation)
        said = Estimate(0, 0.0, reason="none", mode="predicted", states=states)
        error = navigation_error(said, truth, CAM_FROM_LVLH)
        squares.append([error.nees_translation, error.nees_rotation])
    for column in np.array(squares).T:
        assert stats.kstest(column, "chi2", args=(6,)).pvalue > 1e-4


def test_nis_from_the_estimate_alone_is_the_innovations():
    """Against the innovation's own, of a Kalman filter that is told everything."""
    rng = np.random.default_rng(5)
    seen = np.hstack([np.eye(3), np.zeros((3, 3))])
    for _ in range(5):
        noise, attitude_noise = 1e-4 * spread(rng, 6), 1e-6 * spread(rng, 3)
        true = RigidTransform(Rotation.random(rng=rng).as_matrix(), np.array([0.1, -0.2, 30.0]))
        noise[:3, :3] = true.rotation @ attitude_noise @ true.rotation.T
        noise[:3, 3:], noise[3:, :3] = 0.0, 0.0
        pose = PoseEstimate(true, noise, 1.0)
        mount = CAM_FROM_LVLH.rotation
        place = mount.T @ true.translation
        before, before_spread = np.array([*(place + 0.01), 0, 0, 0]), 1e-3 * spread(rng, 6)
        after = kalman.update(before, before_spread, place, seen, mount.T @ noise[3:, 3:] @ mount)
        turn_spread = 1e-5 * spread(rng, 6)
        turn = 1e-6 * rng.normal(size=3)  # measured, seen from the prediction
        turned = kalman.update(np.zeros(6), turn_spread, turn, seen, attitude_noise)
        measured = mount.T @ true.rotation
        corrected = (
            measured
            @ Rotation.from_rotvec(turn).as_matrix().T
            @ Rotation.from_rotvec(turned.state[:3]).as_matrix()
        )
        own = RelativeState(0.0, after.state[:3], after.state[3:], corrected, np.zeros(3))
        states = own.named(after.covariance, turned.covariance)
        said = Estimate(0, 0.0, pose, detections=NOTHING, mode="tracked", states=states)
        translation, rotation = innovation_nis(said, CAM_FROM_LVLH)
        assert translation == pytest.approx(after.nis, rel=1e-6)
        # A turn of a microradian composes with others to its square.
        assert rotation == pytest.approx(turned.nis, rel=1e-4)


def test_no_state_is_no_number():
    said = Estimate(0, 0.0, reason="none", detections=NOTHING, mode="searching")
    error = navigation_error(said, state(np.random.default_rng(6)), CAM_FROM_LVLH)
    assert np.isnan(error.row()).all()


def test_a_mount_that_is_told_wrong_is_no_error_of_the_images_own_pose():
    """The camera's pose is judged by the camera's truth; a state derived by the mount is not."""
    truth = state(np.random.default_rng(7), rho=np.array([0.0, 30.0, 0.0]))
    seen = truth.cam_from_target(CAM_FROM_LVLH)
    told = CAM_FROM_LVLH.perturbed(np.deg2rad([0.0, 1.0, 0.0]), [0.01, 0.0, 0.0])
    pose = PoseEstimate(seen, np.eye(6), 1.0)
    said = Estimate(0, 0.0, pose, detections=NOTHING, mode="tracked")
    judged = navigation_error(said, truth, told, seen)
    assert (judged.raw_position_m, judged.raw_attitude_deg) == (0.0, pytest.approx(0.0, abs=1e-6))
    by_the_told_mount = navigation_error(said, truth, told)
    assert by_the_told_mount.raw_attitude_deg == pytest.approx(1.0, abs=1e-6)
