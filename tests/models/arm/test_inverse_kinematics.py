"""Every pose that an arm can take is found again, within its limits; others are refused by name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.arm.arm import Arm
from models.arm.house_arm import house_arm
from models.arm.inverse_kinematics import rotation_vector, search, solutions
from models.arm.kinematics import base_from_tool
from models.arm.unreachable import unreachable
from models.pose import RigidTransform, pose_error
from tests.support.arms import drawn_angles, drawn_arm

POSES = 200
FOUND_M, FOUND_DEG = 1e-9, 1e-7  # a search ends at 1e-10 of the reach, and of a radian


def test_every_reachable_pose_is_found_within_the_limits():
    arm, rng, found = house_arm(), np.random.default_rng(14), 0
    for _ in range(POSES):
        aim = base_from_tool(arm, drawn_angles(arm, rng))
        angles = next(solutions(arm, aim), None)
        if angles is None:
            continue
        found += 1
        error = pose_error(base_from_tool(arm, angles), aim)
        assert np.linalg.norm(error.position_m) < FOUND_M
        assert error.attitude_deg < FOUND_DEG
        assert (angles >= arm.lower_rad).all()
        assert (angles <= arm.upper_rad).all()
    assert found == POSES


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_so_it_is_with_any_arm(seed):
    rng = np.random.default_rng(seed)
    arm = drawn_arm(rng)
    aim = base_from_tool(arm, drawn_angles(arm, rng))
    angles = next(solutions(arm, aim))
    np.testing.assert_allclose(
        base_from_tool(arm, angles).matrix(), aim.matrix(), atol=10 * FOUND_M
    )


def test_solutions_are_many_and_always_the_same():
    arm = house_arm()
    aim = base_from_tool(arm, np.deg2rad([10.0, 50.0, 20.0, -80.0, 30.0, 60.0, 10.0]))
    first, again = list(solutions(arm, aim)), list(solutions(arm, aim))
    np.testing.assert_array_equal(first, again)
    elbows = np.array(first)[:, 3]
    assert elbows.min() < -0.5, "the elbow bends one way"
    assert elbows.max() > 0.5, "and the other"


def test_a_search_stays_near_where_it_begins():
    arm = house_arm()
    start = np.deg2rad([10.0, 50.0, 20.0, -80.0, 30.0, 60.0, 10.0])
    near = search(arm, base_from_tool(arm, start + 0.01), start)
    assert near.found
    assert np.abs(near.angles_rad - start).max() < 0.05


@settings(max_examples=100, deadline=None)
@given(
    axis=st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda a: np.linalg.norm(a) > 1e-3),
    angle=st.sampled_from([0.0, 1e-12, 1e-8, 1e-5, 0.5, 2.0, 3.1, np.pi - 1e-9, np.pi]),
)
def test_the_rotation_vector_is_scipys(axis, angle):
    vector = angle * np.array(axis) / np.linalg.norm(axis)
    matrix = Rotation.from_rotvec(vector).as_matrix()
    back = Rotation.from_rotvec(rotation_vector(matrix)).as_matrix()
    np.testing.assert_allclose(back, matrix, atol=1e-7)


def refused(arm: Arm, aim: RigidTransform) -> str:
    """Return what is said of a pose that no search meets."""
    assert next(solutions(arm, aim), None) is None
    return str(unreachable(arm, aim, "set-point 3, contact,"))


def test_a_pose_beyond_the_links_names_the_longest():
    message = refused(house_arm(), RigidTransform(np.eye(3), np.array([0.0, 0.0, 3.45])))
    assert "expected set-point 3, contact, within the reach" in message
    assert "0.500 m beyond" in message
    assert "the longest is link 3, after joint shoulder_yaw, of 1.050 m" in message
    assert "the nearest it comes is 0.500 m" in message


def test_a_pose_behind_a_limit_names_the_joint():
    arm = house_arm()
    bent = np.deg2rad([0.0, 20.0, 0.0, -140.0, 0.0, 40.0, 0.0])
    stiff = [
        replace(j, lower_rad=-0.5, upper_rad=0.5) if j.name == "elbow" else j for j in arm.joints
    ]
    message = refused(replace(arm, joints=tuple(stiff)), base_from_tool(arm, bent))
    assert "joint elbow stops at" in message
    assert "which forbids it" in message


def test_a_pose_too_near_is_told_apart_from_one_too_far():
    arm = house_arm()
    long_hand = replace(arm, last_from_tool=RigidTransform(np.eye(3), np.array([0.0, 0.0, 4.0])))
    message = refused(long_hand, RigidTransform(np.eye(3), np.array([0.1, 0.0, 0.2])))
    assert "even without limits" in message
    assert "the end effector, 4.000 m long" in message


@settings(max_examples=40, deadline=None)
@given(
    angles=st.lists(st.sampled_from([-1.0, -0.5, 0.0, 0.5, 1.0]), min_size=7, max_size=7),
    start=st.lists(st.sampled_from([0.0, 0.5, 1.0]), min_size=7, max_size=7),
    shift=st.sampled_from([0.0, 1e-9, 0.3]),
)
def test_where_axes_line_up_and_joints_stand_at_limits_a_search_just_ends(angles, start, shift):
    arm = house_arm()
    span = arm.upper_rad - arm.lower_rad
    aim = base_from_tool(arm, np.array(angles) * arm.upper_rad)
    aim = RigidTransform(aim.rotation, aim.translation + shift)
    attempt = search(arm, aim, arm.lower_rad + np.array(start) * span)
    assert np.isfinite(attempt.angles_rad).all()
    assert (attempt.angles_rad >= arm.lower_rad).all()
    assert (attempt.angles_rad <= arm.upper_rad).all()
