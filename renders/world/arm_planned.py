"""The arm of a scenario with its three set-points, met where the chaser truly is at their times."""

from __future__ import annotations

import numpy as np

from models.arm.set_points import ArmMotion, SetPoint, planned, ways
from models.errors import ScenarioError
from models.pose import RigidTransform
from renders.scenario.arm_tables import ArmTable, arm_of
from renders.scenario.scenario import Scenario
from renders.world.arm_aboard import ArmAboard
from renders.world.trajectory import Trajectory


def set_points(table: ArmTable, chaser: Trajectory) -> tuple[SetPoint, ...]:
    """Return the three set-points, in the frame of the chaser-fixed camera.

    Parameters
    ----------
    table : ArmTable
    chaser : Trajectory
        Of that camera.
    """
    stand_off = RigidTransform(np.eye(3), np.array([0.0, 0.0, -table.stand_off_m]))
    looks, touches = (chaser.cam_from_target(t) for t in (table.looks_s, table.touches_s))
    return (
        SetPoint(table.extends_s, table.chaser_from_ready),
        SetPoint(table.looks_s, looks @ table.target_from_grasp @ stand_off),
        SetPoint(table.touches_s, touches @ table.target_from_grasp),
    )


def arm_aboard(scenario: Scenario, table: ArmTable, chaser: Trajectory) -> ArmAboard:
    """Return the arm with its way.

    Parameters
    ----------
    scenario : Scenario
    table : ArmTable
        Its ``[arm]``.
    chaser : Trajectory
        Of the camera that is fixed to the chaser.

    Raises
    ------
    ScenarioError
        If a set-point cannot be met; the message names the joint or link that forbids it.
    """
    arm, near_deg = arm_of(table, scenario.name)
    try:
        motion = planned(arm, set_points(table, chaser), near_deg)
    except ScenarioError as error:
        raise ScenarioError(f"{scenario.name}: [arm]: {error}") from error
    return ArmAboard(motion, table.hand_from_tool, table.camera == "hand", chaser)


def other_ways(scenario: Scenario, table: ArmTable, chaser: Trajectory) -> list[ArmMotion]:
    """Return every way that is found, of different postures at the second set-point.

    Parameters
    ----------
    scenario : Scenario
    table : ArmTable
        Its ``[arm]``.
    chaser : Trajectory
        Of the camera that is fixed to the chaser.
    """
    arm, near_deg = arm_of(table, scenario.name)
    return list(ways(arm, set_points(table, chaser), near_deg))
