"""How an arm goes: inverse kinematics at three set-points, joints at even rates between them.

Opromolla et al. 2022, section 4.1: the start of its extension; 282.3 s, from where its camera looks
at the markers; contact. Before the first the arm stands still, and after the last.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from models.arm.arm import Arm
from models.arm.clearance import Nearest, Surroundings, nearest_of_itself, swept
from models.arm.inverse_kinematics import search, solutions
from models.arm.unreachable import unreachable
from models.arrays import Floats
from models.errors import ScenarioError
from models.pose import RigidTransform

CLEAR_M = 0.03  # from everything, all the way
STEP_DEG = 4.0  # of the joint that turns most, from one posture that is looked at to the next
RESOLUTION_DEG = 1e-6  # of a commanded angle: 0.1 um at the end of 3 m
TRIED = 12  # postures at the second set-point from which a clear way is looked for
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


@dataclass(frozen=True, eq=False)
class Bystanders:
    """What an arm must not touch on its way.

    Attributes
    ----------
    chaser, target : Surroundings
    chaser_from_target : callable
        The target's pose in the frame of the chaser-fixed camera, by time in s.
    """

    chaser: Surroundings
    target: Surroundings
    chaser_from_target: Callable[[float], RigidTransform]


def planned(
    arm: Arm,
    points: Sequence[SetPoint],
    bystanders: Bystanders | None = None,
    near_deg: ArrayLike | None = None,
) -> ArmMotion:
    """Return how an arm goes by its three set-points, clear of everything if it is told of any.

    Parameters
    ----------
    arm : Arm
    points : sequence of three SetPoint
    bystanders : Bystanders, optional
    near_deg : (n,) array, deg, optional
        A posture near which the second set-point is met, where that is clear.

    Raises
    ------
    ScenarioError
        If a set-point cannot be met, or no way is clear; the message names the joint or link.
    """
    near_rad = None if near_deg is None else np.deg2rad(np.asarray(near_deg, dtype=np.float64))
    aims = [arm.chaser_from_base.inverse() @ point.chaser_from_tool for point in points]
    times_s = np.array([point.time_s for point in points])
    met, blocked = [False] * len(points), None
    for middle in _postures(arm, aims[1], near_rad):
        met[1] = True
        found = [search(arm, aims[0], middle), search(arm, aims[2], middle)]
        met[0], met[2] = met[0] or found[0].found, met[2] or found[1].found
        if not (found[0].found and found[1].found):
            continue
        postures = np.rad2deg([found[0].angles_rad, middle, found[1].angles_rad])
        motion = ArmMotion(arm, times_s, np.round(postures / RESOLUTION_DEG) * RESOLUTION_DEG)
        least = None if bystanders is None else least_clearance(motion, bystanders)
        if least is None or least[1].distance_m >= CLEAR_M:
            return motion
        if blocked is None or least[1].distance_m > blocked[1].distance_m:
            blocked = least
    raise _refusal(arm, aims, met, blocked, near_rad)


def least_clearance(motion: ArmMotion, bystanders: Bystanders) -> tuple[float, Nearest]:
    """Return when on its way an arm comes nearest to anything, and to what.

    The base and its joint stand on the chaser; the last link is to touch the target.

    Returns
    -------
    time_s : float, s
    nearest : Nearest
    """
    arm, last = motion.arm, len(motion.arm.joints)
    times_s = _looked_at(motion)
    angles = np.deg2rad([motion.angles_at(t) for t in times_s])
    found = [(t, nearest_of_itself(arm, each)) for t, each in zip(times_s, angles, strict=True)]
    poses = [bystanders.chaser_from_target(t).inverse() @ arm.chaser_from_base for t in times_s]
    stands = [arm.chaser_from_base] * len(times_s)
    for craft, placed, links in (
        (bystanders.chaser, stands, range(2, last + 1)),
        (bystanders.target, poses, range(last)),
    ):
        passed = swept(arm, angles, placed, links)
        if not len(passed.points):
            continue
        gaps = craft.gaps(passed)
        least = int(np.argmin(gaps))
        name = arm.capsules[passed.capsules[least]].name
        nearest = Nearest(float(gaps[least]), name, craft.name)
        found.append((times_s[int(passed.instants[least])], nearest))
    return min(found, key=lambda each: each[1].distance_m)


def _looked_at(motion: ArmMotion) -> list[float]:
    """Return instants between which no joint turns by more than ``STEP_DEG``, s."""
    times_s: list[float] = []
    for k in range(len(motion.times_s) - 1):
        turn = float(np.abs(np.diff(motion.angles_deg[k : k + 2], axis=0)).max())
        steps = 2 + int(turn / STEP_DEG)
        times_s += np.linspace(motion.times_s[k], motion.times_s[k + 1], steps).tolist()
    return times_s


def _postures(arm: Arm, aim: RigidTransform, near_rad: Floats | None) -> Iterator[Floats]:
    """Yield different postures that meet a pose, (n,), rad."""
    seen: list[Floats] = []
    for angles in solutions(arm, aim, near_rad):
        if any(np.abs(angles - other).max() < SAME_RAD for other in seen):
            continue
        seen.append(angles)
        yield angles
        if len(seen) == TRIED:
            return


def _refusal(
    arm: Arm,
    aims: Sequence[RigidTransform],
    met: Sequence[bool],
    blocked: tuple[float, Nearest] | None,
    near_rad: Floats | None,
) -> ScenarioError:
    """Return why no way was found: a set-point out of reach first, then what is in the way."""
    for number, (aim, is_met, name) in enumerate(zip(aims, met, NAMES, strict=True), start=1):
        alone = is_met or next(solutions(arm, aim, near_rad), None) is not None
        if not alone:
            return unreachable(arm, aim, f"set-point {number}, {name},", near_rad)
    if blocked is None:
        return ScenarioError(
            f"expected {arm.name} to go by its three set-points within its joints' limits, got "
            "postures at each from which no joint can turn to the next; move a set-point or the "
            "arm's base"
        )
    time_s, nearest = blocked
    return ScenarioError(
        f"expected {arm.name} to stay {CLEAR_M} m clear of itself, the chaser and the target; on "
        f"the best way that was found, at {time_s:.1f} s, {nearest}; move a set-point or the arm's "
        "base, or give arm.near_deg another posture"
    )
