"""A chaser that turns so that its camera looks at a point of the target."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.pose import RigidTransform


def aimed_camera(
    chaser_in_orbital: Floats, aim_in_orbital: Floats, com_to_camera_m: float
) -> RigidTransform:
    """Return ``cam_from_orbital`` of a camera on a chaser that looks at an aim.

    The boresight runs from the chaser's centre of mass through the lens to the aim; the camera's x
    axis is as near the orbital target frame's x as that allows.

    Parameters
    ----------
    chaser_in_orbital : (3,) array, m
        Its centre of mass, orbital target frame.
    aim_in_orbital : (3,) array, m
    com_to_camera_m : float, m
        Along the boresight.
    """
    sight = aim_in_orbital - chaser_in_orbital
    z_axis = sight / np.linalg.norm(sight)
    x_axis = np.array([1.0, 0.0, 0.0]) - z_axis[0] * z_axis
    x_axis /= np.linalg.norm(x_axis)
    cam_from_orbital = np.stack([x_axis, np.cross(z_axis, x_axis), z_axis])
    lens = chaser_in_orbital + com_to_camera_m * z_axis
    return RigidTransform(cam_from_orbital, -cam_from_orbital @ lens)
