"""Fewer faces that still hide what the mesh hides: edges collapse where the surface moves least.

Garland and Heckbert 1997 (SIGGRAPH, "Surface simplification using quadric error metrics"), onto
one of an edge's two ends, so that no corner ever lies where the mesh has none. A mesh of very many
faces is first thinned by cells (Rossignac and Borrel 1993).
"""

from __future__ import annotations

import heapq
from typing import TypeAlias

import numpy as np

from models.arrays import Floats, Indices
from models.spacecraft.own.welded import welded

MOST_COLLAPSED = 20_000  # faces that one core collapses in some seconds
RIM_WEIGHT = 10.0  # how dear it is to move the rim of an open sheet
TURNED = 0.2  # least cosine between a face before and after
ROW, COLUMN = np.triu_indices(4)  # of a quadric: ten numbers tell it

Point: TypeAlias = tuple[float, float, float]


def simplified(triangles: Floats, most: int) -> Floats:
    """Return a surface of about ``most`` faces, or the one given if it has no more.

    Parameters
    ----------
    triangles : (f, 3, 3) array, m
    most : int

    Returns
    -------
    (g, 3, 3) array, m
    """
    body = welded(triangles)
    points, faces = body.points, body.faces
    if len(faces) <= most:
        return np.asarray(points[faces])
    if len(faces) > MOST_COLLAPSED:
        points, faces = _thinned(points, faces, MOST_COLLAPSED)
    return _Collapse(points, faces).down_to(most)


def _thinned(points: Floats, faces: Indices, most: int) -> tuple[Floats, Indices]:
    """Move corners that share a cell to the one farthest out; larger cells until it fits."""
    size = float(np.ptp(points, axis=0).max())
    away = np.linalg.norm(points - points.mean(axis=0), axis=1)
    for cells in (200, 140, 100, 70, 50, 35, 25):
        cell = np.floor((points - points.min(axis=0)) / (size / cells)).astype(np.int64)
        _, number = np.unique(cell, axis=0, return_inverse=True)
        number = np.asarray(number).ravel()
        order = np.lexsort((away, number))
        last = np.append(np.flatnonzero(np.diff(number[order])), len(order) - 1)
        stands_for = order[last][number]
        thin = stands_for[faces]
        thin = thin[~(thin == np.roll(thin, 1, axis=1)).any(axis=1)]
        _, once = np.unique(np.sort(thin, axis=1), axis=0, return_index=True)
        thin = thin[np.sort(once)]
        if len(thin) <= most:
            break
    return points, thin


