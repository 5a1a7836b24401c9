"""The target's surface cut into cells, each with the way it faces, and found from a place again.

Space is cut into bricks, a brick into 8 x 8 x 8 voxels. A cell is what lies of one mesh in one
voxel and faces the same one of six ways: both sides of a panel are cells of their own, and what
lies under foil is not mixed with it. Cells are numbered along a curve (Morton 1966) on which the
cells of 2 x 2 x 2 voxels follow each other, so that what landed in all of them is found at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from models.arrays import AnyArray, Floats
from renders.tracing.bounced.curve import LEVELS, along_curve

BRICK_M = 0.2
SLOTS = 512  # finest voxels of a brick
POINTS_PER_M2 = 32000.0
SPREAD_EVENLY = np.array([0.7548776662466927, 0.5698402909980532])  # Roberts' sequence R2
RAYS = 8  # from each point, for whether anything can reach it
HIDDEN_M = 0.025  # a point half of whose rays end nearer lies under something
MOSTLY = 0.7  # of the rays from inside a solid meet a face from behind
STEEPEST = 4.0  # squared tangent of the steepest facet that counts for a node's relief
NONE = 0xFFFFFFFF
WAYS = 6  # -x, +x, -y, +y, -z, +z


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """Points spread over some surface, each with the side that it looks to.

    Attributes
    ----------
    places, normals : (n, 3) arrays, m
        Target frame.
    parts : (n,) int array
        Of which mesh each is.
    """

    places: Floats
    normals: Floats
    parts: AnyArray

    def __getitem__(self, chosen: AnyArray) -> SurfacePoints:
        """Return some of them."""
        return SurfacePoints(self.places[chosen], self.normals[chosen], self.parts[chosen])


def way_of(normals: Floats) -> AnyArray:
    """Return which of six ways normals face, (n,) int."""
    axis = np.argmax(np.abs(normals), axis=1)
    return 2 * axis + (np.take_along_axis(normals, axis[:, None], axis=1)[:, 0] > 0.0)


def points_on(meshes: Iterable[Floats], bricks: Bricks, seed: int) -> SurfacePoints:
    """Spread points evenly over the triangles that reach into some bricks, two-sided.

    Parameters
    ----------
    meshes : iterable of (n, 3, 3) arrays, m
        Corners of each mesh's triangles, target frame.
    bricks : Bricks
    seed : int
    """
    rng = np.random.default_rng(seed)
    places, normals, parts = [], [], []
    for part, triangles in enumerate(meshes):
        corners = triangles[bricks.near(triangles)]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = 0.5 * np.linalg.norm(across, axis=1)
        wanted = area * POINTS_PER_M2
        count = np.floor(wanted + rng.random(len(wanted))).astype(int)
        number = np.repeat(np.arange(len(corners)), count)
        place_in_row = np.arange(len(number)) - (np.cumsum(count) - count)[number]
        start = rng.random((len(corners), 2))[number]
        a, b = ((start + place_in_row[:, None] * SPREAD_EVENLY) % 1.0).T
        beyond = a + b > 1.0
        a, b = np.where(beyond, 1.0 - a, a), np.where(beyond, 1.0 - b, b)
        weights = np.stack([1.0 - a - b, a, b], axis=1)
        place = np.einsum("nk,nkd->nd", weights, corners[number])
        inside = bricks.number(place) != NONE
        normal = across[number[inside]] / (2.0 * area[number[inside], None])
        places += [place[inside]] * 2
        normals += [normal, -normal]
        parts += [np.full(2 * int(inside.sum()), part)]
    return SurfacePoints(np.concatenate(places), np.concatenate(normals), np.concatenate(parts))


@dataclass(frozen=True, eq=False)
class Bricks:
    """Some bricks of a grid.

    Attributes
    ----------
    low : (3,) array, m
        The grid's corner.
    shape : (3,) int array
    number_of : (x, y, z) uint32 array
        Each brick's number among those chosen, or ``NONE``.
    """

    low: Floats
    shape: AnyArray
    number_of: AnyArray

    @classmethod
    def around(cls, places: Floats, low: Floats, high: Floats) -> Bricks:
        """Return those bricks of a box that hold some places.

        Parameters
        ----------
        places : (n, 3) array, m
        low, high : (3,) arrays, m
            The box.
        """
        shape = np.maximum(np.ceil((high - low) / BRICK_M).astype(int), 1)
        index = np.floor((places - low) / BRICK_M).astype(int)
        index = index[((index >= 0) & (index < shape)).all(axis=1)]
        number_of = np.full(shape, NONE, dtype=np.uint32)
        flat = np.unique(np.ravel_multi_index(index.T, shape))
        number_of.ravel()[flat] = np.arange(len(flat))
        return cls(low, shape, number_of)

    @property
    def count(self) -> int:
        """How many were chosen."""
        return int((self.number_of != NONE).sum())

    def number(self, places: Floats) -> AnyArray:
        """Return the number of the brick of each place, (n,) uint32, or ``NONE``."""
        index = np.floor((places - self.low) / BRICK_M).astype(int)
        inside = ((index >= 0) & (index < self.shape)).all(axis=1)
        number = np.full(len(places), NONE, dtype=np.uint32)
        number[inside] = self.number_of[tuple(index[inside].T)]
        return number

    def near(self, triangles: Floats) -> AnyArray:
        """Tell which triangles, (n, 3, 3) m, may reach into a chosen brick, (n,) bool."""
        chosen = np.zeros(self.shape + 1, dtype=np.int64)
        chosen[1:, 1:, 1:] = (self.number_of != NONE).cumsum(0).cumsum(1).cumsum(2)
        low = np.floor((triangles.min(axis=1) - self.low) / BRICK_M).astype(int)
        high = np.floor((triangles.max(axis=1) - self.low) / BRICK_M).astype(int) + 1
        low, high = np.clip(low, 0, self.shape), np.clip(high, 0, self.shape)
        total = np.zeros(len(triangles), dtype=np.int64)
        for corner in np.ndindex(2, 2, 2):
            pick = np.where(np.array(corner, dtype=bool), high, low)
            sign = 1 if sum(corner) % 2 == 1 else -1
            total += sign * chosen[tuple(pick.T)]
        return np.asarray(total > 0)


def open_to_light(scene: Any, points: SurfacePoints, seed: int) -> AnyArray:
    """Tell which points light can get to: not inside a solid, nor between a sheet and its panel.

    Parameters
    ----------
    scene : mitsuba.Scene
    points : SurfacePoints
    seed : int

    Returns
    -------
    (n,) array of bool
    """
    n = len(points.places)
    lanes = dr.arange(mi.UInt32, n * RAYS)
    number = lanes // RAYS
    place = mi.Point3f(*points.places.T.astype(np.float32))
    normal = mi.Vector3f(*points.normals.T.astype(np.float32))
    place, normal = (dr.gather(type(each), each, number) for each in (place, normal))
    first, second = mi.sample_tea_32(lanes, dr.opaque(mi.UInt32, seed))
    square = mi.Point2f(mi.Float(first >> 8), mi.Float(second >> 8)) * 2.0**-24
    local = mi.warp.square_to_cosine_hemisphere(square)
    towards = mi.Frame3f(normal).to_world(local)
    met = scene.ray_intersect(
        mi.Ray3f(place + normal * 1e-4, towards), mi.RayFlags.Minimal, False, True
    )
    distance = np.array(met.t).reshape(n, RAYS)
    from_behind = (np.array(dr.dot(met.n, towards)) > 0.0).reshape(n, RAYS)
    inside = from_behind.mean(axis=1) > MOSTLY
    covered = np.median(distance, axis=1) < HIDDEN_M
    return np.isinf(distance).any(axis=1) | ~(inside | covered)


@dataclass(frozen=True, eq=False)
class Nodes:
    """Groups of cells, the finer first: their area and which way it faces.

    Attributes
    ----------
    begin : tuple of int
        The number of the first node of each level, and how many there are in all.
    of_cell : (levels, cells) array of int
        The node of each level that a cell belongs to.
    points : (nodes,) array of int
        Of which each was measured.
    areas_m2 : (nodes,) float32 array
    normals : (nodes, 3) float32 array
        Mean normals, of unit length.
    reliefs : (nodes,) float32 array
        Mean squared tangent of facets' slopes against the mean normal.
    """

    begin: tuple[int, ...]
    of_cell: AnyArray
    points: AnyArray
    areas_m2: AnyArray
    normals: AnyArray
    reliefs: AnyArray

    @classmethod
    def build(cls, slots: AnyArray, cell: AnyArray, normals: Floats) -> Nodes:
        """Return the nodes over cells.

        Parameters
        ----------
        slots : (cells,) array of int
            Place of each on its curve, brick after brick.
        cell : (n,) array of int
            That points lie in.
        normals : (n, 3) array
        """
        begin, of_cell, tables = [0], [], []
        for level in range(LEVELS):
            used, node = np.unique(slots >> (3 * level), return_inverse=True)
            of_cell.append(node + begin[-1])
            begin.append(begin[-1] + len(used))
            tables.append(_facing(node[cell], normals, len(used)))
        points, area, normal, relief = (np.concatenate(each) for each in zip(*tables, strict=True))
        return cls(tuple(begin), np.stack(of_cell), points, area, normal, relief)


def _facing(node: AnyArray, normals: Floats, count: int) -> tuple[AnyArray, ...]:
    """Return nodes' numbers of points, areas, mean normals and reliefs."""
    points = np.bincount(node, minlength=count)
    total = np.stack([np.bincount(node, n, minlength=count) for n in normals.T], axis=1)
    mean = total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)
    cosine = np.einsum("nd,nd->n", normals, mean[node])
    slope = np.where(cosine > 0.0, 1.0 / np.maximum(cosine, 1e-3) ** 2 - 1.0, STEEPEST)
    relief = np.bincount(node, np.minimum(slope, STEEPEST), minlength=count) / np.maximum(points, 1)
    area = points / POINTS_PER_M2
    return points, *(each.astype(np.float32) for each in (area, mean, relief))


