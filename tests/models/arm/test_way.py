"""The way of the house's arm to the Maxar's ring: met, clear, and looking at the markers."""

from __future__ import annotations

import numpy as np
import pytest

from models.arm.clearance import Surroundings
from models.arm.hand_camera import (
    END_EFFECTOR_IN_CAMERA_M,
    HAND_CAMERA,
    hand_from_chaser,
    hand_prior,
    with_hand_camera,
)
from models.arm.house_arm import NEAR_DEG, house_arm
from models.arm.kinematics import chaser_from_tool
from models.arm.set_points import RESOLUTION_DEG, ArmMotion, SetPoint, planned, ways
from models.arm.way import CLEAR_M, Bystanders, least_clearance
from models.camera import camera_preset
from models.errors import ScenarioError
from models.motion.approach import Approach
from models.onboard import PosePrior
from models.pose import RigidTransform, pose_error
from models.spacecraft.armed_chaser import chaser_without_arm
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.solids import box

GRASP = RigidTransform(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.83, 0.0]))
READY = RigidTransform(
    np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]), np.array([-0.2, -0.85, 0.5])
)
TIMES_S = (240.0, 282.3, 330.0)
MET_M, MET_DEG = 1e-6, 1e-5  # of commanded angles of 1e-6 deg
MARKERS_IN_GRASP = np.array([[-0.15, -0.15, 0.0], [0.15, -0.15, 0.0], [0.15, -0.25, 0.0]])
RUNS = 400


def points(stand_off_m: float = 1.0) -> list[SetPoint]:
    """Return the three set-points of Opromolla et al. 2022 over the house's approach."""
    approach = Approach()
    before = RigidTransform(np.eye(3), np.array([0.0, 0.0, -stand_off_m]))
    looks, touches = (approach.cam_from_target(t) for t in TIMES_S[1:])
    return [
        SetPoint(TIMES_S[0], READY),
        SetPoint(TIMES_S[1], looks @ GRASP @ before),
        SetPoint(TIMES_S[2], touches @ GRASP),
    ]


@pytest.fixture(scope="module")
def motion() -> ArmMotion:
    return planned(with_hand_camera(house_arm()), points(), NEAR_DEG)


def test_the_three_set_points_are_met(motion):
    for point in points():
        angles_deg = motion.angles_at(point.time_s)
        error = pose_error(
            chaser_from_tool(motion.arm, np.deg2rad(angles_deg)), point.chaser_from_tool
        )
        assert np.linalg.norm(error.position_m) < MET_M
        assert error.attitude_deg < MET_DEG
        steps = angles_deg / RESOLUTION_DEG
        np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)


def test_joints_go_at_even_rates_and_stand_still_outside(motion):
    first, second, third = motion.angles_deg
    np.testing.assert_allclose(motion.angles_at(261.15), 0.5 * (first + second), atol=1e-9)
    np.testing.assert_allclose(motion.angles_at(306.15), 0.5 * (second + third), atol=1e-9)
    np.testing.assert_array_equal(motion.angles_at(0.0), first)
    np.testing.assert_array_equal(motion.angles_at(999.0), third)


def test_the_joints_keep_away_from_their_limits(motion):
    lower, upper = np.rad2deg(motion.arm.lower_rad), np.rad2deg(motion.arm.upper_rad)
    room = np.minimum(motion.angles_deg - lower, upper - motion.angles_deg)
    assert room.min() > 10.0


@pytest.mark.parametrize("time_s", np.linspace(282.3, 330.0, 7))
def test_from_the_second_set_point_on_the_markers_are_in_the_hand_cameras_image(motion, time_s):
    """Opromolla et al. 2022, section 3.2.1: from 1.4 m to 0.4 m, the whole support in view."""
    camera = camera_preset("eye_in_hand")
    hand_from_target = hand_from_chaser(
        motion.arm, motion.angles_at(time_s)
    ) @ Approach().cam_from_target(time_s)
    corners = hand_from_target @ GRASP @ MARKERS_IN_GRASP
    assert camera.contains(camera.project(corners)).all()
    share = (time_s - TIMES_S[1]) / (TIMES_S[2] - TIMES_S[1])
    assert corners[:, 2].mean() == pytest.approx(1.4 - share, abs=0.01)


def test_at_contact_the_camera_stands_behind_and_beside_the_grasping_point(motion):
    hand_from_target = hand_from_chaser(
        motion.arm, motion.angles_at(330.0)
    ) @ Approach().cam_from_target(330.0)
    touched = hand_from_target @ GRASP.translation
    np.testing.assert_allclose(touched, END_EFFECTOR_IN_CAMERA_M, atol=MET_M)


