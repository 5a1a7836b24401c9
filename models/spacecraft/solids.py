"""The few solids that spacecraft parts are made of: boxes, lathed bodies, tubes, prisms, tiles.

Every function returns triangles in m with normals outward. Vertices are shared only where a
surface is smooth, so that interpolated normals round a nozzle yet leave its lip sharp.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
import trimesh
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from models.arrays import AnyArray, Floats
from models.pose import RigidTransform

SHARP_DEG = 20.0  # profiles that turn by more have an edge there


def mesh_of(vertices: ArrayLike, faces: ArrayLike) -> trimesh.Trimesh:
    """Return triangles exactly as given: nothing merged, nothing dropped.

    Parameters
    ----------
    vertices : (n, 3) array, m
    faces : (f, 3) array of int
    """
    return trimesh.Trimesh(
        np.asarray(vertices, dtype=np.float64), np.asarray(faces, dtype=np.int64), process=False
    )


def joined(meshes: Iterable[trimesh.Trimesh]) -> trimesh.Trimesh:
    """Stack meshes into one."""
    pieces = list(meshes)
    starts = np.cumsum([0] + [len(piece.vertices) for piece in pieces[:-1]])
    return mesh_of(
        np.concatenate([piece.vertices for piece in pieces]),
        np.concatenate([piece.faces + start for piece, start in zip(pieces, starts, strict=True)]),
    )


def creased(mesh: trimesh.Trimesh, sharp_deg: float) -> trimesh.Trimesh:
    """Split vertices where faces turn by more than ``sharp_deg``, so that creases stay sharp.

    Faces that meet at an edge and turn by less share their vertices there, and are shaded as one
    smooth surface by interpolated normals. No vertex moves.
    """
    corners = np.arange(3 * len(mesh.faces)).reshape(-1, 3)
    soft = mesh.face_adjacency_angles <= np.deg2rad(sharp_deg)
    pairs, ends = mesh.face_adjacency[soft], mesh.face_adjacency_edges[soft]
    links = []
    for end in (0, 1):
        sides = [
            corners[pairs[:, side]][mesh.faces[pairs[:, side]] == ends[:, end, None]]
            for side in (0, 1)
        ]
        links.append(np.stack(sides))
    first, second = np.concatenate(links, axis=1)
    graph = coo_matrix((np.ones(len(first)), (first, second)), shape=(corners.size, corners.size))
    count, group = connected_components(graph, directed=False)
    vertices = np.empty((count, 3))
    vertices[group] = mesh.vertices[mesh.faces.ravel()]
    return mesh_of(vertices, group.reshape(-1, 3))


def placed(mesh: trimesh.Trimesh, body_from_part: RigidTransform) -> trimesh.Trimesh:
    """Move a mesh from its own frame into the body's."""
    return mesh_of(body_from_part @ np.asarray(mesh.vertices), mesh.faces)


def shifted(mesh: trimesh.Trimesh, offset: ArrayLike) -> trimesh.Trimesh:
    """Move a mesh by (3,) m without turning it."""
    return mesh_of(mesh.vertices + np.asarray(offset, dtype=np.float64), mesh.faces)


def standing(
    origin: ArrayLike, axis: ArrayLike, across: ArrayLike = (1.0, 0.0, 0.0)
) -> RigidTransform:
    """Return the pose of a part whose z points along ``axis`` and whose x lies near ``across``.

    Parameters
    ----------
    origin : (3,) array, m
    axis, across : (3,) arrays
        Directions in the body frame, of any length; where they are parallel, y stands in.
    """
    z = np.asarray(axis, dtype=np.float64)
    z = z / np.linalg.norm(z)
    x = np.asarray(across, dtype=np.float64)
    x = x - (x @ z) * z
    if np.linalg.norm(x) < 1e-6:
        x = np.array([0.0, 1.0, 0.0]) - z[1] * z
    x = x / np.linalg.norm(x)
    return RigidTransform(np.stack([x, np.cross(z, x), z], axis=1), np.asarray(origin, float))


def box(size: ArrayLike, centre: ArrayLike = (0.0, 0.0, 0.0)) -> trimesh.Trimesh:
    """Return a box of edge lengths ``size``, (3,) m."""
    cube = trimesh.creation.box(extents=np.asarray(size, dtype=np.float64))
    return mesh_of(cube.vertices + np.asarray(centre, dtype=np.float64), cube.faces)


def bar(start: ArrayLike, end: ArrayLike, width_m: float, depth_m: float) -> trimesh.Trimesh:
    """Return a straight bar of rectangular section between two points.

    Parameters
    ----------
    start, end : (3,) arrays, m
        Middles of its two ends.
    width_m, depth_m : float, m
        Of the section.
    """
    a, b = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    length = float(np.linalg.norm(b - a))
    return placed(box((width_m, depth_m, length)), standing(0.5 * (a + b), b - a))