@dataclass(frozen=True, eq=False)
class SurfaceCells:
    """Cells of the target's surface; a *piece* is what a brick holds of one mesh.

    Attributes
    ----------
    bricks : Bricks
    pieces : (bricks, meshes) uint32 array
        The number of each piece, or ``NONE``.
    cells : (pieces * 6 * 512,) uint32 array
        The cell of each voxel and way; where there is no surface, the nearest one's.
    nodes : Nodes
    """

    bricks: Bricks
    pieces: AnyArray
    cells: AnyArray
    nodes: Nodes

    @property
    def count(self) -> int:
        """How many there are."""
        return self.nodes.of_cell.shape[1]

    @classmethod
    def build(cls, scene: Any, meshes: Sequence[Floats], bricks: Bricks, seed: int) -> SurfaceCells:
        """Cut surfaces into cells.

        Parameters
        ----------
        scene : mitsuba.Scene
            What stands around them.
        meshes : sequence of (n, 3, 3) arrays, m
        bricks : Bricks
            Those to be cut.
        seed : int
        """
        points = points_on(meshes, bricks, seed)
        points = points[open_to_light(scene, points, seed)]
        pair = bricks.number(points.places).astype(np.int64) * len(meshes) + points.parts
        there, piece = np.unique(pair, return_inverse=True)
        pieces = np.full((bricks.count, len(meshes)), NONE, dtype=np.uint32)
        pieces.ravel()[there] = np.arange(len(there))
        within = (points.places - bricks.low) / BRICK_M
        x, y, z = np.minimum(((within - np.floor(within)) * 8.0).astype(np.int64), 7).T
        slot = (piece * WAYS + way_of(points.normals)) * SLOTS + along_curve(x, y, z)
        used, cell = np.unique(slot, return_inverse=True)
        cells = np.full(len(there) * WAYS * SLOTS, NONE, dtype=np.uint32)
        cells[used] = np.arange(len(used))
        _fill_gaps(cells.reshape(-1, SLOTS))
        return cls(bricks, pieces, cells, Nodes.build(used, cell, points.normals))


