"""A pose as the two filters measure it: what is drawn anew in it, and what lasts."""

from __future__ import annotations

from dataclasses import dataclass

from models.arrays import Floats
from models.estimate import Estimate
from pipelines.filters.camera_mount import CameraMount
from pipelines.filters.lasting_errors import LastingErrors


@dataclass(frozen=True, eq=False)
class PoseMeasurement:
    """Position and attitude of one image, and their errors.

    Attributes
    ----------
    position : (3,) array, m
        Local frame.
    position_noise : (3, 3) array, m2
        Of it, all of it: what lasts as well.
    position_effect : (3, n) array, m
        Of the n lasting errors.
    R_lvlh_from_target : (3, 3) array
    turn_noise : (3, 3) array, rad2
        Target axes, all of it.
    turn_effect : (3, n) array, rad
        Of the n lasting errors, which are in the local frame's axes.
    """

    position: Floats
    position_noise: Floats
    position_effect: Floats
    R_lvlh_from_target: Floats
    turn_noise: Floats
    turn_effect: Floats

    @property
    def white_position(self) -> Floats:
        """(3, 3) What of the position's noise is drawn anew for each image, m2."""
        return self.position_noise - self.position_effect @ self.position_effect.T

    @property
    def white_turn(self) -> Floats:
        """(3, 3) What of the turn's noise is drawn anew for each image, rad2."""
        return self.turn_noise - self.turn_effect @ self.turn_effect.T


def measured(found: Estimate, mount: CameraMount, errors: LastingErrors) -> PoseMeasurement:
    """Return what a pose tells the filters.

    Parameters
    ----------
    found : Estimate
    mount : CameraMount
        What is not known of the camera's attitude is drawn anew for each image.
    errors : LastingErrors

    Raises
    ------
    ValueError
        If there is no pose.
    """
    pose = found.pose
    if pose is None:
        raise ValueError(f"expected a pose to measure with, got none: {found.reason}")
    covariance = pose.stated_covariance
    place, place_noise, attitude, turn_noise = mount.measured(pose.cam_from_target, covariance)
    R_lvlh_from_cam = mount.cam_from_lvlh.rotation.T
    turned = R_lvlh_from_cam @ covariance[:3, :3] @ R_lvlh_from_cam.T
    moved = R_lvlh_from_cam @ covariance[3:, 3:] @ R_lvlh_from_cam.T
    return PoseMeasurement(
        position=place,
        position_noise=place_noise,
        position_effect=errors.effect(moved),
        R_lvlh_from_target=attitude,
        turn_noise=turn_noise,
        turn_effect=attitude.T @ errors.effect(turned),
    )
