"""Simple solids as corners, edges and hiding triangles: what a wireframe is built of."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import trimesh
from numpy.typing import ArrayLike

from models.arrays import Floats, Mask
from models.pose import RigidTransform
from models.spacecraft.offset_dish import OffsetDish
from models.spacecraft.solids import mesh_of, placed
from models.wireframe.wireframe import Wireframe

DISH_SIDES = 12  # of the polygon that stands for a dish
SIGNS = (("minus", 0), ("plus", 1))


@dataclass(frozen=True, eq=False)
class Outline:
    """Named corners, the edges between them, and the faces that hide.

    Attributes
    ----------
    component : str
        What an engineer would call the piece that the corners belong to.
    names : tuple of str
    points : (n, 3) array, m
    edges : tuple of (int, int)
    triangles : (f, 3, 3) array, m
    """

    component: str
    names: tuple[str, ...]
    points: Floats
    edges: tuple[tuple[int, int], ...]
    triangles: Floats


def box_outline(name: str, low: ArrayLike, high: ArrayLike) -> Outline:
    """Return a box's 8 corners, ``{name}_plus_x_minus_y_plus_z``, 12 edges and 12 triangles.

    Parameters
    ----------
    name : str
        Of the component.
    low, high : (3,) arrays, m
        The two opposite corners.
    """
    ends = np.array([low, high], dtype=np.float64)
    choices = list(product(SIGNS, repeat=3))
    points = np.array([[ends[i, axis] for axis, (_, i) in enumerate(c)] for c in choices])
    names = tuple(
        "_".join([name, *(f"{word}_{axis}" for (word, _), axis in zip(c, "xyz", strict=True))])
        for c in choices
    )
    edges = tuple(
        (i, j)
        for i in range(8)
        for j in range(i + 1, 8)
        if sum(a != b for a, b in zip(choices[i], choices[j], strict=True)) == 1
    )
    mesh = trimesh.creation.box(bounds=ends)
    return Outline(name, names, points, edges, np.asarray(mesh.triangles, dtype=np.float64))


def sheet_outline(component: str, names: tuple[str, ...], corners: ArrayLike) -> Outline:
    """Return a flat convex sheet's corners, its rim and a fan of triangles.

    Parameters
    ----------
    component : str
    names : tuple of str
        One for each corner.
    corners : (n, 3) array, m
        In order round the rim.
    """
    points = np.asarray(corners, dtype=np.float64)
    rim = tuple((i, (i + 1) % len(points)) for i in range(len(points)))
    fan = np.array([[0, i, i + 1] for i in range(1, len(points) - 1)])
    return Outline(component, names, points, rim, points[fan])


def hiding(mesh: trimesh.Trimesh) -> Outline:
    """Return a solid that hides what is behind it and has no corners to be found."""
    return Outline("", (), np.zeros((0, 3)), (), np.asarray(mesh.triangles, dtype=np.float64))


def dish_outline(dish: OffsetDish, body_from_dish: RigidTransform) -> Outline:
    """Return an offset dish as a fan of triangles, that hides and has no corners to be found."""
    angle = 2.0 * np.pi * np.arange(DISH_SIDES) / DISH_SIDES
    x = dish.centre_x_m + 0.5 * dish.diameter_m * np.cos(angle)
    y = 0.5 * dish.diameter_m * np.sin(angle)
    rim = np.stack([x, y, dish.surface_height(x, y)], axis=-1)
    j = np.arange(DISH_SIDES)
    fan = np.stack([np.full(DISH_SIDES, DISH_SIDES), j, (j + 1) % DISH_SIDES], axis=-1)
    return hiding(placed(mesh_of(np.vstack([rim, dish.centre()]), fan), body_from_dish))


def wireframe(
    name: str, outlines: Iterable[Outline], symmetries: tuple[Floats, ...] = ()
) -> Wireframe:
    """Join outlines into a wireframe; corners of one name are one landmark.

    The appendage subset T is set by ``is_appendage``.

    Parameters
    ----------
    name : str
        The target's.
    outlines : iterable of Outline
    symmetries : tuple of (3, 3) arrays
        As ``Wireframe`` has them.
    """
    pieces = list(outlines)
    index: dict[str, int] = {}
    points: list[Floats] = []
    components: list[str] = []
    edges: list[tuple[int, int]] = []
    for piece in pieces:
        for corner, point in zip(piece.names, piece.points, strict=True):
            if corner not in index:
                index[corner] = len(points)
                points.append(point)
                components.append(piece.component)
        numbers = [index[corner] for corner in piece.names]
        edges += [(numbers[i], numbers[j]) for i, j in piece.edges]
    landmarks = np.array(points)
    return Wireframe(
        name=name,
        landmark_names=tuple(index),
        points_in_target=landmarks,
        appendage=is_appendage(landmarks, components),
        edges=np.unique(np.sort(np.array(edges, dtype=np.int64), axis=1), axis=0),
        triangles_in_target=np.concatenate([piece.triangles for piece in pieces]),
        symmetries=symmetries,
    )


def is_appendage(points: Floats, components: Sequence[str]) -> Mask:
    """Tell which landmarks are the appendage subset T of Pesce et al. 2019, section III.

    They take the landmarks of components clearly apart from the centre of mass, such as solar
    arrays and antennas, and give no rule. Ours: a component is apart when its landmarks lie on
    average farther from the centre of mass than all landmarks do, as their equation 3 has it for
    features on the image.

    Parameters
    ----------
    points : (m, 3) array, m
        From the centre of mass.
    components : sequence of str
        The component of each landmark.

    Returns
    -------
    (m,) array of bool
    """
    distance = np.linalg.norm(points, axis=1)
    of = np.array(components)
    apart = [name for name in set(components) if distance[of == name].mean() > distance.mean()]
    return np.asarray(np.isin(of, apart))
