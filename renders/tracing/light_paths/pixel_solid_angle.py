"""Where a camera shows a place, and how large a solid angle its pixels cover there, on Dr.Jit."""

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi

from models.camera import Camera


def projected_place(camera: Camera, x: Any, y: Any) -> tuple[Any, Any]:
    """Return the pixel coordinates of an ideal image point (Brown-Conrady).

    Parameters
    ----------
    camera : Camera
    x, y : Float
        Undistorted, normalised.
    """
    k1, k2, p1, p2, k3 = (float(value) for value in camera.distortion)
    a, b = x, y
    if camera.distorted:
        r2 = x * x + y * y
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        a = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)
        b = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y
    return a * camera.fx + camera.cx, b * camera.fy + camera.cy


def solid_angle(camera: Camera, x: Any, y: Any) -> Any:
    """Return the solid angle of a pixel, sr, about an ideal image point.

    Parameters
    ----------
    camera : Camera
    x, y : Float
        Undistorted, normalised.
    """
    r2 = x * x + y * y
    on_axis = 1.0 / (camera.fx * camera.fy * (1.0 + r2) * dr.sqrt(1.0 + r2))
    if not camera.distorted:
        return mi.Float(on_axis)
    k1, k2, p1, p2, k3 = (float(value) for value in camera.distortion)
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3))
    xx = radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x
    xy = x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y
    yy = radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x
    return on_axis / dr.abs(xx * yy - xy * xy)
