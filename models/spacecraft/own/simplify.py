"""Fewer faces that still hide what the mesh hides: edges collapse where the surface moves least.

Garland and Heckbert 1997 (SIGGRAPH, "Surface simplification using quadric error metrics"), onto
one of an edge's two ends, so that no corner ever lies where the mesh has none. A mesh of very many
faces is first thinned by cells (Rossignac and Borrel 1993).
"""

from __future__ import annotations

import heapq

import numpy as np

from models.arrays import Floats, Indices
from models.spacecraft.own.welded import welded

MOST_COLLAPSED = 20_000  # faces that one core collapses in some seconds
RIM_WEIGHT = 10.0  # how dear it is to move the rim of an open sheet
TURNED = 0.2  # least cosine between a face before and after


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
    """The collapses of one mesh.

    Parameters
    ----------
    points : (n, 3) array, m
    faces : (f, 3) array of int
    """

    def __init__(self, points: Floats, faces: Indices) -> None:
        self.points = points
        self.faces: list[list[int] | None] = [list(face) for face in faces.tolist()]
        self.around: list[set[int]] = [set() for _ in points]
        for number, face in enumerate(faces.tolist()):
            for corner in face:
                self.around[corner].add(number)
        self.quadrics = _quadrics(points, faces)
        self.stamp = np.zeros(len(points), dtype=np.int64)

    def down_to(self, most: int) -> Floats:
        """Collapse edges until at most so many faces are left; return them, (g, 3, 3)."""
        alive = len(self.faces)
        ends = {
            (min(a, b), max(a, b))
            for face in self.faces
            if face
            for a, b in zip(face, [*face[1:], face[0]], strict=True)
        }
        heap = [self._offer(a, b) for a, b in sorted(ends)]
        heapq.heapify(heap)
        while alive > most and heap:
            _, gone, kept, stamp_gone, stamp_kept = heapq.heappop(heap)
            fresh = self.stamp[gone] == stamp_gone and self.stamp[kept] == stamp_kept
            if not fresh or not self._may(gone, kept):
                continue
            alive -= self._move(gone, kept)
            for other in sorted(self._neighbours(kept)):
                heapq.heappush(heap, self._offer(kept, other))
        left = np.array([face for face in self.faces if face], dtype=np.int64).reshape(-1, 3)
        return np.asarray(self.points[left])

    def _offer(self, a: int, b: int) -> tuple[float, int, int, int, int]:
        """Return what it costs to collapse an edge onto its cheaper end, and which that is."""
        quadric = self.quadrics[a] + self.quadrics[b]
        costs = []
        for place in (a, b):
            x = np.append(self.points[place], 1.0)
            costs.append(float(x @ quadric @ x))
        length = float(((self.points[a] - self.points[b]) ** 2).sum())
        gone, kept = (b, a) if costs[0] <= costs[1] else (a, b)
        cost = max(min(costs), 0.0) + 1e-9 * length  # of flat ones the short go first
        return cost, gone, kept, int(self.stamp[gone]), int(self.stamp[kept])

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
            before = self.points[face]
            after = self.points[[kept if c == gone else c for c in face]]
            one = np.cross(before[1] - before[0], before[2] - before[0])
            two = np.cross(after[1] - after[0], after[2] - after[0])
            if one @ two < TURNED * np.sqrt((one @ one) * (two @ two)) or not two @ two > 0.0:
                return False
        return True

    def _move(self, gone: int, kept: int) -> int:
        """Collapse; return how many faces went."""
        went = 0
        for number in self.around[gone]:
            face = self.faces[number]
            assert face is not None
            if kept in face:
                self.faces[number] = None
                went += 1
                for corner in face:
                    if corner != gone:
                        self.around[corner].discard(number)
            else:
                self.faces[number] = [kept if c == gone else c for c in face]
                self.around[kept].add(number)
        self.around[gone] = set()
        self.quadrics[kept] += self.quadrics[gone]
        self.stamp[gone] += 1
        self.stamp[kept] += 1
        return went


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
