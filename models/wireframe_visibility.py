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
from models.wireframe import Wireframe

CLEAR_M = 0.03  # nearer than this to a landmark a face is its own, and hides nothing
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

    Raises
    ------
    ValueError
        If fewer than two samples are asked for.
    """
    if samples < 2:
        raise ValueError(f"expected at least 2 samples along an edge, got {samples}")
    start, end = np.moveaxis(wireframe.points_in_target[wireframe.edges], 1, 0)[:, :, None]
    points = start + np.linspace(0.0, 1.0, samples)[:, None] * (end - start)
    seen = visible_points(wireframe, points.reshape(-1, 3), cam_from_target)
    return EdgePieces(points, seen.reshape(points.shape[:2]))


def visible_points(wireframe: Wireframe, points: Floats, cam_from_target: RigidTransform) -> Mask:
    """Tell which points on the target, (n, 3) m, are in front and not hidden, (n,)."""
    camera = cam_from_target.inverse().translation
    depth = points @ cam_from_target.rotation[2] + cam_from_target.translation[2]
    hidden = _meet(wireframe.triangles_in_target - camera, points - camera)
    return np.asarray((depth > NEAR_M) & ~hidden)


def _meet(triangles: Floats, ways: Floats) -> Mask:
    """Tell which segments from the origin, (n, 3) m, meet a triangle, (f, 3, 3) m, on their way.

    With a corner a and sides b, c of a triangle and a way d, Cramer's rule gives the share of the
    way ``t = a.(b x c) / d.(b x c)`` and the place on the triangle ``u = d.(c x a) / d.(b x c)``,
    ``v = d.(a x b) / d.(b x c)``.
    """
    corner = triangles[:, 0]
    first, second = triangles[:, 1] - corner, triangles[:, 2] - corner
    normal = np.cross(first, second)
    length = np.linalg.norm(ways, axis=1, keepdims=True)
    volume = ways @ normal.T
    # All three are compared after multiplication by the volume's sign, so nothing is divided.
    sign = np.sign(volume)
    u = sign * (ways @ np.cross(second, corner).T)
    v = sign * (ways @ np.cross(corner, first).T)
    size = np.abs(volume)
    ahead = sign * np.einsum("ij,ij->i", corner, normal)
    short = 1.0 - CLEAR_M / np.maximum(length, 2.0 * CLEAR_M)
    meets = (u >= 0.0) & (v >= 0.0) & (u + v <= size) & (ahead > 0.0) & (ahead < short * size)
    return np.asarray(meets.any(axis=1))
