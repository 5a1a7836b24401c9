"""From the house's camera to Mitsuba's: the one place where axes flip and half pixels move.

The house: x right, y down, z forward; pixel centres are integers. Mitsuba: the camera looks along
+z with +x to the image left and +y up; film coordinates count from the film's corner. Distortion
enters here too, by bending the rays, never by warping images.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from models.camera import UNDISTORT_ITERATIONS, Camera
from models.pose import RigidTransform

MITSUBA_FROM_CAM = np.diag([-1.0, -1.0, 1.0])
UNDISTORT_STEPS = (8, 16, 32)  # Newton doubles the digits at each; four suffice for most lenses
UNDISTORT_PX = 1e-3  # a kernel in single precision keeps no more over 2048 pixels


@cache
def undistort_steps(camera: Camera) -> int:
    """Return how many of Newton's steps a lens needs over its image: more where it nearly folds."""
    distorted = (camera.spread_px() - [camera.cx, camera.cy]) / [camera.fx, camera.fy]
    expected = camera.undistort(distorted)
    for steps in UNDISTORT_STEPS:
        x, y = undistorted(camera, distorted[:, 0], distorted[:, 1], steps)
        found = np.stack([x, y], axis=-1)
        if np.abs(found - expected).max() * max(camera.fx, camera.fy) < UNDISTORT_PX:
            return steps
    return UNDISTORT_ITERATIONS  # which a camera's own check has found to be enough


def undistorted(camera: Camera, x: Any, y: Any, steps: int) -> tuple[Any, Any]:
    """Undo Brown-Conrady distortion on Dr.Jit or plain floats, by Newton's method.

    The same equations as ``Camera.undistort``, which works on arrays; a test holds them together.

    Parameters
    ----------
    camera : Camera
    x, y : Float or float
        Distorted normalised image coordinates.
    steps : int
        Of Newton's method; see ``undistort_steps``.
    """
    if not camera.distorted:
        return x, y
    k1, k2, p1, p2, k3 = (float(value) for value in camera.distortion)
    a, b = x, y
    for _ in range(steps):
        r2 = a * a + b * b
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3))
        error_x = x - (a * radial + 2.0 * p1 * a * b + p2 * (r2 + 2.0 * a * a))
        error_y = y - (b * radial + p1 * (r2 + 2.0 * b * b) + 2.0 * p2 * a * b)
        xx = radial + a * a * slope + 2.0 * p1 * b + 6.0 * p2 * a
        xy = a * b * slope + 2.0 * p1 * a + 2.0 * p2 * b
        yy = radial + b * b * slope + 6.0 * p1 * b + 2.0 * p2 * a
        determinant = xx * yy - xy * xy
        a = a + (yy * error_x - xy * error_y) / determinant
        b = b + (xx * error_y - xy * error_x) / determinant
    return a, b


def ray_direction_in_cam(camera: Camera, u: Any, v: Any) -> Any:
    """Return the unit direction, camera axes, through pixel (u, v); pixel centres are integers.

    Parameters
    ----------
    camera : Camera
    u, v : Float or float, px
        Column and row.
    """
    steps = undistort_steps(camera) if camera.distorted else 0
    x, y = undistorted(camera, (u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, steps)
    return dr.normalize(mi.Vector3f(x, y, 1.0))


def mitsuba_to_world(cam_from_target: RigidTransform) -> Any:
    """Return Mitsuba's camera ``to_world``; the render world is the target frame."""
    target_from_cam = cam_from_target.inverse()
    matrix = np.eye(4)
    matrix[:3, :3] = target_from_cam.rotation @ MITSUBA_FROM_CAM
    matrix[:3, 3] = target_from_cam.translation
    return mi.ScalarTransform4f(matrix)


def sensor_dict(camera: Camera, cam_from_target: RigidTransform, film: dict[str, Any]) -> Any:
    """Return a Mitsuba sensor for ``mi.load_dict``; bent rays where the camera distorts.

    Parameters
    ----------
    camera : Camera
    cam_from_target : RigidTransform
    film : dict
        Mitsuba's film; it may crop, its width and height must be the camera's.
    """
    to_world = mitsuba_to_world(cam_from_target)
    if camera.distorted or camera.fx != camera.fy:
        register_bent_ray_sensor()
        names = ("width", "height", "fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3")
        numbers = {name: float(getattr(camera, name)) for name in names}
        return {"type": "bent_ray_sensor", "to_world": to_world, "film": film, **numbers}
    return {
        "type": "perspective",
        "to_world": to_world,
        "fov_axis": "x",
        "fov": float(np.rad2deg(2.0 * np.arctan(0.5 * camera.width / camera.fx))),
        "principal_point_offset_x": 0.5 - (camera.cx + 0.5) / camera.width,
        "principal_point_offset_y": 0.5 - (camera.cy + 0.5) / camera.height,
        "near_clip": 1e-3,
        "far_clip": 1e5,
        "film": film,
    }


_registered: set[str] = set()


def register_bent_ray_sensor() -> None:
    """Make the sensor plugin known to Mitsuba, once per process."""
    if "bent_ray_sensor" in _registered:
        return

    class BentRaySensor(mi.Sensor):  # type: ignore[misc]
        """A Brown-Conrady pinhole camera whose rays are bent, for Mitsuba's own integrators."""

        def __init__(self, props: Any) -> None:
            super().__init__(props)
            names = ("width", "height", "fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3")
            values = {name: float(props[name]) for name in names}
            self.camera = Camera(**values)  # type: ignore[arg-type]

        def sample_ray(
            self,
            time: Any,
            wavelength_sample: Any,
            position_sample: Any,
            aperture_sample: Any,
            active: Any = True,
        ) -> Any:
            film = self.film()
            size, offset = film.crop_size(), film.crop_offset()
            u = position_sample.x * float(size[0]) + float(offset[0]) - 0.5
            v = position_sample.y * float(size[1]) + float(offset[1]) - 0.5
            in_cam = ray_direction_in_cam(self.camera, u, v)
            in_mitsuba = mi.Vector3f(-in_cam.x, -in_cam.y, in_cam.z)
            to_world = self.world_transform()
            ray = mi.Ray3f(to_world @ mi.Point3f(0.0), to_world @ in_mitsuba, time)
            return ray, mi.Color3f(1.0)

        def sample_ray_differential(
            self,
            time: Any,
            wavelength_sample: Any,
            position_sample: Any,
            aperture_sample: Any,
            active: Any = True,
        ) -> Any:
            ray, weight = self.sample_ray(
                time, wavelength_sample, position_sample, aperture_sample, active
            )
            return mi.RayDifferential3f(ray), weight

    mi.register_sensor("bent_ray_sensor", BentRaySensor)
    _registered.add("bent_ray_sensor")
