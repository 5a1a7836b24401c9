"""Cameras all around a target, looking at its origin."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.pose import RigidTransform


def look_along(forward: Floats, range_m: float, down: Floats | None = None) -> RigidTransform:
    """Return ``cam_from_target`` of a camera that looks at the target's origin.

    Parameters
    ----------
    forward : (3,) array
        Unit: where the camera looks, target axes.
    range_m : float, m
    down : (3,) array, optional
        What is down in the image, as far as it can be; target axes.
    """
    helper = np.eye(3)[int(np.argmin(np.abs(forward)))] if down is None else down
    right = np.cross(helper, forward)
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(forward, right), forward])
    return RigidTransform(rotation, np.array([0.0, 0.0, range_m]))


def poses_all_around(count: int, range_m: float) -> list[RigidTransform]:
    """Return cameras evenly all around, by Fibonacci's spiral.

    Parameters
    ----------
    count : int
    range_m : float, m
        From the target's origin.
    """
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    angle = np.pi * (1.0 + np.sqrt(5.0)) * k
    radius = np.sqrt(1.0 - z**2)
    directions = np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)
    return [look_along(-direction, range_m) for direction in directions]
