"""Which landmarks and which stretches of edge a camera sees, and which the target hides itself.

All rays start at the camera, so that whether one meets a triangle is told by three dot products
with vectors of the triangle alone (Moller and Trumbore 1997, with the ray's origin taken out).
Field of view is not asked: what is in front and not hidden may still project outside the image.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Mask
from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe

CLEAR_M = 0.03  # less than this above a landmark a face is its own, and hides nothing,
GRAZING_TIMES = 10.0  # along the ray within so much more: a landmark lies between a sheet's sides
CLEAR_SHARE = 0.01  # of the target's radius: of a target below 3 m this is less
NEAR_M = 1e-6  # nearer than this to the camera's plane is not in front


@dataclass(frozen=True, eq=False)
class EdgePieces:
    """Points along a wireframe's edges and whether each is seen.

    Attributes
    ----------
    points_in_target : (e, s, 3) array, m
        Evenly spaced from the edge's first landmark to its second, both ends included.
    visible : (e, s) array of bool
    """

    points_in_target: Floats
    visible: Mask


def visible_landmarks(wireframe: Wireframe, cam_from_target: RigidTransform) -> Mask:
    """Tell which landmarks are in front of the camera and not hidden, (m,) array of bool."""
    return visible_points(wireframe, wireframe.points_in_target, cam_from_target)


def visible_edge_pieces(
    wireframe: Wireframe, cam_from_target: RigidTransform, samples: int = 16
) -> EdgePieces:
    """Return ``samples`` points along each edge and which of them are seen.

    Parameters
    ----------
    wireframe : Wireframe
    cam_from_target : RigidTransform
    samples : int
        At least 2; both ends count.

    Raises
    ------
    ValueError
        If fewer than two samples are asked for.
    """
    if samples < 2:
        raise ValueError(f"expected at least 2 samples along an edge, got {samples}")
    start, end = np.moveaxis(wireframe.points_in_target[wireframe.edges], 1, 0)
    share = np.linspace(0.0, 1.0, samples)[:, None]
    points = start[:, None] + share * (end - start)[:, None]
    camera = cam_from_target.inverse().translation
    triangles, ways = wireframe.triangles_in_target - camera, points - camera
    edge, face = np.nonzero(_may_cross(triangles, start - camera, end - camera))
    meets = _meet(triangles[face], ways[edge], _clear_m(wireframe))
    hidden = np.zeros(ways.shape[:2], dtype=bool)
    np.logical_or.at(hidden, edge, meets)
    return EdgePieces(points, _in_front(points, cam_from_target) & ~hidden)


def visible_points(wireframe: Wireframe, points: Floats, cam_from_target: RigidTransform) -> Mask:
    """Tell which points on the target are in front and not hidden.

    Parameters
    ----------
    wireframe : Wireframe
        Whose triangles hide.
    points : (n, 3) array, m
        In the target frame.
    cam_from_target : RigidTransform

    Returns
    -------
    (n,) array of bool
    """
    camera = cam_from_target.inverse().translation
    ways = (points - camera)[None]
    meets = _meet(wireframe.triangles_in_target - camera, ways, _clear_m(wireframe))
    return _in_front(points, cam_from_target) & ~meets.any(axis=0)


def _in_front(points: Floats, cam_from_target: RigidTransform) -> Mask:
    depth = points @ cam_from_target.rotation[2] + cam_from_target.translation[2]
    return np.asarray(depth > NEAR_M)


def _may_cross(triangles: Floats, start: Floats, end: Floats) -> Mask:
    """Tell which triangles reach both sides of the plane of the origin and an edge, (e, f)."""
    side = triangles.reshape(-1, 3) @ np.cross(start, end).T
    side = side.reshape(len(triangles), 3, len(start))
    return np.asarray((side.min(axis=1) <= 0.0) & (side.max(axis=1) >= 0.0)).T


def _clear_m(wireframe: Wireframe) -> float:
    """Return how near to a landmark a face is its own, m."""
    if not len(wireframe.triangles_in_target):
        return CLEAR_M
    corners = wireframe.triangles_in_target.reshape(-1, 3)
    farthest_m = float(np.sqrt(np.einsum("ij,ij->i", corners, corners).max()))
    return min(CLEAR_M, CLEAR_SHARE * farthest_m)


def _meet(triangles: Floats, ways: Floats, clear_m: float) -> Mask:
    """Tell which segments from the origin meet which triangle on their way, (f, n).

    With a corner a and sides b, c of a triangle and a way d, Cramer's rule gives the share of the
    way ``t = a.(b x c) / d.(b x c)`` and the place on the triangle ``u = d.(c x a) / d.(b x c)``,
    ``v = d.(a x b) / d.(b x c)``.

    Parameters
    ----------
    triangles : (f, 3, 3) array, m
    ways : (f, n, 3) or (1, n, 3) array, m
        The segments that each triangle is asked about.
    clear_m : float, m
        Nothing is met nearer than this to the far end, nor by a face of which the far end lies less
        than this behind within ``GRAZING_TIMES`` as much of the way.
    """
    corner = triangles[:, 0]
    first, second = triangles[:, 1] - corner, triangles[:, 2] - corner
    normal = np.cross(first, second)
    across = (normal, np.cross(second, corner), np.cross(corner, first))
    if len(ways) == 1:  # one product of matrices, not one for each triangle
        volume, u, v = (each @ ways[0].T for each in across)
    else:
        volume, u, v = (np.einsum("fnk,fk->fn", ways, each) for each in across)
    # All are compared after multiplication by the volume's sign, so that nothing is divided.
    sign, size = np.sign(volume), np.abs(volume)
    u, v = sign * u, sign * v
    ahead = sign * np.einsum("ij,ij->i", corner, normal)[:, None]
    length = np.linalg.norm(ways, axis=-1)
    near, far = (
        1.0 - times * clear_m / np.maximum(length, 2.0 * times * clear_m)
        for times in (1.0, GRAZING_TIMES)
    )
    above = size - clear_m * np.linalg.norm(normal, axis=1)[:, None]
    before = (ahead < near * size) & ((ahead < above) | (ahead < far * size))
    meets = (u >= 0.0) & (v >= 0.0) & (u + v <= size) & (ahead > 0.0) & before
    return np.asarray(meets)
