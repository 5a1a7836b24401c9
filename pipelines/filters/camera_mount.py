"""How the camera stands in the chaser's local frame, as it is known at one instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.pose import RigidTransform


@dataclass(frozen=True, eq=False)
class CameraMount:
    """The camera's place and attitude, and how well the attitude is known.

    Attributes
    ----------
    cam_from_lvlh : RigidTransform
    turn_covariance : (3, 3) array or None, rad2
        Of a small turn in the camera's axes; None where the attitude is taken as exact.
    """

    cam_from_lvlh: RigidTransform
    turn_covariance: Floats | None = None

    def measured(
        self, cam_from_target: RigidTransform, covariance: Floats
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Return a pose as the filters of the relative motion measure it.

        Parameters
        ----------
        cam_from_target : RigidTransform
        covariance : (6, 6) array, rad and m
            Rotation first, camera axes.

        Returns
        -------
        position : (3,) array, m
            Local frame.
        position_noise : (3, 3) array, m2
            The camera's own attitude among it, by the distance: ``[t]x P [t]x^T``.
        R_lvlh_from_target : (3, 3) array
        turn_noise : (3, 3) array, rad2
            Target axes.
        """
        turned, moved = covariance[:3, :3], covariance[3:, 3:]
        if self.turn_covariance is not None:
            arm = np.cross(cam_from_target.translation, np.eye(3), axisb=0).T
            turned = turned + self.turn_covariance
            moved = moved + arm @ self.turn_covariance @ arm.T
        lvlh_from_cam = self.cam_from_lvlh.inverse()
        lvlh_from_target = lvlh_from_cam @ cam_from_target
        mount, target_from_cam = lvlh_from_cam.rotation, cam_from_target.rotation.T
        return (
            lvlh_from_target.translation,
            mount @ moved @ mount.T,
            lvlh_from_target.rotation,
            target_from_cam @ turned @ target_from_cam.T,
        )
