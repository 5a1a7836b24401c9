"""Whether an arm is clear of everything all the way, and when it comes nearest to what."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from models.arm.clearance import Nearest, Surroundings, nearest_of_itself, swept
from models.arm.set_points import ArmMotion
from models.pose import RigidTransform

CLEAR_M = 0.03  # from everything
STEP_DEG = 4.0  # of the joint that turns most, from one posture that is looked at to the next


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


def least_clearance(motion: ArmMotion, bystanders: Bystanders) -> tuple[float, Nearest]:
    """Return when on its way an arm comes nearest to anything, and to what.

    The base and its joint stand on the chaser; the last link is to touch the target.

    Parameters
    ----------
    motion : ArmMotion
    bystanders : Bystanders

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