def lathe(profile: ArrayLike, segments: int) -> trimesh.Trimesh:
    """Turn a profile about the z axis.

    Parameters
    ----------
    profile : (n, 2) array, m
        (radius, z) points; matter lies to the left of the way along them, so a solid's outline
        runs counter-clockwise with the radius to the right and z up.
    segments : int
        Sides of the polygon that stands for a circle.
    """
    outline = np.asarray(profile, dtype=np.float64)
    return joined(_turned(run, segments) for run in _smooth_runs(outline))


def _smooth_runs(outline: Floats) -> list[Floats]:
    """Cut a profile where it turns sharply; a closed one also where it begins."""
    steps = np.diff(outline, axis=0)
    headings = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    corners = np.flatnonzero(np.abs(np.diff(headings)) > np.deg2rad(SHARP_DEG)) + 1
    ends = [0, *corners.tolist(), len(outline) - 1]
    return [outline[a : b + 1] for a, b in pairwise(ends)]


def _turned(run: Floats, segments: int) -> trimesh.Trimesh:
    angles = 2.0 * np.pi * np.arange(segments) / segments
    radius, height = run[:, 0, None], run[:, 1, None]
    rings = np.stack(
        [
            radius * np.cos(angles),
            radius * np.sin(angles),
            np.broadcast_to(height, (len(run), segments)),
        ],
        axis=-1,
    )
    return mesh_of(rings.reshape(-1, 3), _ring_faces(len(run), segments, run[:, 0] == 0.0))


def _ring_faces(rows: int, segments: int, is_pole: AnyArray) -> AnyArray:
    """Join rows of ``segments`` vertices by triangles; at a pole one triangle per side is left."""
    j = np.arange(segments)
    following = (j + 1) % segments
    faces = []
    for row in range(rows - 1):
        a, b = row * segments + j, row * segments + following
        d, c = a + segments, b + segments
        if not is_pole[row]:
            faces.append(np.stack([a, b, c], axis=-1))
        if not is_pole[row + 1]:
            faces.append(np.stack([a, c, d], axis=-1))
    return np.concatenate(faces)


def disc(radius_m: float, z_m: float, segments: int) -> trimesh.Trimesh:
    """Return a flat disc facing +z.

    Parameters
    ----------
    radius_m, z_m : float, m
    segments : int
        Sides of the polygon that stands for the circle.
    """
    return lathe([(radius_m, z_m), (0.0, z_m)], segments)


def cylinder(radius_m: float, bottom_m: float, top_m: float, segments: int) -> trimesh.Trimesh:
    """Return a solid cylinder about the z axis.

    Parameters
    ----------
    radius_m, bottom_m, top_m : float, m
    segments : int
        Sides of the polygon that stands for the circle.
    """
    return frustum(radius_m, radius_m, bottom_m, top_m, segments)


def frustum(
    bottom_radius_m: float, top_radius_m: float, bottom_m: float, top_m: float, segments: int
) -> trimesh.Trimesh:
    """Return a solid truncated cone about the z axis.

    Parameters
    ----------
    bottom_radius_m, top_radius_m : float, m
    bottom_m, top_m : float, m
        Heights.
    segments : int
        Sides of the polygon that stands for the circle.
    """
    return lathe(
        [(0.0, bottom_m), (bottom_radius_m, bottom_m), (top_radius_m, top_m), (0.0, top_m)],
        segments,
    )


def cup(
    bottom_radius_m: float,
    top_radius_m: float,
    bottom_m: float,
    top_m: float,
    wall_m: float,
    segments: int,
) -> trimesh.Trimesh:
    """Return an open cone with a wall and a floor, such as a horn or a baffle, mouth up.

    Parameters
    ----------
    bottom_radius_m, top_radius_m : float, m
        Outside.
    bottom_m, top_m : float, m
        Heights.
    wall_m : float, m
        Thickness of the floor, and of the wall across the axis.
    segments : int
        Sides of the polygon that stands for the circle.
    """
    return lathe(
        [
            (0.0, bottom_m),
            (bottom_radius_m, bottom_m),
            (top_radius_m, top_m),
            (top_radius_m - wall_m, top_m),
            (bottom_radius_m - wall_m, bottom_m + wall_m),
            (0.0, bottom_m + wall_m),
        ],
        segments,
    )


def prism(outline: ArrayLike, bottom_m: float, top_m: float) -> trimesh.Trimesh:
    """Raise a convex counter-clockwise outline between two heights.

    Parameters
    ----------
    outline : (n, 2) array, m
    bottom_m, top_m : float, m
    """
    corners = np.asarray(outline, dtype=np.float64)
    n = len(corners)
    low = np.column_stack([corners, np.full(n, bottom_m)])
    high = np.column_stack([corners, np.full(n, top_m)])
    i = np.arange(n)
    after = (i + 1) % n
    fan = np.stack([np.zeros(n - 2, int), i[1:-1], i[2:]], axis=-1)
    return mesh_of(
        np.concatenate([low, high]),
        np.concatenate(
            [
                fan[:, ::-1],
                fan + n,
                np.stack([i, after, after + n], axis=-1),
                np.stack([i, after + n, i + n], axis=-1),
            ]
        ),
    )