def _fill_gaps(cells: AnyArray) -> None:
    """Let voxels without surface name the nearest that has one facing their way, in their brick."""
    from scipy.spatial import cKDTree

    x, y, z = np.meshgrid(*[np.arange(8)] * 3, indexing="ij")
    places = np.empty((SLOTS, 3))
    places[along_curve(x, y, z).ravel()] = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    for row in np.flatnonzero((cells != NONE).any(axis=1)):
        there = cells[row] != NONE
        nearest = cKDTree(places[there]).query(places[~there])[1]
        cells[row, ~there] = cells[row, there][nearest]


class CellFinder:
    """The cells of places, in a kernel.

    Parameters
    ----------
    cells : SurfaceCells
    mesh_of_shape : (m,) array
        By the number that Dr.Jit gives a shape, the number of its mesh, or ``NONE``.
    """

    def __init__(self, cells: SurfaceCells, mesh_of_shape: AnyArray) -> None:
        bricks = cells.bricks
        self.low = mi.Point3f(*(dr.opaque(mi.Float, float(x)) for x in bricks.low))
        self.shape = [dr.opaque(mi.Int32, int(n)) for n in bricks.shape]
        self.meshes = dr.opaque(mi.UInt32, cells.pieces.shape[1])
        self.mesh_of_shape = mi.UInt32(mesh_of_shape.astype(np.uint32))
        self.bricks = mi.UInt32(bricks.number_of.transpose(2, 1, 0).ravel())
        self.pieces = mi.UInt32(cells.pieces.ravel())
        self.cells = mi.UInt32(cells.cells)
        tables = (self.bricks, self.pieces, self.cells)
        dr.make_opaque(self.mesh_of_shape, *tables)

    def mesh(self, shape: Any, active: Any) -> Any:
        """Return the number of the mesh that a shape is, or ``NONE``."""
        number = dr.reinterpret_array(mi.UInt32, shape)
        return dr.select(active, dr.gather(mi.UInt32, self.mesh_of_shape, number, active), NONE)

    def cell(self, place: Any, normal: Any, mesh: Any, active: Any) -> Any:
        """Return the cell of a place that faces a way, or ``NONE`` where there is none.

        Parameters
        ----------
        place : Point3f, m
            Target frame.
        normal : Vector3f
            The geometric one, on the side that is asked for.
        mesh : UInt32
            On which mesh it is.
        active : Bool
        """
        size = dr.abs(normal)
        along_x = (size.x >= size.y) & (size.x >= size.z)
        along_y = ~along_x & (size.y >= size.z)
        sign = dr.select(along_x, normal.x, dr.select(along_y, normal.y, normal.z))
        axis = dr.select(along_x, mi.UInt32(0), dr.select(along_y, mi.UInt32(2), mi.UInt32(4)))
        way = axis + dr.select(sign > 0.0, mi.UInt32(1), mi.UInt32(0))
        piece, there = self._piece(place, mesh, active & (mesh != NONE))
        at = (place - self.low) * (1.0 / BRICK_M)
        at -= dr.floor(at)
        curve = mi.UInt32(0)
        for axis_number, along in enumerate(at):
            voxel = dr.minimum(mi.UInt32(along * 8.0), 7)
            for bit in range(LEVELS - 1):
                curve |= ((voxel >> bit) & 1) << (3 * bit + axis_number)
        slot = (piece * WAYS + way) * SLOTS + curve
        return dr.select(there, dr.gather(mi.UInt32, self.cells, slot, there), NONE)

    def _piece(self, place: Any, mesh: Any, active: Any) -> tuple[Any, Any]:
        at = (place - self.low) * (1.0 / BRICK_M)
        x, y, z = mi.Int32(dr.floor(at.x)), mi.Int32(dr.floor(at.y)), mi.Int32(dr.floor(at.z))
        inside = active & (x >= 0) & (y >= 0) & (z >= 0)
        inside &= (x < self.shape[0]) & (y < self.shape[1]) & (z < self.shape[2])
        index = mi.UInt32((z * self.shape[1] + y) * self.shape[0] + x)
        brick = dr.gather(mi.UInt32, self.bricks, index, inside)
        inside &= brick != NONE
        piece = dr.gather(mi.UInt32, self.pieces, brick * self.meshes + mesh, inside)
        return piece, inside & (piece != NONE)
