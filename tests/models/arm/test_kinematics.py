"""Where links are against textbook arms, and how they move against small steps."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arm.arm import Arm, Capsule, Joint
from models.arm.denavit_hartenberg import Row, joints_of
from models.arm.house_arm import FORE_M, HAND_M, SHOULDER_M, UPPER_M, house_arm
from models.arm.kinematics import base_from_tool, chain, chaser_from_links, jacobian
from models.pose import RigidTransform
from tests.support.arms import drawn_angles, drawn_arm

STEP_RAD = 1e-6
DIFFERENCED = 1e-8  # central differences of lengths of a metre: 1e-16 / 1e-6, and its square
EXACT = 1e-13


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), joints=st.integers(1, 9))
def test_the_jacobian_is_how_the_tool_moves(seed, joints):
    rng = np.random.default_rng(seed)
    arm = drawn_arm(rng, joints)
    angles = drawn_angles(arm, rng)
    here = base_from_tool(arm, angles).rotation
    for k, column in enumerate(jacobian(arm, angles).T):
        step = np.zeros(joints)
        step[k] = STEP_RAD
        ahead, behind = base_from_tool(arm, angles + step), base_from_tool(arm, angles - step)
        spin = (ahead.rotation - behind.rotation) @ here.T / (2.0 * STEP_RAD)
        turned = [spin[2, 1], spin[0, 2], spin[1, 0]]
        moved = (ahead.translation - behind.translation) / (2.0 * STEP_RAD)
        np.testing.assert_allclose(column, [*turned, *moved], atol=DIFFERENCED)


def test_a_flat_arm_of_two_links_is_that_of_the_textbook():
    rows = [Row(f"j{k}", length, 0.0, 0.0, 0.0, -180.0, 180.0) for k, length in enumerate((2, 1))]
    joints, flange = joints_of(rows)
    arm = Arm("flat", RigidTransform.identity(), joints, flange, ())
    one, two = 0.3, 0.9
    pose = base_from_tool(arm, [one, two])
    expected = [2 * np.cos(one) + np.cos(one + two), 2 * np.sin(one) + np.sin(one + two), 0.0]
    np.testing.assert_allclose(pose.translation, expected, atol=EXACT)
    np.testing.assert_allclose(
        pose.rotation[:2, 0], [np.cos(one + two), np.sin(one + two)], atol=EXACT
    )


def test_the_two_conventions_tell_one_arm():
    """A Craig row k has the alpha and the a of Denavit and Hartenberg's row k - 1."""
    rng = np.random.default_rng(3)
    numbers = [rng.uniform(-1.0, 1.0, 4) for _ in range(5)]
    classic = [
        Row(f"j{k}", a, 90 * alpha, d, 90 * theta, -90, 90)
        for k, (a, alpha, d, theta) in enumerate(numbers)
    ]
    behind = [(0.0, 0.0), *((row.a_m, row.alpha_deg) for row in classic)]
    craig = [
        Row(row.name, a, alpha, row.d_m, row.theta_deg, -90, 90)
        for row, (a, alpha) in zip(classic, behind, strict=False)
    ]
    first, flange = joints_of(classic)
    second, end = joints_of(craig, craig=True)
    last = RigidTransform(np.eye(3), np.array([classic[-1].a_m, 0.0, 0.0]))
    angles = rng.uniform(-1.0, 1.0, 5)
    one = base_from_tool(Arm("one", last, first, flange, ()), angles)
    other = base_from_tool(Arm("two", last, second, end, ()), angles)
    # Craig's last frame stands before the last row's own a and alpha.
    np.testing.assert_allclose((other @ last).translation, one.translation, atol=EXACT)
    np.testing.assert_allclose(other.rotation[:, 0], one.rotation[:, 0], atol=EXACT)


def test_stretched_the_house_arm_is_as_long_as_its_links():
    arm = house_arm()
    length = SHOULDER_M + UPPER_M + FORE_M + HAND_M
    np.testing.assert_allclose(base_from_tool(arm, np.zeros(7)).translation, [0, 0, length])
    assert arm.reach_m == pytest.approx(length)
    assert 2.5 < length < 4.2, "as DEOS and e.Deorbit plan"


def test_links_stand_on_the_chaser():
    arm = house_arm()
    links = chaser_from_links(arm, np.zeros(7))
    assert len(links) == len(arm.joints) + 1
    np.testing.assert_array_equal(links[0].translation, arm.chaser_from_base.translation)


def test_what_is_no_arm_is_refused():
    here = RigidTransform.identity()
    with pytest.raises(ValueError, match="joint elbow with a lower limit below its upper one"):
        Joint("elbow", here, 1.0, -1.0)
    with pytest.raises(ValueError, match="an arm with joints"):
        Arm("none", here, (), here, ())
    with pytest.raises(ValueError, match="expected 7 angles"):
        chain(house_arm(), np.zeros(6))
    with pytest.raises(ValueError, match="radius above 0"):
        Capsule(0, "rod", np.zeros(3), np.ones(3), 0.0)
    joint = Joint("j", here, -1.0, 1.0)
    rod = Capsule(2, "rod", np.zeros(3), np.ones(3), 0.1)
    with pytest.raises(ValueError, match="got rod on none"):
        Arm("short", here, (joint,), here, (rod,))


def test_the_middle_of_an_arm_is_halfway_between_its_limits():
    arm = house_arm()
    np.testing.assert_allclose(arm.middle_rad - arm.lower_rad, arm.upper_rad - arm.middle_rad)
    own = drawn_arm(np.random.default_rng(3))
    np.testing.assert_allclose(own.middle_rad - own.lower_rad, own.upper_rad - own.middle_rad)
    assert (own.upper_rad > own.lower_rad).all()


def test_the_middle_is_as_far_from_either_limit():
    joints, flange = joints_of(
        [Row("a", 1.0, 0.0, 0.0, 0.0, -30.0, 90.0), Row("b", 1.0, 0.0, 0.0, 0.0, -170.0, 20.0)]
    )
    arm = Arm("two", RigidTransform.identity(), joints, flange, ())
    np.testing.assert_allclose(np.rad2deg(arm.middle_rad), [30.0, -75.0])