def holed_square(
    half_m: float, hole_radius_m: float, bottom_m: float, top_m: float, segments: int
) -> trimesh.Trimesh:
    """Return a square plate with a round hole in its middle.

    Parameters
    ----------
    half_m : float, m
        Half the square's side.
    hole_radius_m : float, m
    bottom_m, top_m : float, m
        Heights.
    segments : int
        Sides of the polygon that stands for the hole; a multiple of 8.
    """
    angles = 2.0 * np.pi * np.arange(segments) / segments
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    square = half_m * circle / np.abs(circle).max(axis=1, keepdims=True)
    outline = [
        (hole_radius_m * circle, bottom_m),
        (square, bottom_m),
        (square, top_m),
        (hole_radius_m * circle, top_m),
        (hole_radius_m * circle, bottom_m),
    ]
    rows = [np.column_stack([xy, np.full(segments, z)]) for xy, z in outline]
    return mesh_of(np.concatenate(rows), _ring_faces(5, segments, np.zeros(5, dtype=bool)))


def hexagon(across_flats_m: float) -> Floats:
    """Return the outline of a bolt head, (6, 2) m."""
    angles = np.pi / 3.0 * np.arange(6)
    return across_flats_m / np.sqrt(3.0) * np.stack([np.cos(angles), np.sin(angles)], axis=-1)


def tube(points: ArrayLike, radius_m: float, sides: int = 8) -> trimesh.Trimesh:
    """Sweep a circle along a polyline and close its ends.

    Parameters
    ----------
    points : (n, 3) array, m
    radius_m : float, m
    sides : int
        Of the polygon that stands for the circle.
    """
    path = np.asarray(points, dtype=np.float64)
    steps = np.diff(path, axis=0)
    steps = steps / np.linalg.norm(steps, axis=1, keepdims=True)
    tangents = np.concatenate([steps[:1], steps[:-1] + steps[1:], steps[-1:]])
    angles = 2.0 * np.pi * np.arange(sides) / sides
    circle = radius_m * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(sides)])
    across = np.array([1.0, 0.0, 0.0])
    rings: list[Floats] = []
    for point, tangent in zip(path, tangents, strict=True):
        frame = standing(point, tangent, across)
        across = frame.rotation[:, 0]
        rings.append(frame @ circle)
    rows = [np.repeat(path[:1], sides, axis=0), *rings, np.repeat(path[-1:], sides, axis=0)]
    poles = np.zeros(len(rows), dtype=bool)
    poles[[0, -1]] = True
    return mesh_of(np.concatenate(rows), _ring_faces(len(rows), sides, poles))


def tiles(centres: ArrayLike, size: Sequence[float]) -> trimesh.Trimesh:
    """Return flat rectangles facing +z, edges along x and y, one per centre (n, 3) m."""
    middle = np.asarray(centres, dtype=np.float64)
    half = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.asarray(size)
    corners = middle[:, None, :] + np.column_stack([half, np.zeros(4)])
    first = 4 * np.arange(len(middle))[:, None]
    faces = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
    return mesh_of(corners.reshape(-1, 3), faces)


def cropped_tiles(centres: ArrayLike, size: Sequence[float], crop_m: float) -> trimesh.Trimesh:
    """Return ``tiles`` whose two corners at +y are cut off by ``crop_m``, as solar cells' are.

    Each is a convex hexagon of 6 vertices, in order from (-x, -y) counter-clockwise.

    Parameters
    ----------
    centres : (n, 3) array, m
    size : (float, float), m
        Along x and along y.
    crop_m : float, m
    """
    middle = np.asarray(centres, dtype=np.float64)
    x, y = 0.5 * np.asarray(size, dtype=np.float64)
    outline = np.array(
        [[-x, -y], [x, -y], [x, y - crop_m], [x - crop_m, y], [crop_m - x, y], [-x, y - crop_m]]
    )
    corners = middle[:, None, :] + np.column_stack([outline, np.zeros(6)])
    first = 6 * np.arange(len(middle))[:, None]
    fan = [[0, 1, 2], [0, 2, 5], [2, 3, 4], [2, 4, 5]]
    return mesh_of(corners.reshape(-1, 3), np.concatenate([first + np.array(f) for f in fan]))


def tilted(tops: trimesh.Trimesh, per_tile: int, tilt_deg: float, seed: int) -> trimesh.Trimesh:
    """Tilt each of some tiles facing +z about its own middle, as bonded pieces lie unevenly.

    Parameters
    ----------
    tops : trimesh.Trimesh
        Tiles of ``per_tile`` consecutive vertices each.
    per_tile : int
    tilt_deg : float
        Standard deviation of the tilt about x and about y.
    seed : int
    """
    corners = np.array(tops.vertices).reshape(-1, per_tile, 3)
    rng = np.random.default_rng(seed)
    slope = np.tan(np.deg2rad(tilt_deg)) * rng.standard_normal((len(corners), 1, 2)).clip(-2.5, 2.5)
    across = corners[..., :2] - corners[..., :2].mean(axis=1, keepdims=True)
    corners[..., 2] += (slope * across).sum(axis=-1)
    return mesh_of(corners.reshape(-1, 3), tops.faces)
