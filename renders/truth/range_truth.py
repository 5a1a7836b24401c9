"""What a range finder's beam meets in the scene: the surface, never the centre of mass.

Truth keeps both: the distance to what is met, which the sensor gives with its noise, and that to
the centre of mass, which nobody on board can measure.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mitsuba as mi
import numpy as np

from models.arrays import Floats
from models.pose import RigidTransform

FOOTPRINT_RAYS = 61  # spread evenly over a beam that has a width
LEAST_SHARE = 0.5  # of them that must meet the target: else the echo is too weak


@dataclass(frozen=True)
class RangeTruth:
    """One reading without noise.

    Attributes
    ----------
    surface_m : float, m
        Along the boresight to what the beam meets; infinite where it meets nothing.
    centre_m : float, m
        From the camera to the target's centre of mass.
    met_share : float
        Of the beam that meets anything.
    """

    surface_m: float
    centre_m: float
    met_share: float


def range_truth(
    scene: Any, cam_from_target: RigidTransform, centre_of_mass: Floats, footprint_rad: float = 0.0
) -> RangeTruth:
    """Follow the beam along the boresight.

    Parameters
    ----------
    scene : mitsuba.Scene
        In the target's frame.
    cam_from_target : RigidTransform
    centre_of_mass : (3,) array, m
        Target frame.
    footprint_rad : float, rad
        Half the beam's full angle; with none it is a single ray. Of a beam with a width the median
        of what its rays meet is read: most of the light comes from there.
    """
    directions = _beam(footprint_rad) @ cam_from_target.rotation
    eye = -cam_from_target.rotation.T @ cam_from_target.translation
    origin = mi.Point3f(*(float(value) for value in eye))
    far = np.empty(len(directions))
    for place, towards in enumerate(directions):
        ray = mi.Ray3f(origin, mi.Vector3f(*(float(each) for each in towards)))
        far[place] = np.array(scene.ray_intersect_preliminary(ray).t, dtype=np.float64).item()
    met = np.isfinite(far)
    share = float(met.mean())
    read = float(np.median(far[met])) if share >= LEAST_SHARE else float(np.inf)
    centre = float(np.linalg.norm(cam_from_target @ centre_of_mass))
    return RangeTruth(read, centre, share)


def _beam(footprint_rad: float) -> Floats:
    """Return unit directions in camera axes, (n, 3): the boresight, or a cone about it."""
    if footprint_rad == 0.0:
        return np.array([[0.0, 0.0, 1.0]])
    number = np.arange(FOOTPRINT_RAYS)
    off = footprint_rad * np.sqrt((number + 0.5) / FOOTPRINT_RAYS)
    angle = number * np.pi * (3.0 - np.sqrt(5.0))
    return np.column_stack([np.sin(off) * np.cos(angle), np.sin(off) * np.sin(angle), np.cos(off)])
