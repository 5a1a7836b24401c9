"""Which points of the target the Sun reaches: their shadows are cast along parallel rays.

Seen from the Sun, every triangle that covers a point and stands nearer to it throws a shadow on
it. The truth of images with markers tells this already; that of landmarks does not.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Indices, Mask

CLEAR_M = 0.03  # towards the Sun: what lies nearer to a landmark is its own surface


def sunlit(
    points_in_target: Floats, vertices_in_target: Floats, faces: Indices, sun_dir_in_target: Floats
) -> Mask:
    """Tell which points have nothing of the mesh between them and the Sun.

    Parameters
    ----------
    points_in_target : (n, 3) array, m
    vertices_in_target : (v, 3) array, m
    faces : (f, 3) array of int
    sun_dir_in_target : (3,) array
        Unit vector towards the Sun.

    Returns
    -------
    (n,) array of bool
    """
    axes = _around(sun_dir_in_target)
    seen, ahead = axes @ vertices_in_target.T, points_in_target @ axes.T
    corners = seen.T[faces[_near_any(seen, faces, ahead)]]
    low, high = corners.min(axis=1), corners.max(axis=1)
    lit = np.ones(len(points_in_target), dtype=np.bool_)
    for number, (x, y, height) in enumerate(ahead):
        near = (low[:, 0] <= x) & (x <= high[:, 0]) & (low[:, 1] <= y) & (y <= high[:, 1])
        near &= high[:, 2] > height + CLEAR_M
        lit[number] = not _covers(corners[near], np.array([x, y]), height + CLEAR_M)
    return lit


def _near_any(seen: Floats, faces: Indices, points: Floats) -> Mask:
    """Tell which faces, (f, 3) of (3, v), have a point, (n, 3), in their width and height."""
    near = np.ones(len(faces), dtype=np.bool_)
    for axis in (0, 1):
        ordered = np.sort(points[:, axis])
        before = np.searchsorted(ordered, seen[axis], "left").astype(np.int32)
        up_to = np.searchsorted(ordered, seen[axis], "right").astype(np.int32)
        first, past = before[faces[:, 0]], up_to[faces[:, 0]]
        for corner in (1, 2):
            first = np.minimum(first, before[faces[:, corner]])
            past = np.maximum(past, up_to[faces[:, corner]])
        near &= first < past
    return near


def _covers(corners: Floats, place: Floats, above: float) -> bool:
    """Tell whether a triangle stands over a place, higher than ``above``."""
    a, b, c = np.moveaxis(corners, 1, 0)
    first, second, way = b - a, c - a, place - a[:, :2]
    area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    some = area != 0.0
    area = np.where(some, area, 1.0)
    u = (way[:, 0] * second[:, 1] - way[:, 1] * second[:, 0]) / area
    v = (first[:, 0] * way[:, 1] - first[:, 1] * way[:, 0]) / area
    height = a[:, 2] + u * first[:, 2] + v * second[:, 2]
    return bool((some & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (height > above)).any())


def _around(direction: Floats) -> Floats:
    """Return a rotation, (3, 3), whose third row is a direction."""
    helper = np.eye(3)[int(np.argmin(np.abs(direction)))]
    first = np.cross(helper, direction)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(direction, first), direction])