class _Collapse:
    """The collapses of one mesh, in plain Python: of three numbers numpy makes slow work.

    Parameters
    ----------
    points : (n, 3) array, m
    faces : (f, 3) array of int
    """

    def __init__(self, points: Floats, faces: Indices) -> None:
        self.points: list[Point] = [(x, y, z) for x, y, z in points.tolist()]
        self.faces: list[list[int] | None] = faces.tolist()
        self.alive = len(faces)
        self.around: list[set[int]] = [set() for _ in points]
        for number, face in enumerate(faces.tolist()):
            for corner in face:
                self.around[corner].add(number)
        self.quadrics: list[list[float]] = _quadrics(points, faces)[:, ROW, COLUMN].tolist()
        self.stamp = [0] * len(points)

    def down_to(self, most: int) -> Floats:
        """Collapse edges until at most so many faces are left; return them, (g, 3, 3).

        Where the surface branches, what keeps it in order may leave too many; then it goes on
        without.
        """
        for in_order in (True, False):
            self._collapse(most, in_order)
        left = np.array([face for face in self.faces if face], dtype=np.int64).reshape(-1, 3)
        return np.asarray(np.array(self.points)[left])

    def _collapse(self, most: int, in_order: bool) -> None:
        ends = {
            (min(a, b), max(a, b))
            for face in self.faces
            if face
            for a, b in zip(face, [*face[1:], face[0]], strict=True)
        }
        heap = [self._offer(a, b) for a, b in sorted(ends)]
        heapq.heapify(heap)
        while self.alive > most and heap:
            _, gone, kept, stamp_gone, stamp_kept = heapq.heappop(heap)
            if self.stamp[gone] != stamp_gone or self.stamp[kept] != stamp_kept:
                continue
            if in_order and not self._may(gone, kept):
                continue
            self._move(gone, kept)
            for other in sorted(self._neighbours(kept)):
                heapq.heappush(heap, self._offer(kept, other))

    def _offer(self, a: int, b: int) -> tuple[float, int, int, int, int]:
        """Return what it costs to collapse an edge onto its cheaper end, and which that is."""
        quadric = [p + q for p, q in zip(self.quadrics[a], self.quadrics[b], strict=True)]
        one, two = _cost(quadric, self.points[a]), _cost(quadric, self.points[b])
        (ax, ay, az), (bx, by, bz) = self.points[a], self.points[b]
        length = (ax - bx) ** 2 + (ay - by) ** 2 + (az - bz) ** 2
        gone, kept = (b, a) if one <= two else (a, b)
        cost = max(min(one, two), 0.0) + 1e-9 * length  # of flat ones the short go first
        return cost, gone, kept, self.stamp[gone], self.stamp[kept]

    def _neighbours(self, corner: int) -> set[int]:
        return {c for number in self.around[corner] for c in self.faces[number] or ()} - {corner}

    def _may(self, gone: int, kept: int) -> bool:
        """Tell whether no face is turned over, and none comes to lie on another."""
        if len(self._neighbours(gone) & self._neighbours(kept)) > 2:
            return False
        for number in self.around[gone]:
            face = self.faces[number]
            if not face or kept in face:
                continue
            before = [self.points[c] for c in face]
            after = [self.points[kept if c == gone else c] for c in face]
            (ax, ay, az), (bx, by, bz) = _upright(before), _upright(after)
            size = (ax * ax + ay * ay + az * az) * (bx * bx + by * by + bz * bz)
            if not size > 0.0 or ax * bx + ay * by + az * bz < TURNED * size**0.5:
                return False
        return True

    def _move(self, gone: int, kept: int) -> None:
        """Collapse an edge."""
        for number in self.around[gone]:
            face = self.faces[number]
            assert face is not None
            if kept in face:
                self.faces[number] = None
                self.alive -= 1
                for corner in face:
                    if corner != gone:
                        self.around[corner].discard(number)
            else:
                self.faces[number] = [kept if c == gone else c for c in face]
                self.around[kept].add(number)
        self.around[gone] = set()
        both = zip(self.quadrics[kept], self.quadrics[gone], strict=True)
        self.quadrics[kept] = [p + q for p, q in both]
        self.stamp[gone] += 1
        self.stamp[kept] += 1


def _cost(q: list[float], point: Point) -> float:
    """Return the squared distance from the planes of a quadric, weighed."""
    x, y, z = point
    return (
        q[0] * x * x + q[4] * y * y + q[7] * z * z + q[9]
        + 2.0 * (x * (q[1] * y + q[2] * z + q[3]) + y * (q[5] * z + q[6]) + q[8] * z)
    )  # fmt: skip


def _upright(corners: list[Point]) -> Point:
    """Return the cross product of two sides of a face."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = corners
    ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


def _quadrics(points: Floats, faces: Indices) -> Floats:
    """Return the squared distance from the planes about each corner as a form, (n, 4, 4)."""
    a, b, c = np.moveaxis(points[faces], 1, 0)
    normals = np.cross(b - a, c - a)
    lengths = np.maximum(np.linalg.norm(normals, axis=1), 1e-300)
    normals /= lengths[:, None]
    planes = np.append(normals, -np.einsum("fi,fi->f", normals, a)[:, None], axis=1)
    weighed = np.einsum("f,fi,fj->fij", 0.5 * lengths, planes, planes)
    quadrics = np.zeros((len(points), 4, 4))
    for k in range(3):
        np.add.at(quadrics, faces[:, k], weighed)
    # The rim of a sheet is held by a plane through it, upright on the face.
    directed = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    owner = np.repeat(np.arange(len(faces)), 3)
    _, first, count = np.unique(
        np.sort(directed, axis=1), axis=0, return_index=True, return_counts=True
    )
    rim = first[count == 1]
    along = points[directed[rim, 1]] - points[directed[rim, 0]]
    upright = np.cross(along, normals[owner[rim]])
    upright /= np.maximum(np.linalg.norm(upright, axis=1, keepdims=True), 1e-300)
    offset = -np.einsum("fi,fi->f", upright, points[directed[rim, 0]])
    planes = np.append(upright, offset[:, None], axis=1)
    weight = RIM_WEIGHT * np.einsum("fi,fi->f", along, along)
    weighed = np.einsum("f,fi,fj->fij", weight, planes, planes)
    for k in range(2):
        np.add.at(quadrics, directed[rim, k], weighed)
    return quadrics