def test_nothing_of_the_hand_is_in_its_cameras_image():
    """The hand runs 0.2 m beside the lens; its gripper's tip is just below the field of view."""
    arm = with_hand_camera(house_arm())
    hand_from_last = (
        RigidTransform(np.eye(3), np.array(END_EFFECTOR_IN_CAMERA_M)) @ arm.last_from_tool.inverse()
    )
    below = np.array([0.0, np.cos(np.deg2rad(22.5)), -np.sin(np.deg2rad(22.5))])
    for capsule in arm.capsules:
        if capsule.link == len(arm.joints) and capsule.name != HAND_CAMERA:
            ends = hand_from_last @ np.stack([capsule.start_in_link, capsule.end_in_link])
            assert (ends @ below).min() > capsule.radius_m, capsule.name


def plate(where: RigidTransform, size: tuple[float, float, float]) -> Surroundings:
    """Return a plate in the frame of the chaser or the target."""
    mesh = box(size)
    mesh.apply_transform(where.matrix())
    return Surroundings.of(
        Spacecraft("plate", (Part("plate", mesh, "black_paint"),), None, np.zeros(3))
    )


def test_the_arm_stays_clear_of_the_chaser_and_of_a_plate_in_the_rings_plane(motion):
    here = Surroundings.of(chaser_without_arm())
    there = plate(RigidTransform(np.eye(3), np.array([0.0, 0.0, -0.05])), (2.4, 2.4, 0.1))
    _, nearest = least_clearance(motion, Bystanders(here, there, Approach().cam_from_target))
    assert nearest.distance_m > CLEAR_M


def test_what_is_in_the_way_is_named_with_its_time(motion):
    passed = chaser_from_tool(motion.arm, np.deg2rad(motion.angles_at(265.0))).translation
    here = plate(RigidTransform(np.eye(3), passed), (0.4, 0.4, 0.02))
    there = plate(RigidTransform(np.eye(3), np.array([0.0, 0.0, -9.0])), (1.0, 1.0, 0.1))
    time_s, nearest = least_clearance(motion, Bystanders(here, there, Approach().cam_from_target))
    assert nearest.distance_m < 0.0
    assert nearest.second == "plate"
    assert abs(time_s - 265.0) < 5.0


def test_other_postures_are_found_and_differ():
    found = []
    for motion in ways(house_arm(), points(), NEAR_DEG):
        found.append(motion.angles_deg[1])
        if len(found) == 3:
            break
    apart = [np.abs(a - b).max() for a in found for b in found if a is not b]
    assert min(apart) > 1.0


def test_a_set_point_out_of_reach_is_named():
    with pytest.raises(
        ScenarioError, match=r"expected set-point 2, camera on the markers, within"
    ) as e:
        planned(house_arm(), points(stand_off_m=-1.5), NEAR_DEG)
    assert "m beyond; the longest is link" in str(e.value)


def test_the_prior_by_way_of_the_arm_says_how_far_off_it_is(motion):
    """Drawn errors of pose, joints and mount spread as the sigmas that it states."""
    rng = np.random.default_rng(7)
    arm, joints = motion.arm, motion.angles_at(282.3)
    truth = Approach().cam_from_target(282.3)
    mount = RigidTransform(np.eye(3), np.array(END_EFFECTOR_IN_CAMERA_M))
    sigma_m, sigma_deg = np.array([0.01, 0.01, 0.02]), np.array([0.3, 0.2, 0.4])
    true_hand = hand_from_chaser(arm, joints, mount) @ truth
    errors = []
    for _ in range(RUNS):
        seen = truth.perturbed(
            np.deg2rad(sigma_deg * rng.standard_normal(3)), sigma_m * rng.standard_normal(3)
        )
        read = joints + 0.1 * rng.standard_normal(7)
        measured = mount.perturbed(
            np.deg2rad(0.1 * rng.standard_normal(3)), 0.002 * rng.standard_normal(3)
        )
        error = pose_error(hand_from_chaser(arm, read, measured) @ seen, true_hand)
        errors.append([*error.position_m, *error.euler_deg])
    prior = hand_prior(PosePrior(seen, sigma_m, sigma_deg), arm, read, measured, 0.1, 0.1, 0.002)
    stated = np.concatenate([prior.sigma_m, prior.sigma_deg])
    spread = np.sqrt(np.square(errors).mean(axis=0))
    np.testing.assert_allclose(spread, stated, rtol=5.0 / np.sqrt(2.0 * RUNS))
    last = pose_error(prior.cam_from_target, true_hand)
    assert (np.abs(last.position_m) < 5.0 * prior.sigma_m).all()
