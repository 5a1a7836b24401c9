"""Which faces are shaded as one curved surface: those that meet at less than an angle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from models.arrays import Floats, Indices, Mask
from models.spacecraft.own.welded import Welded

if TYPE_CHECKING:
    import trimesh

FLAT = 1.0 - 1e-6  # cosine between faces that are one plane


@dataclass(frozen=True, eq=False)
class Shading:
    """A mesh's corners as they are shaded: shared within curved surfaces, cut apart between them.

    Attributes
    ----------
    points : (n, 3) array, m
    normals : (n, 3) array or None
        None where nothing is curved.
    faces : (f, 3) array of int
        In the order in which they came.
    """

    points: Floats
    normals: Floats | None
    faces: Indices

    def mesh_of(self, kept: Mask) -> trimesh.Trimesh:
        """Return some of the faces as a mesh.

        Parameters
        ----------
        kept : (f,) array of bool
        """
        import trimesh

        used, faces = np.unique(self.faces[kept], return_inverse=True)
        return trimesh.Trimesh(
            self.points[used],
            np.asarray(faces).reshape(-1, 3),
            vertex_normals=None if self.normals is None else self.normals[used],
            process=False,
        )


def shading_of(body: Welded, smooth_deg: float) -> Shading:
    """Tell which corners share a normal.

    Parameters
    ----------
    body : Welded
    smooth_deg : float, deg
        Faces that meet at less are one curved surface.
    """
    pairs, normals = body.edges.pairs, body.normals
    cosine = np.einsum("pi,pi->p", normals[pairs[:, 0]], normals[pairs[:, 1]])
    together = body.edges.against[body.edges.second >= 0] & (
        cosine > np.cos(np.deg2rad(smooth_deg))
    )
    if not (together & (cosine < FLAT)).any():
        return Shading(body.points, None, body.faces)
    joined = pairs[together]
    graph = coo_matrix(
        (np.ones(len(joined)), (joined[:, 0], joined[:, 1])), shape=(len(body.faces),) * 2
    )
    _, surface = connected_components(graph, directed=False)
    corner = np.stack([body.faces.ravel(), np.repeat(surface, 3)], axis=1)
    kept, faces = np.unique(corner, axis=0, return_inverse=True)
    faces = np.asarray(faces).reshape(-1, 3)
    points = body.points[kept[:, 0]]
    mean = _normals(points, faces, len(kept))
    if not (np.linalg.norm(mean, axis=1) > 0.5).all():  # folded: opposite faces cancel
        return Shading(body.points, None, body.faces)
    return Shading(points, mean, faces)


def _normals(points: Floats, faces: Indices, count: int) -> Floats:
    """Return the mean normal at each corner, (n, 3), each face weighed by its area."""
    a, b, c = np.moveaxis(points[faces], 1, 0)
    each = np.cross(b - a, c - a)
    total = np.stack(
        [np.bincount(faces.ravel(), np.repeat(each[:, k], 3), minlength=count) for k in range(3)],
        axis=1,
    )
    return np.asarray(total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300))
