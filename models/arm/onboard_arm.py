"""``arm.toml`` of a dataset: the arm as known on board, and the stream of its joints as read.

Whoever reads both chains the two cameras: the hand camera's pose is that of the chaser-fixed camera
by way of the arm. Both may differ from what is true by what ``sigmas.toml`` tells.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from models.arm.arm import Arm, Joint
from models.arm.hand_camera import hand_from_chaser
from models.pose import RigidTransform
from models.reading.bounds import ANGLE_DEG, LENGTH_M
from models.reading.fields import Fields

ARM_FILE = "arm.toml"
ARM_JOINTS = "arm_joints"
MOST_JOINTS = 30


@dataclass(frozen=True, eq=False)
class OnboardArm:
    """An arm as known on board; of its links the kinematics alone.

    Attributes
    ----------
    arm : Arm
    hand_from_tool : RigidTransform
        How its camera is mounted, as measured.
    carries_camera : bool
        Whether the dataset's images are the hand camera's.
    """

    arm: Arm
    hand_from_tool: RigidTransform
    carries_camera: bool

    def hand_from_chaser(self, joints_deg: ArrayLike) -> RigidTransform:
        """Return the pose of the chaser-fixed camera's frame in the hand camera's.

        Parameters
        ----------
        joints_deg : (n,) array, deg
            As read.
        """
        return hand_from_chaser(self.arm, joints_deg, self.hand_from_tool)

    def to_table(self) -> dict[str, Any]:
        """Return what ``arm.toml`` holds."""
        return {
            "name": self.arm.name,
            "images_of": "hand" if self.carries_camera else "chaser",
            **_pose("chaser_from_base", self.arm.chaser_from_base),
            **_pose("last_from_tool", self.arm.last_from_tool),
            **_pose("hand_from_tool", self.hand_from_tool),
            "joint": [
                {
                    "name": joint.name,
                    "lower_deg": float(np.rad2deg(joint.lower_rad)),
                    "upper_deg": float(np.rad2deg(joint.upper_rad)),
                    **_pose("link_from_joint", joint.link_from_joint),
                }
                for joint in self.arm.joints
            ],
        }

    @classmethod
    def of_table(cls, table: dict[str, Any]) -> OnboardArm:
        """Read ``arm.toml`` back.

        Raises
        ------
        DatasetError
            If a key is missing or unknown, or a value cannot be.
        """
        fields = Fields(table, ARM_FILE)
        poses = ("chaser_from_base", "last_from_tool", "hand_from_tool")
        fields.only(("name", "images_of", "joint", *(k for p in poses for k in _keys(p))))
        base, tool, mount = (fields.pose(*_keys(name), *LENGTH_M) for name in poses)
        joints = tuple(_joint(row) for row in fields.tables("joint", MOST_JOINTS))
        try:
            arm = Arm(fields.text("name"), base, joints, tool, ())
        except ValueError as error:
            raise fields.refusal("joint", "as those of an arm", str(error)) from error
        return cls(arm, mount, fields.choice("images_of", ("hand", "chaser")) == "hand")


def columns_of(arm: Arm) -> tuple[str, ...]:
    """Return the names of the columns of the stream of joints."""
    return tuple(f"joint_{number}_deg" for number in range(1, len(arm.joints) + 1))


def _joint(row: Fields) -> Joint:
    row.only(("name", "lower_deg", "upper_deg", *_keys("link_from_joint")))
    limits = [np.deg2rad(row.number(key, *ANGLE_DEG)) for key in ("lower_deg", "upper_deg")]
    stands = row.pose(*_keys("link_from_joint"), *LENGTH_M)
    try:
        return Joint(row.text("name"), stands, float(limits[0]), float(limits[1]))
    except ValueError as error:
        raise row.refusal("lower_deg", "below upper_deg", str(error)) from error


def _keys(name: str) -> tuple[str, str]:
    return f"R_{name}", f"t_{name}_m"


def _pose(name: str, pose: RigidTransform) -> dict[str, Any]:
    rotation, translation = _keys(name)
    return {rotation: pose.rotation.tolist(), translation: pose.translation.tolist()}
