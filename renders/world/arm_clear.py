"""Refuses an arm that touches itself, the chaser or the target on its way."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.arm.clearance import Surroundings
from models.arm.way import CLEAR_M, Bystanders, least_clearance
from models.errors import ScenarioError
from models.spacecraft.armed_chaser import chaser_without_arm
from renders.world.arm_planned import other_ways

if TYPE_CHECKING:
    from renders.world.world import World


def clear_of_everything(world: World) -> None:
    """Refuse it, and name a posture from which the way is clear, if one is found.

    Raises
    ------
    ScenarioError
        The message names what touches what, and when.
    """
    arm, table = world.arm, world.scenario.arm
    if arm is None or table is None:
        return

    here, there = Surroundings.of(chaser_without_arm()), Surroundings.of(world.target)
    bystanders = Bystanders(here, there, arm.chaser.cam_from_target)
    time_s, nearest = least_clearance(arm.motion, bystanders)
    if nearest.distance_m >= CLEAR_M:
        return
    advice = "move a set-point or the base (arm.*)"
    for other in other_ways(world.scenario, table, arm.chaser):
        if least_clearance(other, bystanders)[1].distance_m >= CLEAR_M:
            posture = ", ".join(f"{angle:.0f}" for angle in other.angles_deg[1])
            advice = f"clear is the way by arm.near_deg = [{posture}]"
            break
    raise ScenarioError(
        f"{world.scenario.name}: expected the arm {CLEAR_M} m clear of itself, the chaser and the "
        f"target all the way; at {time_s:.1f} s {nearest}; {advice}"
    )
