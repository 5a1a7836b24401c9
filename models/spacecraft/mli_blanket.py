"""Multi-layer insulation: crinkled foil over a flat panel, quilted by seams, held flat at fittings.

The outer foil is stiff and thin, so it does not wave: it breaks into facets that meet in sharp
creases, and those into smaller ones, over a wide range of sizes (Blair and Kudrolli 2005, Phys.
Rev. Lett. 94, 166107); each facet turns the Sun's image its own way. Here two random
triangulations of a random height, one fine and one coarse, are folded into one sheet; their edges
are vertices of the mesh, so that they stay sharp. Over it lies the soft pillow between seams.
Small turns between triangles are shaded smoothly, as foil bends; larger ones are creases.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.spatial import Delaunay, cKDTree

from models.arrays import AnyArray, Floats
from models.spacecraft.solids import creased, joined, mesh_of

TAPE_WIDTH_M = 0.03
HOLD_M = 0.06  # the foil is free again this far from where it is held
FOLD_FACETS = (5.5, 2.2)  # size of the large and the middling facets over that of the mesh
RELIEF_SHARES = (0.70, 0.24, 0.06)  # of the relief: large facets, middling ones, the mesh's own
CREASE_DEG = 7.0  # triangles that turn by more from each other meet in a sharp crease
APART = 0.45  # of the mesh's size: points nearer than this to another are left out
SLIVER_M2 = 1e-9  # triangles on the straight edges that are thinner than this are none

Point = tuple[float, float]
Line = tuple[Point, Point]
Circle = tuple[float, float, float]  # x, y, radius


@dataclass(frozen=True)
class Blanket:
    """One panel of foil in its own frame: x and y along it, z away from the spacecraft.

    Attributes
    ----------
    low, high : (float, float), m
        Corners of its rectangle.
    facet_m : float, m
        Size of the smallest facets, the triangles of the mesh.
    seed : int
    seams : tuple of ((float, float), (float, float)), m
        Taped lines along which the foil is held down.
    hole : (float, float, float) or None, m
        (x, y, radius) of a round cut-out.
    is_round : bool
        Whether the foil is the circle inside the rectangle, not the whole of it.
    held_flat : tuple of (float, float, float), m
        (x, y, radius) of places where a fitting clamps the foil.
    buttons : tuple of (float, float, float), m
        (x, y, radius) of the washers that clip the foil down.
    relief_m : float, m
        Height of the creases above the held-down foil.
    pillow_m : float, m
        Height of the bulge between seams.
    """

    low: Point
    high: Point
    facet_m: float
    seed: int
    seams: tuple[Line, ...] = ()
    hole: Circle | None = None
    is_round: bool = False
    held_flat: tuple[Circle, ...] = ()
    buttons: tuple[Circle, ...] = ()
    relief_m: float = 0.016
    pillow_m: float = 0.006

    @property
    def max_height_m(self) -> float:
        """No point of the foil rises above this."""
        return self.relief_m + self.pillow_m

    def foil(self) -> trimesh.Trimesh:
        """Return the foil: z from 0, where it is held, to ``max_height_m``; normals towards +z.

        Vertices are shared where it bends and split where it is creased: shade it smoothly.
        """
        edge = self._edge()
        inner, relief = self._inner_points()
        points = np.concatenate([inner, edge])
        triangles = Delaunay(points).simplices
        corners = points[triangles]
        area = 0.5 * _cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        triangles[area < 0.0] = triangles[area < 0.0][:, ::-1]
        keep = np.abs(area) > SLIVER_M2
        if self.hole is not None:
            middle = corners.mean(axis=1) - np.array(self.hole[:2])
            keep &= np.linalg.norm(middle, axis=1) > self.hole[2]
        height = np.concatenate([self._heights(inner, relief), np.zeros(len(edge))])
        return creased(mesh_of(np.column_stack([points, height]), triangles[keep]), CREASE_DEG)

    def tape(self) -> trimesh.Trimesh:
        """Return the strips that close the seams, a millimetre above the foil held by them."""
        return joined(
            _strip(np.array(start), np.array(end), self.facet_m, self._rng(10 + number))
            for number, (start, end) in enumerate(self.seams)
        )

    @property
    def _corners(self) -> tuple[Floats, Floats]:
        return np.array(self.low), np.array(self.high)

    def _rng(self, purpose: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, purpose])

    def _edge(self) -> Floats:
        """Return the points on the outline and on the hole's rim, (n, 2) m."""
        low, high = self._corners
        if self.is_round:
            edge = _circle(0.5 * (low + high), 0.5 * float((high - low).min()), self.facet_m)
        else:
            edge = _rectangle(low, high, self.facet_m)
        if self.hole is None:
            return edge
        rim = _circle(np.array(self.hole[:2]), self.hole[2], self.facet_m)
        return np.concatenate([edge, rim])

    def _inner_points(self) -> tuple[Floats, Floats]:
        """Return the vertices inside the outline, on creases and between them, and their relief."""
        folds = [self._folds(purpose, size) for purpose, size in enumerate(FOLD_FACETS)]
        low, high = self._corners
        creases = [fold.crease_points(0.9 * self.facet_m) for fold in folds]
        between = _scattered(low, high, self.facet_m, self._rng(2))
        points = _thinned(np.concatenate([*creases, between]), APART * self.facet_m)
        points = points[self._inside(points)]
        relief = RELIEF_SHARES[-1] * self._rng(3).random(len(points))
        for share, fold in zip(RELIEF_SHARES[:-1], folds, strict=True):
            relief += share * fold.level_at(points)
        return points, relief

    def _folds(self, purpose: int, size: float) -> _Folds:
        """Return creases of ``size`` times the mesh's own, beyond the outline on all sides."""
        spacing = size * self.facet_m
        low, high = self._corners
        rng = self._rng(purpose)
        knots = _scattered(low - 2.0 * spacing, high + 2.0 * spacing, spacing, rng)
        return _Folds(Delaunay(knots), rng.random(len(knots)))

    def _inside(self, points: Floats) -> AnyArray:
        """Tell which points lie inside the outline, off its edge by half a facet."""
        low, high = self._corners
        margin = 0.5 * self.facet_m
        inside = (np.minimum(points - low, high - points) > margin).all(axis=1)
        if self.is_round:
            radius = 0.5 * float((high - low).min())
            inside &= np.linalg.norm(points - 0.5 * (low + high), axis=1) < radius - margin
        if self.hole is not None:
            centre = np.array(self.hole[:2])
            inside &= np.linalg.norm(points - centre, axis=1) > self.hole[2] + margin
        return np.asarray(inside)

    def _heights(self, points: Floats, relief: Floats) -> Floats:
        """Return the foil's height, (n,) m, from the creases' relief, 0 to 1."""
        loose = self._looseness(points)
        return np.asarray(loose * self.relief_m * relief + loose**2 * self.pillow_m)

    def _looseness(self, points: Floats) -> Floats:
        """Return 0 where the foil is held down, 1 where it is free, (n,)."""
        low, high = self._corners
        free_m = np.minimum(points - low, high - points).min(axis=1)
        if self.is_round:
            from_centre = np.linalg.norm(points - 0.5 * (low + high), axis=1)
            free_m = 0.5 * float((high - low).min()) - from_centre
        for start, end in self.seams:
            gap = _segment_distance(points, np.array(start), np.array(end))
            free_m = np.minimum(free_m, gap - 0.5 * TAPE_WIDTH_M)
        holds = (*self.held_flat, *self.buttons, *([self.hole] if self.hole else []))
        for x, y, radius in holds:
            free_m = np.minimum(free_m, np.linalg.norm(points - np.array([x, y]), axis=1) - radius)
        return np.asarray(np.clip(free_m / HOLD_M, 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class _Folds:
    """A random triangulation and the level, 0 to 1, of each of its points: a sheet of creases."""

    sheet: Delaunay
    level: Floats

    def crease_points(self, pitch_m: float) -> Floats:
        """Return the points of the triangulation and others along its edges, (n, 2) m."""
        sides = self.sheet.simplices[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        start, end = np.moveaxis(self.sheet.points[np.unique(np.sort(sides), axis=0)], 1, 0)
        count = np.maximum(np.round(np.linalg.norm(end - start, axis=1) / pitch_m).astype(int), 1)
        edge = np.repeat(np.arange(len(count)), count - 1)
        step = np.arange(len(edge)) - np.repeat(np.cumsum(count - 1) - (count - 1), count - 1) + 1
        share = (step / count[edge])[:, None]
        return np.concatenate([self.sheet.points, start[edge] + share * (end - start)[edge]])

    def level_at(self, points: Floats) -> Floats:
        """Return the level at points inside, (n,), linear on each facet.

        ``Delaunay.find_simplex`` would serve, but inverts one tiny matrix per facet by LAPACK,
        which threads of a busy machine turn from milliseconds into many seconds.
        """
        corners = self.sheet.points[self.sheet.simplices]
        centres = corners.mean(axis=1)
        reach = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1) * (1.0 + 1e-9)
        near = cKDTree(points).query_ball_point(centres, reach)
        facet = np.repeat(np.arange(len(near)), [len(found) for found in near])
        which = np.concatenate([np.asarray(found, dtype=np.int64) for found in near])
        a, b, c = np.moveaxis(corners[facet] - points[which][:, None], 1, 0)
        weights = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], axis=-1)
        weights /= weights.sum(axis=1, keepdims=True)
        inside = (weights >= -1e-9).all(axis=1)
        level = np.full(len(points), np.nan)
        level[which[inside]] = (weights * self.level[self.sheet.simplices[facet]]).sum(axis=1)[
            inside
        ]
        return level


