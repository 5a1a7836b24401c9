"""The arm from one camera to the other, as told but for errors that are tried.

Poses move as ``RigidTransform.perturbed`` has it, rotation first, and what the arm is told wrong by
is a vector: joints, deg; the camera's mount in the hand, its turn in rad and its place in m.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from models.arm.onboard_arm import OnboardArm
from models.arrays import Floats
from models.pose import RigidTransform

JOINTS, MOUNT_TURN, MOUNT_PLACE = "arm.joints_deg", "arm.mount_turn_deg", "arm.mount_place_m"
STEP = 1e-6  # rad, m and deg: of differences
POSE = 6


def difference(pose: RigidTransform, other: RigidTransform) -> Floats:
    """Return how far a pose lies from another, (6,), rad and m, as ``perturbed`` takes it.

    Parameters
    ----------
    pose, other : RigidTransform
    """
    turn = Rotation.from_matrix(pose.rotation @ other.rotation.T).as_rotvec()
    return np.concatenate([turn, pose.translation - other.translation])


@dataclass(frozen=True, eq=False)
class ArmChain:
    """The arm at one instant.

    Attributes
    ----------
    arm : OnboardArm
    joints_deg : (n,) array, deg
        As read.
    chaser_target_from_hand_target : RigidTransform
        Between the frames of the target in which the cameras' poses are told.
    """

    arm: OnboardArm
    joints_deg: Floats
    chaser_target_from_hand_target: RigidTransform

    def spread(self, sigmas: Mapping[str, float]) -> Floats:
        """Return the 1-sigma of each error, (n + 6,).

        Parameters
        ----------
        sigmas : mapping of str to float
            Of what the arm is told wrong by: ``arm.joints_deg`` and so on.
        """
        turn_rad = np.deg2rad(sigmas.get(MOUNT_TURN, 0.0))
        return np.concatenate(
            [
                np.full(len(self.joints_deg), sigmas.get(JOINTS, 0.0)),
                np.full(3, turn_rad),
                np.full(3, sigmas.get(MOUNT_PLACE, 0.0)),
            ]
        )

    def chaser(self, hand_from_target: RigidTransform, errors: Floats) -> RigidTransform:
        """Return the chaser-fixed camera's pose, in its own target frame.

        Parameters
        ----------
        hand_from_target : RigidTransform
        errors : (n + 6,) array
        """
        hand_from_other = hand_from_target @ self.chaser_target_from_hand_target.inverse()
        return self._hand_from_chaser(errors).inverse() @ hand_from_other

    def hand(self, chaser_from_target: RigidTransform, errors: Floats) -> RigidTransform:
        """Return the hand camera's pose, in its own target frame.

        Parameters
        ----------
        chaser_from_target : RigidTransform
        errors : (n + 6,) array
        """
        return (
            self._hand_from_chaser(errors)
            @ chaser_from_target
            @ self.chaser_target_from_hand_target
        )

    def _hand_from_chaser(self, errors: Floats) -> RigidTransform:
        count = len(self.joints_deg)
        turn, place = errors[count : count + 3], errors[count + 3 :]
        mount = self.arm.hand_from_tool.perturbed(-turn, -place)
        return replace(self.arm, hand_from_tool=mount).hand_from_chaser(
            self.joints_deg - errors[:count]
        )


def chained_jacobian(
    chained: Callable[[RigidTransform, Floats], RigidTransform],
    pose: RigidTransform,
    errors: Floats,
) -> Floats:
    """Return how the other camera's pose follows one's and the arm's errors, (6, 6 + n + 6).

    Parameters
    ----------
    chained : callable
        ``ArmChain.hand`` or ``ArmChain.chaser``, of a pose and of (n + 6,) errors.
    pose : RigidTransform
    errors : (n + 6,) array
    """
    columns = []
    for number in range(POSE + len(errors)):
        away = np.zeros(POSE + len(errors))
        away[number] = STEP
        ahead, behind = (
            chained(
                pose.perturbed(sign * away[:3], sign * away[3:POSE]), errors + sign * away[POSE:]
            )
            for sign in (1.0, -1.0)
        )
        columns.append(difference(ahead, behind) / (2.0 * STEP))
    return np.stack(columns, axis=1)
