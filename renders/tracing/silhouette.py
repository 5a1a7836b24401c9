"""Which pixels can show anything at all: seen from afar a spacecraft fills few of an image's.

Each part lies within its convex hull, and so does its picture within the hull of its corners'. The
rest of the image is dark and need not be traced.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import product

import cv2
import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.lights.earth import Earth
from models.pose import RigidTransform
from models.spacecraft.part import Spacecraft
from models.spacecraft.stance import BODY_ALONE, Stance

MARGIN_PX = 2  # half a pixel, and the rounding of corners
NEAREST_M = 0.1  # a corner nearer than this has no picture to speak of
CUBE = np.array(list(product((-1.0, 1.0), repeat=3)))  # around a disc, whatever way it faces


def pieces_of(
    target: Spacecraft,
    chaser: Spacecraft | None,
    cam_from_target: RigidTransform,
    stance: Stance = BODY_ALONE,
) -> Iterator[Floats]:
    """Yield the corners of everything that could be seen, (n, 3), m, target frame.

    Parameters
    ----------
    target : Spacecraft
    chaser : Spacecraft or None
    cam_from_target : RigidTransform
    stance : Stance
        Of the chaser.
    """
    for part in target.parts:
        yield np.asarray(part.mesh.vertices, dtype=np.float64)
    if target.markers is not None:
        for point in target.markers.points_in_target:
            yield point + target.markers.radius_m * CUBE
    if chaser is not None:
        target_from_cam = cam_from_target.inverse()
        for part in chaser.parts:
            yield target_from_cam @ stance.corners(part)


def pixels_in_view(
    pieces: Iterable[Floats], camera: Camera, cam_from_target: RigidTransform
) -> Mask | None:
    """Return the pixels that some pieces can fill, with some to spare.

    Parameters
    ----------
    pieces : iterable of (n, 3) arrays, m
        Corners in the target frame; each piece lies within their convex hull.
    camera : Camera
    cam_from_target : RigidTransform

    Returns
    -------
    (height, width) array of bool, or None
        None where it cannot be told: the lens bends straight edges, or stands among the pieces.
    """
    if camera.distorted:
        return None
    drawn = np.zeros((camera.height, camera.width), dtype=np.uint8)
    farthest = 4.0 * max(camera.width, camera.height)
    sides = _sides(camera)
    for piece in pieces:
        in_cam = cam_from_target @ piece
        if (in_cam @ sides.T < 0.0).all(axis=0).any():
            continue  # all of it beyond one side of the image, or behind the camera
        if in_cam[:, 2].min() < NEAREST_M:
            return None
        pixels = camera.project(in_cam)
        if np.abs(pixels).max() > farthest:  # OpenCV draws in 32 bits
            return None
        hull = cv2.convexHull(np.rint(pixels).astype(np.int32))
        cv2.fillConvexPoly(drawn, hull, 1)
        cv2.polylines(drawn, [hull], isClosed=True, color=1, thickness=2 * MARGIN_PX + 1)
    return drawn.astype(np.bool_)


def in_sight(pieces: Iterable[Floats], camera: Camera, cam_from_target: RigidTransform) -> bool:
    """Tell whether any piece can be within the image; it may be hidden behind another.

    Parameters
    ----------
    pieces : iterable of (n, 3) arrays, m
        As in ``pixels_in_view``.
    camera : Camera
        Any: it may distort.
    cam_from_target : RigidTransform
    """
    normalised = camera.normalise(_border(camera))
    (left, top), (right, bottom) = normalised.min(axis=0), normalised.max(axis=0)
    sides = np.array(
        [[1, 0, -left], [-1, 0, right], [0, 1, -top], [0, -1, bottom], [0, 0, 1]], dtype=np.float64
    )
    return any(
        not ((cam_from_target @ piece) @ sides.T < 0.0).all(axis=0).any() for piece in pieces
    )


def _sides(camera: Camera) -> Floats:
    """Return planes through the lens, (5, 3): a point in the image is on the positive side of all.

    The sides of the image, with the margin, and the plane of the lens.
    """
    low, margin = -0.5 - MARGIN_PX, 0.5 + MARGIN_PX
    right, bottom = camera.width - 1 + margin, camera.height - 1 + margin
    return np.array(
        [
            [camera.fx, 0.0, camera.cx - low],
            [-camera.fx, 0.0, right - camera.cx],
            [0.0, camera.fy, camera.cy - low],
            [0.0, -camera.fy, bottom - camera.cy],
            [0.0, 0.0, 1.0],
        ]
    )


def sees(camera: Camera, cam_from_target: RigidTransform, earth: Earth) -> bool:
    """Tell whether any of the Earth's disc is within the image.

    Parameters
    ----------
    camera : Camera
    cam_from_target : RigidTransform
    earth : Earth
    """
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
