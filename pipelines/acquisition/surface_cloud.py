"""A known target's surface as a cloud of points: what a camera sees of it, and what the Sun lights.

Points are spread evenly over the faces that the wireframe hides with. What is nearest in each cell
of a grid is seen; the same grid, laid across the Sun's direction, tells what lies in cast shadow
(Williams 1978, "Casting curved shadows on curved surfaces"). A face has no outside: a sheet is lit
and seen from both sides, but on the side that is seen only from there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from models.arrays import Floats, Indices, Mask
from models.wireframe.wireframe import Wireframe
from pipelines.acquisition.view_sphere import directions_all_around

POINTS = 16_000
SHADOW_CELLS = 72  # across the target's diameter
MOST_SHAPES = 8
THIN = 8_000
KEPT_SUNS = 2_000  # 4.5 deg apart, for which shadows on a thin cloud are kept
CLEAR_CELLS = 2.5  # nearer than this behind what the Sun meets first a point is lit itself


@dataclass(frozen=True, eq=False)
class SurfaceCloud:
    """Points of a surface.

    Attributes
    ----------
    points : (n, 3) array, m
        In the target frame.
    normals : (n, 3) array
        Of their faces, either way.
    radius_m : float, m
        Of the farthest.
    face : (n,) array of int
        The triangle of each.
    """

    points: Floats
    normals: Floats
    radius_m: float
    face: Indices

    @property
    def is_thin(self) -> bool:
        """Whether it has so few points that shadows are kept for it from all around."""
        return len(self.points) < THIN

    def __len__(self) -> int:
        return len(self.points)


_SHAPES: dict[bytes, Wireframe] = {}


def shape_of(wireframe: Wireframe) -> Wireframe:
    """Return the same shape without finishes, the same object for the same corners and faces.

    What is kept of a shape serves whatever is told of its surfaces.

    Parameters
    ----------
    wireframe : Wireframe
    """
    parts = (wireframe.points_in_target, wireframe.triangles_in_target, *wireframe.symmetries)
    key = b"".join(np.ascontiguousarray(part).tobytes() for part in parts)
    while key not in _SHAPES and len(_SHAPES) >= MOST_SHAPES:
        del _SHAPES[next(iter(_SHAPES))]
    return _SHAPES.setdefault(key, replace(wireframe, finish=None))


@lru_cache(maxsize=8)
def surface_cloud(wireframe: Wireframe, count: int = POINTS) -> SurfaceCloud:
    """Spread points over a wireframe's faces, the same ones each time; kept in memory.

    Parameters
    ----------
    wireframe : Wireframe
    count : int
        About how many.
    """
    triangles = wireframe.triangles_in_target
    across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = 0.5 * np.linalg.norm(across, axis=1)
    share = area * (count / max(float(area.sum()), 1e-12))
    # Cumulative rounding: small faces get one of some neighbours' points, none is left out in all.
    ends = np.floor(np.cumsum(share) + 0.5).astype(np.int64)
    face = np.repeat(np.arange(len(triangles)), np.diff(np.concatenate([[0], ends])))
    u, v = _even_pairs(len(face)).T
    fold = u + v > 1.0
    u, v = np.where(fold, 1.0 - u, u), np.where(fold, 1.0 - v, v)
    corner = triangles[face]
    points = (
        corner[:, 0]
        + u[:, None] * (corner[:, 1] - corner[:, 0])
        + v[:, None] * (corner[:, 2] - corner[:, 0])
    )
    normals = across[face] / np.maximum(2.0 * area[face], 1e-12)[:, None]
    radius = float(np.linalg.norm(triangles.reshape(-1, 3), axis=1).max(initial=1e-6))
    return SurfaceCloud(points, normals, radius, face)


def _even_pairs(count: int) -> Floats:
    """Return pairs spread evenly over a square, (count, 2): Roberts's R2 sequence."""
    step = np.array([0.7548776662466927, 0.5698402909980532])
    return np.asarray((0.5 + np.arange(1, count + 1)[:, None] * step) % 1.0)


def nearest_in_cells(
    column: Indices, row: Indices, depth: Floats, width: int, height: int
) -> Indices:
    """Return the nearest point in each cell of a grid, (height * width,), -1 where there is none.

    Parameters
    ----------
    column, row : (n,) arrays of int
        Cells; outside of the grid they are left out.
    depth : (n,) array
    width, height : int
        Of the grid.
    """
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    chosen = np.flatnonzero(inside)
    cell = row[chosen] * width + column[chosen]
    nearest = np.full(width * height, np.inf)
    np.minimum.at(nearest, cell, depth[chosen])
    first = depth[chosen] == nearest[cell]
    found = np.full(width * height, -1, dtype=np.int64)
    found[cell[first]] = chosen[first]
    return found


@lru_cache(maxsize=8)
def kept_shadows(cloud: SurfaceCloud) -> tuple[Floats, Mask]:
    """Return directions all around, (s, 3), and which points each lights, (s, n); kept in memory.

    Parameters
    ----------
    cloud : SurfaceCloud
    """
    suns = directions_all_around(KEPT_SUNS)
    return suns, np.array([sunlight(cloud, sun) != 0.0 for sun in suns])


def sunlight_kept(cloud: SurfaceCloud, sun: Floats, point: Indices) -> Floats:
    """Return ``sunlight`` of some points, (k,), with cast shadows of the nearest direction kept.

    Parameters
    ----------
    cloud : SurfaceCloud
        Thin.
    sun : (3,) array
        Unit vector towards the Sun, target frame.
    point : (k,) array of int
    """
    suns, lit = kept_shadows(cloud)
    return np.where(lit[int(np.argmax(suns @ sun)), point], cloud.normals[point] @ sun, 0.0)


def sunlight(cloud: SurfaceCloud, sun: Floats) -> Floats:
    """Return the cosine at which the Sun meets each point, (n,), signed by the side of its face.

    It is zero in cast shadow, and positive where the Sun shines on the side of the normal.

    Parameters
    ----------
    cloud : SurfaceCloud
    sun : (3,) array
        Unit vector towards the Sun, target frame.
    """
    helper = np.eye(3)[int(np.argmin(np.abs(sun)))]
    right = np.cross(helper, sun)
    right /= np.linalg.norm(right)
    plane = cloud.points @ np.stack([right, np.cross(sun, right)]).T
    height = cloud.points @ sun
    cell = 2.0 * cloud.radius_m / SHADOW_CELLS
    column, row = np.floor(plane / cell + 0.5 * SHADOW_CELLS).astype(np.int64).T
    column, row = (np.clip(each, 0, SHADOW_CELLS - 1) for each in (column, row))
    top = np.full(SHADOW_CELLS * SHADOW_CELLS, -np.inf)
    np.maximum.at(top, row * SHADOW_CELLS + column, height)
    cosine = cloud.normals @ sun
    # A face that the Sun grazes falls within a cell by the tangent of its tilt.
    slope = np.sqrt(np.maximum(1.0 - cosine**2, 0.0)) / np.maximum(np.abs(cosine), 0.05)
    clear = cell * (CLEAR_CELLS + slope)
    lit = height > top[row * SHADOW_CELLS + column] - np.minimum(clear, 8.0 * cell)
    return np.where(lit, cosine, 0.0)
