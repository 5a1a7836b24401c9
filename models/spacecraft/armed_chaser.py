"""The chaser with an arm that moves: its stowed one makes room for it."""

from __future__ import annotations

from dataclasses import replace

from models.arm.arm import Arm
from models.arm.shape import arm_parts
from models.pose import RigidTransform
from models.spacecraft.chaser import STOWED_ARM, chaser
from models.spacecraft.part import Spacecraft


def chaser_without_arm() -> Spacecraft:
    """Return the chaser without the arm that is folded to its side."""
    whole = chaser()
    return replace(whole, parts=tuple(p for p in whole.parts if p.name != STOWED_ARM))


def armed_chaser(arm: Arm, hand_from_tool: RigidTransform) -> Spacecraft:
    """Return the chaser with an arm; the arm's parts stand in the frames of its links.

    Parameters
    ----------
    arm : Arm
    hand_from_tool : RigidTransform
        How the arm's camera is mounted.
    """
    bare = chaser_without_arm()
    return replace(bare, parts=(*bare.parts, *arm_parts(arm, hand_from_tool)))
