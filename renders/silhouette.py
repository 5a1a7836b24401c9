"""Which pixels can show anything at all: seen from afar a spacecraft fills few of an image's.

Each part lies within its convex hull, and so does its picture within the hull of its corners'. The
rest of the image is dark and need not be traced.
"""

from __future__ import annotations

import cv2
import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.lights.earth import Earth
from models.pose import RigidTransform
from models.spacecraft.part import Spacecraft

MARGIN_PX = 2  # half a pixel, and the rounding of corners
NEAREST_M = 0.1  # a corner nearer than this has no picture to speak of


def pixels_in_view(
    spacecraft: Spacecraft, camera: Camera, cam_from_target: RigidTransform
) -> Mask | None:
    """Return the pixels that a spacecraft can fill, with some to spare.

    Returns
    -------
    (height, width) array of bool, or None
        None where it cannot be told: the lens bends straight edges, or stands among the parts.
    """
    if camera.distorted:
        return None
    drawn = np.zeros((camera.height, camera.width), dtype=np.uint8)
    farthest = 4.0 * max(camera.width, camera.height)
    for part in spacecraft.parts:
        in_cam = cam_from_target @ np.asarray(part.mesh.vertices, dtype=np.float64)
        if in_cam[:, 2].min() < NEAREST_M:
            return None
        pixels = camera.project(in_cam)
        if np.abs(pixels).max() > farthest:  # OpenCV draws in 32 bits
            return None
        hull = cv2.convexHull(np.rint(pixels).astype(np.int32))
        cv2.fillConvexPoly(drawn, hull, 1)
        cv2.polylines(drawn, [hull], isClosed=True, color=1, thickness=2 * MARGIN_PX + 1)
    return drawn.astype(np.bool_)


def sees(camera: Camera, cam_from_target: RigidTransform, earth: Earth) -> bool:
    """Tell whether any of the Earth's disc is within the image."""
    edge = _border(camera)
    rays = cam_from_target.inverse().rotate(camera.rays(edge))
    towards = np.array(earth.direction_in_target)
    if (rays @ towards >= np.sqrt(1.0 - earth.sine_of_radius**2)).any():
        return True
    centre = camera.project(cam_from_target.rotate(towards))
    return bool(camera.contains(np.nan_to_num(centre, nan=-1e9)))


def _border(camera: Camera) -> Floats:
    """Return the outer edge of the image as points, (n, 2), px."""
    u = np.arange(camera.width + 1) - 0.5
    v = np.arange(camera.height + 1) - 0.5
    sides = [np.stack([u, np.full_like(u, end)], axis=1) for end in (-0.5, camera.height - 0.5)] + [
        np.stack([np.full_like(v, end), v], axis=1) for end in (-0.5, camera.width - 0.5)
    ]
    return np.concatenate(sides)
