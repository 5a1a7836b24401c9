"""A mesh whose corners that lie in one place are one, as edges and bodies need it.

Exporters cut a surface apart wherever normals or texture coordinates change; STL cuts it apart
everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from models.arrays import Floats, Indices, Mask

WELD_SHARE = 2e-6  # of the mesh's size: nearer than this are one
FLAT_SHARE = 1e-12  # of its size squared: a face of less area is none


@dataclass(frozen=True, eq=False)
class Welded:
    """Triangles that share corners.

    Attributes
    ----------
    points : (n, 3) array
    faces : (f, 3) array of int
        None degenerate, none twice.
    source : (f,) array of int
        Which of the triangles handed in each face was.
    degenerate, twice : int
        How many were left out.
    """

    points: Floats
    faces: Indices
    source: Indices
    degenerate: int
    twice: int

    @cached_property
    def normals(self) -> Floats:
        """(f, 3) array: unit normals."""
        a, b, c = np.moveaxis(self.points[self.faces], 1, 0)
        normals = np.cross(b - a, c - a)
        return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))

    @cached_property
    def edges(self) -> EdgeTable:
        """The edges, and the faces on them."""
        return EdgeTable.of(self.faces)

    @cached_property
    def bodies(self) -> Indices:
        """(f,) array of int: which connected body a face belongs to."""
        pairs = self.edges.pairs
        graph = coo_matrix(
            (np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(self.faces),) * 2
        )
        return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


@dataclass(frozen=True, eq=False)
class EdgeTable:
    """The edges of faces.

    Attributes
    ----------
    ends : (e, 2) array of int
        Points, the lower number first.
    count : (e,) array of int
        Faces on each.
    first, second : (e,) array of int
        Two of them; ``second`` is -1 where there is but one.
    against : (e,) array of bool
        Whether the two run along it in opposite directions, as on a closed surface.
    """

    ends: Indices
    count: Indices
    first: Indices
    second: Indices
    against: Mask

    @classmethod
    def of(cls, faces: Indices) -> EdgeTable:
        """Find the edges of faces, (f, 3)."""
        directed = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        owner = np.repeat(np.arange(len(faces)), 3)
        forward = directed[:, 0] < directed[:, 1]
        undirected = np.sort(directed, axis=1)
        order = np.lexsort((owner, undirected[:, 1], undirected[:, 0]))
        undirected, owner, forward = undirected[order], owner[order], forward[order]
        new = np.ones(len(order), dtype=bool)
        new[1:] = (undirected[1:] != undirected[:-1]).any(axis=1)
        start = np.flatnonzero(new)
        count = np.diff(np.append(start, len(order)))
        after = np.minimum(start + 1, len(order) - 1)
        has_two = count >= 2
        return cls(
            undirected[start],
            count,
            owner[start],
            np.where(has_two, owner[after], -1),
            has_two & (forward[start] != forward[after]),
        )

    @property
    def pairs(self) -> Indices:
        """(p, 2) array of int: faces that share an edge."""
        return np.asarray(np.stack([self.first, self.second], axis=1)[self.second >= 0])


def welded(triangles: Floats) -> Welded:
    """Weld triangles.

    Parameters
    ----------
    triangles : (f, 3, 3) array
        In any unit.
    """
    corners = triangles.reshape(-1, 3)
    size = float(np.linalg.norm(np.ptp(corners, axis=0))) or 1.0
    cells = np.rint((corners - corners.min(axis=0)) / (WELD_SHARE * size)).astype(np.int64)
    _, where, number = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    points, number = _across_borders(corners[where], np.asarray(number), WELD_SHARE * size)
    faces = number.reshape(-1, 3)
    sides = points[faces]
    area = np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1)
    good = (area > FLAT_SHARE * size**2) & ~(faces == np.roll(faces, 1, axis=1)).any(axis=1)
    source = np.flatnonzero(good)
    _, once = np.unique(np.sort(faces[source], axis=1), axis=0, return_index=True)
    kept = source[np.sort(once)]
    return Welded(points, faces[kept], kept, len(faces) - len(source), len(source) - len(kept))


def _across_borders(points: Floats, number: Indices, near: float) -> tuple[Floats, Indices]:
    """Join points that are near each other in different cells: return those left, and numbers."""
    pairs = cKDTree(points).query_pairs(near, output_type="ndarray")
    if not len(pairs):
        return points, number
    graph = coo_matrix((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(points),) * 2)
    _, group = connected_components(graph, directed=False)
    _, first, joined = np.unique(group, return_index=True, return_inverse=True)
    return points[first], np.asarray(joined)[number]
