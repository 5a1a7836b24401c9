"""The analytic Jacobians against finite differences, and the projection against OpenCV."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.pose import RigidTransform, euler_321_from_rotation, rotation_from_euler_321
from pipelines.pnp.problem import undistortion_gain
from pipelines.pnp.projection_jacobian import (
    jacobian_by_turn,
    project_normalised,
    turn_from_euler_rates,
)
from tests.support.synthetic_pair import CAMERA_2048, PATTERN, facing_pose

STEP = 1e-6  # central differences in double precision: error about 1e-10, relative to values near 1
FINITE_DIFFERENCE_ERROR = 1e-8

angles = st.floats(-3.0, 3.0)
tilts = st.tuples(st.floats(150.0, 210.0), st.floats(-30.0, 30.0), st.floats(-180.0, 180.0))
ranges = st.floats(1.5, 10.0)


def central_differences(function, size: int) -> Floats:
    columns = []
    for index in range(size):
        step = np.zeros(size)
        step[index] = STEP
        columns.append((function(step) - function(-step)) / (2.0 * STEP))
    return np.stack(columns, axis=-1)


def test_the_projection_is_opencvs() -> None:
    pose = facing_pose(3.0, (175.0, 4.0, 20.0))
    turn, _ = cv2.Rodrigues(pose.rotation)
    theirs, _ = cv2.projectPoints(PATTERN.points_in_target, turn, pose.translation, np.eye(3), None)
    ours = project_normalised(pose.rotation, pose.translation, PATTERN.points_in_target)
    np.testing.assert_allclose(ours, theirs[:, 0], atol=1e-14)


@given(tilts, ranges)
def test_the_jacobian_by_turn_is_that_of_a_perturbed_pose(
    euler_deg: tuple[float, float, float], range_m: float
) -> None:
    pose = facing_pose(range_m, euler_deg)

    def project(step: Floats) -> Floats:
        moved = pose.perturbed(step[:3], step[3:])
        return project_normalised(moved.rotation, moved.translation, PATTERN.points_in_target)

    analytic = jacobian_by_turn(pose.rotation, pose.translation, PATTERN.points_in_target)
    np.testing.assert_allclose(
        analytic, central_differences(project, 6), atol=FINITE_DIFFERENCE_ERROR
    )


@given(tilts, ranges)
def test_the_jacobian_by_euler_angles(
    euler_deg: tuple[float, float, float], range_m: float
) -> None:
    pose = facing_pose(range_m, euler_deg)
    angles_rad = np.deg2rad(euler_321_from_rotation(pose.rotation))

    def project(step: Floats) -> Floats:
        rotation = rotation_from_euler_321(np.rad2deg(angles_rad + step[:3]))
        return project_normalised(rotation, pose.translation + step[3:], PATTERN.points_in_target)

    analytic = jacobian_by_turn(pose.rotation, pose.translation, PATTERN.points_in_target)
    analytic[:, :, :3] = analytic[:, :, :3] @ turn_from_euler_rates(angles_rad)
    np.testing.assert_allclose(
        analytic, central_differences(project, 6), atol=FINITE_DIFFERENCE_ERROR
    )


@given(angles, st.floats(-1.4, 1.4), angles)
def test_euler_rates_make_a_left_turn(alpha: float, beta: float, gamma: float) -> None:
    euler = np.array([alpha, beta, gamma])

    def turn(step: Floats) -> Floats:
        moved = rotation_from_euler_321(np.rad2deg(euler + step))
        still = rotation_from_euler_321(np.rad2deg(euler))
        return Rotation.from_matrix(moved @ still.T).as_rotvec()

    np.testing.assert_allclose(
        turn_from_euler_rates(euler), central_differences(turn, 3), atol=FINITE_DIFFERENCE_ERROR
    )


def test_points_behind_the_camera_have_no_image() -> None:
    pose = RigidTransform(np.eye(3), np.array([0.0, 0.0, -5.0]))
    assert np.isnan(project_normalised(pose.rotation, pose.translation, np.zeros((2, 3)))).all()


@pytest.mark.parametrize("k1", [0.0, -0.1])
def test_undistortion_gain(k1: float) -> None:
    camera = replace(CAMERA_2048, k1=k1, p1=1e-3)
    pixel = np.array([[400.0, 1500.0]])
    gain = undistortion_gain(camera, camera.normalise(pixel))[0]

    def normalise(step: Floats) -> Floats:
        return camera.normalise(pixel + 1e3 * step)[0]  # steps of 1e-3 px

    expected = central_differences(normalise, 2) / 1e3
    np.testing.assert_allclose(gain * 2196.0, expected * 2196.0, atol=1e-6)
