"""Why an arm cannot come to a pose: which joint's limit forbids it, or which link."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from models.arm.arm import Arm
from models.arm.inverse_kinematics import Attempt, search, start_postures
from models.errors import ScenarioError
from models.pose import RigidTransform

TRIED = 30  # postures from which it is asked how near the arm comes
FULL_TURN_RAD = 2.0 * np.pi


def unreachable(
    arm: Arm, base_from_tool: RigidTransform, what: str, near_rad: ArrayLike | None = None
) -> ScenarioError:
    """Return the error that says what forbids a pose which no search has met.

    Parameters
    ----------
    arm : Arm
    base_from_tool : RigidTransform
    what : str
        The pose: ``set-point 3, contact``.
    near_rad : (n,) array, rad, optional
    """
    best = _nearest(arm, base_from_tool, near_rad)
    off = (
        f"the nearest it comes is {best.shift_m:.3f} m and {np.rad2deg(best.turn_rad):.2f} deg off"
    )
    without_limits = replace(
        arm,
        joints=tuple(
            replace(each, lower_rad=-FULL_TURN_RAD, upper_rad=FULL_TURN_RAD) for each in arm.joints
        ),
    )
    free = _nearest(without_limits, base_from_tool, near_rad)
    reason = _by_limit(arm, best) if free.found else _by_length(arm, base_from_tool, free)
    return ScenarioError(
        f"expected {what} within the reach of {arm.name}; {reason}; {off}; give another set-point, "
        "another place of the base, or another arm"
    )


def _nearest(arm: Arm, base_from_tool: RigidTransform, near_rad: ArrayLike | None) -> Attempt:
    attempts = [
        search(arm, base_from_tool, start) for start in start_postures(arm, near_rad, TRIED)
    ]
    return min(attempts, key=lambda each: np.hypot(each.turn_rad * arm.reach_m, each.shift_m))


def _by_limit(arm: Arm, best: Attempt) -> str:
    """Name the joints that the nearest posture has at a limit and would turn further."""
    if not best.pushes.any():
        return "no limit holds a joint there, but no posture within all of them meets it"
    order = np.argsort(-np.abs(best.pushes))
    told = []
    for k in [int(k) for k in order if best.pushes[k] != 0.0]:
        joint = arm.joints[k]
        limit = joint.upper_rad if best.pushes[k] > 0.0 else joint.lower_rad
        told.append(f"joint {joint.name} stops at {np.rad2deg(limit):g} deg")
    return f"{' and '.join(told)}, which forbids it"


def _by_length(arm: Arm, base_from_tool: RigidTransform, free: Attempt) -> str:
    """Name the longest link of an arm that is too short, or does not fold small enough."""
    first = arm.fixed[0, :3, 3]
    asked_m = float(np.linalg.norm(base_from_tool.translation - first))
    lengths = np.linalg.norm(arm.fixed[1:, :3, 3], axis=1)
    longest = int(np.argmax(lengths))
    link = (
        f"link {longest + 1}, after joint {arm.joints[longest].name}, of {lengths[longest]:.3f} m"
    )
    if asked_m > arm.reach_m:
        return (
            f"its links reach {arm.reach_m:.3f} m from joint {arm.joints[0].name} stretched, and "
            f"it is {asked_m:.3f} m away, {asked_m - arm.reach_m:.3f} m beyond; the longest is "
            f"{link}"
        )
    tool_m = float(lengths[-1])
    return (
        f"no turning of its joints, even without limits, brings its links of {arm.reach_m:.3f} m "
        f"to {asked_m:.3f} m from joint {arm.joints[0].name} with the end effector, {tool_m:.3f} m "
        f"long, turned that way; the longest is {link}"
    )
