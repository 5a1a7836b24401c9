"""The house's arm: seven joints, shoulder, elbow and wrist, as long as servicing missions plan.

Roll, pitch and roll in the shoulder, one elbow, roll, pitch and roll in the wrist, like the arms of
DEOS (3.2 m; Rank et al. 2011) and e.Deorbit (4.2 m; Jaekel et al. 2018), to which Opromolla et al.
2022 refer without giving dimensions. Lengths are ours, so that the three set-points are reached
with joints far from their limits. It stands on the front of the chaser beside the camera, above its
field of view, and grasps with a slender gripper: the hand camera looks past it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from models.arm.arm import Arm, Capsule
from models.arm.denavit_hartenberg import Row, joints_of
from models.pose import RigidTransform

BASE_IN_CHASER = (0.32, -0.46, -0.03)  # on the front, m, axes of the chaser-fixed camera
SHOULDER_M, UPPER_M, FORE_M, HAND_M = 0.30, 1.05, 1.00, 0.60
TUBE_M, JOINT_M = 0.055, 0.085  # radii of the links' tubes and of the joints' housings
PALM_M, GRIPPER_M = 0.07, 0.024
PALM_END_M = 0.19  # along the hand

ROWS = (
    Row("shoulder_roll", 0.0, -90.0, SHOULDER_M, 0.0, -170.0, 170.0),
    Row("shoulder_pitch", 0.0, 90.0, 0.0, 0.0, -120.0, 120.0),
    Row("shoulder_yaw", 0.0, -90.0, UPPER_M, 0.0, -170.0, 170.0),
    Row("elbow", 0.0, 90.0, 0.0, 0.0, -150.0, 150.0),
    Row("wrist_roll", 0.0, -90.0, FORE_M, 0.0, -170.0, 170.0),
    Row("wrist_pitch", 0.0, 90.0, 0.0, 0.0, -120.0, 120.0),
    Row("hand_roll", 0.0, 0.0, HAND_M, 0.0, -175.0, 175.0),
)


NEAR_DEG = (143.0, -36.0, -81.0, -101.0, 36.0, 103.0, -53.0)
"""A posture at the second set-point with the elbow beside the chaser's view."""


@lru_cache(maxsize=1)
def house_arm() -> Arm:
    """Build the arm."""
    joints, flange = joints_of(ROWS)
    return Arm(
        name="the house's arm",
        chaser_from_base=RigidTransform(np.eye(3), np.array(BASE_IN_CHASER)),
        joints=joints,
        last_from_tool=flange,
        capsules=(
            _capsule(0, "base", (0.0, 0.0, 0.0), (0.0, 0.0, SHOULDER_M - 2.2 * JOINT_M), JOINT_M),
            _capsule(1, "shoulder", (0.0, 0.0, SHOULDER_M), (0.0, 0.0, SHOULDER_M), JOINT_M),
            _capsule(3, "upper_arm", (0.0, 0.0, 0.0), (0.0, 0.0, UPPER_M), TUBE_M),
            _capsule(4, "elbow", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), JOINT_M),
            _capsule(5, "forearm", (0.0, 0.0, 0.0), (0.0, 0.0, FORE_M), TUBE_M),
            _capsule(6, "wrist", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), JOINT_M),
            _capsule(7, "palm", (0.0, 0.0, 0.0), (0.0, 0.0, PALM_END_M), PALM_M),
            _capsule(7, "gripper", (0.0, 0.0, PALM_END_M), (0.0, 0.0, HAND_M), GRIPPER_M),
        ),
    )


def _capsule(
    link: int,
    name: str,
    start: tuple[float, float, float],
    end: tuple[float, float, float],
    radius_m: float,
) -> Capsule:
    return Capsule(link, name, np.array(start), np.array(end), radius_m)
