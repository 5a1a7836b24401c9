"""The camera that the arm carries: 0.4 m behind the end effector and 0.2 m beside it.

So it still sees the markers from 0.4 m when the gripper touches (Opromolla et al. 2022, section
3.2.1; the words there read the other way round). Its axes are those of the end effector.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from models.arm.arm import Arm, Capsule
from models.arm.kinematics import chaser_from_tool
from models.arrays import Floats
from models.onboard import PosePrior
from models.pose import (
    RigidTransform,
    euler_321_from_rotation,
    pose_error,
    rotation_from_euler_321,
)

END_EFFECTOR_IN_CAMERA_M = (0.0, 0.20, 0.40)
HAND_FROM_TOOL = RigidTransform(np.eye(3), np.array(END_EFFECTOR_IN_CAMERA_M))
HAND_CAMERA = "hand_camera"
BEHIND_LENS_M = (0.045, 0.075)  # from where to where its capsule's axis lies
AROUND_M = 0.055


def with_hand_camera(arm: Arm, hand_from_tool: RigidTransform = HAND_FROM_TOOL) -> Arm:
    """Return an arm with its camera among what must stay clear.

    Parameters
    ----------
    arm : Arm
    hand_from_tool : RigidTransform
        The mount: the end effector in the camera's axes.
    """
    last_from_hand = arm.last_from_tool @ hand_from_tool.inverse()
    back, front = (last_from_hand @ np.array([0.0, 0.0, -z]) for z in reversed(BEHIND_LENS_M))
    camera = Capsule(len(arm.joints), HAND_CAMERA, back, front, AROUND_M)
    return replace(arm, capsules=(*arm.capsules, camera))


def hand_from_chaser(
    arm: Arm, angles_deg: ArrayLike, hand_from_tool: RigidTransform = HAND_FROM_TOOL
) -> RigidTransform:
    """Return the pose of the chaser-fixed camera's frame in the hand camera's.

    Parameters
    ----------
    arm : Arm
    angles_deg : (n,) array, deg
    hand_from_tool : RigidTransform
        The mount: the end effector in the camera's axes.
    """
    return hand_from_tool @ chaser_from_tool(arm, np.deg2rad(angles_deg)).inverse()


def hand_prior(
    chaser: PosePrior,
    arm: Arm,
    angles_deg: ArrayLike,
    hand_from_tool: RigidTransform,
    sigma_joint_deg: float,
    sigma_turn_deg: float,
    sigma_place_m: float,
) -> PosePrior:
    """Return the hand camera's first pose: that of the chaser-fixed camera, by way of the arm.

    Errors are independent and small; each is carried through by a difference.

    Parameters
    ----------
    chaser : PosePrior
        Of the chaser-fixed camera.
    arm : Arm
    angles_deg : (n,) array, deg
        The joints as read.
    hand_from_tool : RigidTransform
        The mount as measured.
    sigma_joint_deg : float, deg
        1-sigma of each joint.
    sigma_turn_deg, sigma_place_m : float, deg and m
        1-sigma of the mount, an axis.
    """
    angles = np.asarray(angles_deg, dtype=np.float64)
    count = len(angles)
    sigmas = np.concatenate(
        [
            chaser.sigma_m,
            chaser.sigma_deg,
            np.full(count, sigma_joint_deg),
            np.full(3, sigma_turn_deg),
            np.full(3, sigma_place_m),
        ]
    )

    def posed(errors: Floats) -> RigidTransform:
        at = chaser.cam_from_target
        euler = euler_321_from_rotation(at.rotation) + errors[3:6]
        chaser_from_target = RigidTransform(
            rotation_from_euler_321(euler), at.translation + errors[:3]
        )
        turn, place = errors[6 + count : 9 + count], errors[9 + count :]
        mount = hand_from_tool.perturbed(np.deg2rad(turn), place)
        return hand_from_chaser(arm, angles + errors[6 : 6 + count], mount) @ chaser_from_target

    middle = posed(np.zeros(len(sigmas)))
    shares = []
    for number, sigma in enumerate(sigmas):
        step = np.zeros(len(sigmas))
        step[number] = sigma
        ahead, behind = pose_error(posed(step), middle), pose_error(posed(-step), middle)
        shares.append(
            0.5
            * np.concatenate(
                [ahead.position_m - behind.position_m, ahead.euler_deg - behind.euler_deg]
            )
        )
    spread = np.sqrt(np.square(shares).sum(axis=0))
    return PosePrior(middle, spread[:3], spread[3:])