def _scattered(low: Floats, high: Floats, spacing_m: float, rng: np.random.Generator) -> Floats:
    """Return one random point in each cell of a grid over the rectangle, (n, 2) m, some dropped.

    Anywhere in its cell: neighbours lie from a third to twice the spacing apart.
    """
    counts = np.maximum(np.round((high - low) / spacing_m).astype(int), 1)
    grid = np.stack(np.meshgrid(*[np.arange(n) for n in counts], indexing="ij"), axis=-1)
    cells = grid.reshape(-1, 2)
    points = low + (cells + rng.uniform(0.0, 1.0, cells.shape)) * (high - low) / counts
    return _thinned(points, 0.33 * spacing_m)


def _thinned(points: Floats, apart_m: float) -> Floats:
    """Drop each point that is nearer than ``apart_m`` to an earlier one."""
    pairs = cKDTree(points).query_pairs(apart_m, output_type="ndarray")
    keep = np.ones(len(points), dtype=bool)
    keep[pairs.max(axis=1)] = False
    return np.asarray(points[keep])


def _cross(first: Floats, second: Floats) -> Floats:
    """Return the cross products of plane vectors, (n,)."""
    return np.asarray(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])


def _rectangle(low: Floats, high: Floats, pitch_m: float) -> Floats:
    counts = np.maximum(np.round((high - low) / pitch_m).astype(int), 1)
    x = np.linspace(low[0], high[0], counts[0] + 1)
    y = np.linspace(low[1], high[1], counts[1] + 1)[1:-1]
    sides: list[AnyArray] = [np.column_stack([x, np.full_like(x, v)]) for v in (low[1], high[1])]
    sides += [np.column_stack([np.full_like(y, v), y]) for v in (low[0], high[0])]
    return np.concatenate(sides)


