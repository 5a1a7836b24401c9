"""Crinkled foil on the faces of boxes, on flat panels of four corners, and round tubes.

A blanket is flat and a rectangle: here its vertices are moved onto what it wraps. The foil is held
down along all edges, so that a box's corners and edges are where its dimensions say.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product

import numpy as np
import trimesh
from numpy.typing import ArrayLike

from models.arrays import Floats
from models.spacecraft.mli_blanket import TAPE_WIDTH_M, Blanket, Circle, Line
from models.spacecraft.solids import joined, mesh_of

# The six faces of a box by name, each as outward axis and its sign.
FACES: dict[str, tuple[int, float]] = {
    f"{sign}{axis}": (index, 1.0 if sign == "+" else -1.0)
    for (index, axis), sign in product(enumerate("xyz"), "+-")
}


def face_corners(low: ArrayLike, high: ArrayLike, face: str) -> Floats:
    """Return a box face's corners, (4, 3) m, counter-clockwise seen from outside.

    Parameters
    ----------
    low, high : (3,) arrays, m
    face : str
        A key of ``FACES``: ``+x`` to ``-z``.
    """
    axis, sign = FACES[face]
    ends = np.array([low, high], dtype=np.float64)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    if sign < 0.0:
        first, second = second, first
    corners = np.empty((4, 3))
    corners[:, axis] = ends[int(sign > 0.0), axis]
    corners[:, first] = ends[[0, 1, 1, 0], first]
    corners[:, second] = ends[[0, 0, 1, 1], second]
    return corners


def rectangle_blanket(
    across_m: float,
    along_m: float,
    facet_m: float,
    seed: int,
    relief_m: float,
    seams: tuple[Line, ...] = (),
    hole: Circle | None = None,
) -> Blanket:
    """Return a blanket from (0, 0) to its size, held down and taped along its four edges.

    Parameters
    ----------
    across_m, along_m : float, m
        Size along x and along y.
    facet_m : float, m
        Of the smallest facets.
    seed : int
    relief_m : float, m
        Height of the creases; the bulge between seams adds a quarter of it.
    seams : tuple of ((float, float), (float, float)), m
        Further lines that are taped.
    hole : (float, float, float) or None, m
        (x, y, radius) of a cut-out.
    """
    t = 0.5 * TAPE_WIDTH_M
    edges: tuple[Line, ...] = (
        ((0.0, t), (across_m, t)),
        ((0.0, along_m - t), (across_m, along_m - t)),
        ((t, 0.0), (t, along_m)),
        ((across_m - t, 0.0), (across_m - t, along_m)),
    )
    return Blanket(
        (0.0, 0.0),
        (across_m, along_m),
        facet_m,
        seed,
        (*edges, *seams),
        hole,
        relief_m=relief_m,
        pillow_m=0.25 * relief_m,
    )


def on_quad(mesh: trimesh.Trimesh, size: tuple[float, float], corners: Floats) -> trimesh.Trimesh:
    """Move a mesh over a flat rectangle of ``size`` onto a flat quadrilateral.

    Parameters
    ----------
    mesh : trimesh.Trimesh
        Over x from 0 to ``size[0]`` and y from 0 to ``size[1]``; z is height.
    size : (float, float), m
    corners : (4, 3) array, m
        Counter-clockwise seen from outside; the first is (0, 0), the second lies along x.
    """
    normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
    normal /= np.linalg.norm(normal)
    u, v, height = (np.asarray(mesh.vertices) / np.array([*size, 1.0])).T[:, :, None]
    flat = (
        (1.0 - u) * (1.0 - v) * corners[0]
        + u * (1.0 - v) * corners[1]
        + u * v * corners[2]
        + (1.0 - u) * v * corners[3]
    )
    return mesh_of(flat + height * normal, mesh.faces)


def quad_foil(corners: Floats, facet_m: float, seed: int, relief_m: float) -> trimesh.Trimesh:
    """Return foil over a flat quadrilateral; see ``on_quad``.

    Parameters
    ----------
    corners : (4, 3) array, m
        Counter-clockwise seen from outside.
    facet_m : float, m
        Of the smallest facets.
    seed : int
    relief_m : float, m
        Height of the creases.
    """
    across = float(np.linalg.norm(corners[1] - corners[0]))
    along = float(np.linalg.norm(corners[3] - corners[0]))
    blanket = rectangle_blanket(across, along, facet_m, seed, relief_m)
    return on_quad(blanket.foil(), (across, along), corners)


def box_foil(
    low: ArrayLike,
    high: ArrayLike,
    facet_m: float,
    seed: int,
    relief_m: float,
    holes: Mapping[str, Circle] | None = None,
    bare: tuple[str, ...] = (),
) -> trimesh.Trimesh:
    """Return foil over a box's faces but those in ``bare``.

    Parameters
    ----------
    low, high : (3,) arrays, m
    facet_m, relief_m : float, m
        See ``Blanket``.
    seed : int
    holes : mapping of str to (float, float, float), m
        By face, a round cut-out: first and second coordinate as ``face_corners`` runs, from the
        face's first corner, and radius.
    bare : tuple of str
        Keys of ``FACES``.
    """
    pieces = []
    for number, face in enumerate(FACES):
        if face in bare:
            continue
        corners = face_corners(low, high, face)
        size = (
            float(np.linalg.norm(corners[1] - corners[0])),
            float(np.linalg.norm(corners[3] - corners[0])),
        )
        hole = (holes or {}).get(face)
        blanket = rectangle_blanket(*size, facet_m, seed + number, relief_m, hole=hole)
        pieces.append(on_quad(blanket.foil(), size, corners))
    return joined(pieces)


def tube_foil(
    radius_m: float,
    bottom_m: float,
    top_m: float,
    facet_m: float,
    seed: int,
    relief_m: float,
    seams_m: tuple[float, ...] = (),
) -> trimesh.Trimesh:
    """Return foil round a cylinder about the z axis, closed along a line at +x.

    Parameters
    ----------
    radius_m, bottom_m, top_m : float, m
        Of the cylinder that is wrapped.
    facet_m : float, m
        Of the smallest facets.
    seed : int
    relief_m : float, m
        Height of the creases.
    seams_m : tuple of float, m
        Heights, from the bottom, of the rings that hold the foil down.
    """
    around, length = 2.0 * np.pi * radius_m, top_m - bottom_m
    seams: tuple[Line, ...] = tuple(((0.0, z), (around, z)) for z in seams_m)
    blanket = rectangle_blanket(around, length, facet_m, seed, relief_m, seams)
    foil = blanket.foil()
    along, up, height = np.asarray(foil.vertices).T
    angle, radius = along / radius_m, radius_m + height
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), bottom_m + up])
    return mesh_of(points, foil.faces)
