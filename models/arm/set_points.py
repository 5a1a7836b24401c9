"""How an arm goes: inverse kinematics at three set-points, joints at even rates between them.

Opromolla et al. 2022, section 4.1: the start of its extension; 282.3 s, from where its camera looks
at the markers; contact. Before the first the arm stands still, and after the last.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from models.arm.arm import Arm
from models.arm.inverse_kinematics import search, solutions
from models.arm.unreachable import unreachable
from models.arrays import Floats
from models.errors import ScenarioError
from models.pose import RigidTransform

RESOLUTION_DEG = 1e-6  # of a commanded angle: 0.1 um at the end of 3 m
TRIED = 12  # postures at the second set-point
SAME_RAD = 0.05  # postures that differ by less are one
NAMES = ("start of extension", "camera on the markers", "contact")


@dataclass(frozen=True, eq=False)
class SetPoint:
    """Where the end effector is to be.

    Attributes
    ----------
    time_s : float, s
    chaser_from_tool : RigidTransform
        In the frame of the chaser-fixed camera.
    """

    time_s: float
    chaser_from_tool: RigidTransform


@dataclass(frozen=True, eq=False)
class ArmMotion:
    """Joints in time.

    Attributes
    ----------
    arm : Arm
    times_s : (m,) array, s
        Rising.
    angles_deg : (m, n) array, deg
        The joints at those times.
    """

    arm: Arm
    times_s: Floats
    angles_deg: Floats

    def angles_at(self, time_s: float) -> Floats:
        """Return the commanded joints, (n,), deg."""
        return np.array([np.interp(time_s, self.times_s, each) for each in self.angles_deg.T])


def planned(arm: Arm, points: Sequence[SetPoint], near_deg: ArrayLike | None = None) -> ArmMotion:
    """Return how an arm goes by its three set-points; nothing is asked of what is in its way.

    Parameters
    ----------
    arm : Arm
    points : sequence of three SetPoint
    near_deg : (n,) array, deg, optional
        A posture near which the second set-point is met.

    Raises
    ------
    ScenarioError
        If a set-point cannot be met; the message names the joint or link that forbids it.
    """
    motion = next(ways(arm, points, near_deg), None)
    if motion is not None:
        return motion
    near_rad = _radians(near_deg)
    for number, (point, name) in enumerate(zip(points, NAMES, strict=True), start=1):
        base_from_tool = arm.chaser_from_base.inverse() @ point.chaser_from_tool
        if next(solutions(arm, base_from_tool, near_rad), None) is None:
            raise unreachable(arm, base_from_tool, f"set-point {number}, {name},", near_rad)
    raise ScenarioError(
        f"expected {arm.name} to go by its three set-points within its joints' limits, got "
        "postures at each from which its joints cannot turn to the next; move a set-point or the "
        "base"
    )


def ways(
    arm: Arm, points: Sequence[SetPoint], near_deg: ArrayLike | None = None
) -> Iterator[ArmMotion]:
    """Yield ways by three set-points, of different postures at the second.

    Parameters
    ----------
    arm : Arm
    points : sequence of three SetPoint
    near_deg : (n,) array, deg, optional
        A posture from which the first is looked for.
    """
    first, second, third = (arm.chaser_from_base.inverse() @ p.chaser_from_tool for p in points)
    times_s = np.array([point.time_s for point in points])
    for middle in _postures(arm, second, _radians(near_deg)):
        before, after = search(arm, first, middle), search(arm, third, middle)
        if before.found and after.found:
            postures = np.rad2deg([before.angles_rad, middle, after.angles_rad])
            exact = np.round(postures / RESOLUTION_DEG) * RESOLUTION_DEG
            yield ArmMotion(arm, times_s, exact)


def _radians(angles_deg: ArrayLike | None) -> Floats | None:
    return None if angles_deg is None else np.deg2rad(np.asarray(angles_deg, dtype=np.float64))


def _postures(
    arm: Arm, base_from_tool: RigidTransform, near_rad: Floats | None
) -> Iterator[Floats]:
    """Yield different postures that meet a pose, (n,), rad."""
    seen: list[Floats] = []
    for angles in solutions(arm, base_from_tool, near_rad):
        if any(np.abs(angles - other).max() < SAME_RAD for other in seen):
            continue
        seen.append(angles)
        yield angles
        if len(seen) == TRIED:
            return