def _circle(centre: Floats, radius_m: float, pitch_m: float) -> Floats:
    count = round(2.0 * np.pi * radius_m / pitch_m)
    angles = 2.0 * np.pi * np.arange(count) / count
    return np.asarray(centre + radius_m * np.stack([np.cos(angles), np.sin(angles)], axis=-1))


def _segment_distance(points: Floats, a: Floats, b: Floats) -> Floats:
    share = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - a - share[:, None] * (b - a), axis=1))


def _strip(a: Floats, b: Floats, pitch_m: float, rng: np.random.Generator) -> trimesh.Trimesh:
    """Return a strip of tape from a to b, its edges a little uneven."""
    length = float(np.linalg.norm(b - a))
    along = (b - a) / length
    side = 0.5 * TAPE_WIDTH_M * np.array([-along[1], along[0]])
    count = max(2, round(length / pitch_m))
    middle = a + np.linspace(0.0, 1.0, count + 1)[:, None] * (b - a)
    rise = 0.001 + 0.001 * rng.random(count + 1) + 0.0002 * rng.random((2, count + 1))
    left = np.column_stack([middle + side, rise[0]])
    right = np.column_stack([middle - side, rise[1]])
    i = np.arange(count)
    n = count + 1
    faces = [np.stack([i, i + n, i + n + 1], axis=-1), np.stack([i, i + n + 1, i + 1], axis=-1)]
    return mesh_of(np.concatenate([left, right]), np.concatenate(faces))
