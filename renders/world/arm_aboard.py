"""The chaser's arm in a world: how it stands at any instant, and which camera it carries."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from models.arm.hand_camera import hand_from_chaser
from models.arm.kinematics import chaser_from_links
from models.arm.set_points import ArmMotion
from models.pose import RigidTransform
from models.spacecraft.stance import Stance
from renders.world.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class ArmAboard:
    """An arm, its way, and the camera that takes the images.

    Attributes
    ----------
    motion : ArmMotion
    hand_from_tool : RigidTransform
        How its camera is mounted.
    carries_camera : bool
        Whether the images are the hand camera's, or those of the camera fixed to the chaser.
    chaser : Trajectory
        Of the camera fixed to the chaser.
    """

    motion: ArmMotion
    hand_from_tool: RigidTransform
    carries_camera: bool
    chaser: Trajectory
    _stances: dict[float, Stance] = field(default_factory=dict, init=False)

    def hand_from_chaser(self, time_s: float) -> RigidTransform:
        """Return the pose of the chaser-fixed camera's frame in the hand camera's."""
        angles_deg = self.motion.angles_at(time_s)
        return hand_from_chaser(self.motion.arm, angles_deg, self.hand_from_tool)

    def stance(self, time_s: float) -> Stance:
        """Return how the chaser stands in the axes of the camera that takes the images."""
        if time_s not in self._stances:
            angles_rad = np.deg2rad(self.motion.angles_at(time_s))
            body = RigidTransform.identity()
            if self.carries_camera:
                body = self.hand_from_chaser(time_s)
            links = chaser_from_links(self.motion.arm, angles_rad)[1:]
            self._stances[time_s] = Stance((body, *(body @ link for link in links)))
        return self._stances[time_s]


@dataclass(frozen=True, eq=False)
class CarriedCamera:
    """The motion of the camera that the arm carries.

    Attributes
    ----------
    arm : ArmAboard
    chaser : Trajectory
        Of the camera fixed to the chaser.
    """

    arm: ArmAboard
    chaser: Trajectory

    def cam_from_target(self, time_s: float) -> RigidTransform:
        """Return the true pose."""
        return self.arm.hand_from_chaser(time_s) @ self.chaser.cam_from_target(time_s)


@dataclass(frozen=True, eq=False)
class Moved:
    """A motion about a target whose frame has its origin elsewhere.

    Attributes
    ----------
    motion : Trajectory
        In axes of the same directions.
    origin_in_target : (3,) tuple, m
        Its origin in the target's frame.
    """

    motion: Trajectory
    origin_in_target: tuple[float, float, float]

    def cam_from_target(self, time_s: float) -> RigidTransform:
        """Return the true pose."""
        here = self.motion.cam_from_target(time_s)
        return here @ RigidTransform(np.eye(3), -np.array(self.origin_in_target))
