"""Turns that carry a wireframe onto itself: an image cannot tell poses apart that differ by one."""

from __future__ import annotations

from itertools import permutations, product

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.wireframe.wireframe import Wireframe

SAMPLES = 24  # of an edge
NEAR_SHARE = 0.01  # of the radius: an edge this near to another lies on it
MOST_OFF = 0.02  # of the samples may lie elsewhere
ORDERS = (2, 3, 4, 5, 6, 8)
ALIKE = 0.02  # relative: two principal moments this near are equal
UPRIGHT = 0.98  # sine of the angle between edges that are square to each other


def symmetries_of(wireframe: Wireframe) -> tuple[Floats, ...]:
    """Return the turns about the frame's origin that carry a wireframe onto itself.

    Half turns, quarter turns and third turns of a cube along its principal axes, its frame's and
    its edges' are tried, and where two moments are equal all usual parts of a turn about the third
    principal axis.

    Parameters
    ----------
    wireframe : Wireframe

    Returns
    -------
    tuple of (3, 3) arrays
        Without the identity.
    """
    points = _samples(wireframe)
    moments, axes = np.linalg.eigh(points.T @ points)
    tree, reach = cKDTree(points), NEAR_SHARE * wireframe.radius_m
    spacing = 0.5 * wireframe.radius_m / SAMPLES
    found: list[Floats] = []
    turns = _parts_of_a_turn(moments, axes)
    for frame in (axes, np.eye(3), _edge_axes(wireframe)):
        turns += _turns_of_a_cube(frame)
    for turn in turns:
        away, _ = tree.query(points @ turn.T)
        known = any(np.trace(turn @ other.T) > 3.0 - 1e-4 for other in found)
        if not known and np.mean(np.asarray(away) > reach + spacing) <= MOST_OFF:
            found.append(turn)
    return tuple(found)


def _samples(wireframe: Wireframe) -> Floats:
    """Return points on all edges as evenly spaced, (n, 3)."""
    start, end = np.moveaxis(wireframe.points_in_target[wireframe.edges], 1, 0)
    lengths = np.linalg.norm(end - start, axis=1)
    counts = np.maximum(np.ceil(lengths / wireframe.radius_m * SAMPLES).astype(int), 2)
    rows = [
        a + np.linspace(0.0, 1.0, count)[:, None] * (b - a)
        for a, b, count in zip(start, end, counts.tolist(), strict=True)
    ]
    return np.concatenate(rows)


def _edge_axes(wireframe: Wireframe) -> Floats:
    """Return axes along the longest edge and the longest of those upright on it, (3, 3) columns."""
    start, end = np.moveaxis(wireframe.points_in_target[wireframe.edges], 1, 0)
    ways, lengths = end - start, np.linalg.norm(end - start, axis=1)
    first = ways[int(lengths.argmax())] / lengths.max()
    aside = ways - np.outer(ways @ first, first)
    upright = np.linalg.norm(aside, axis=1) > UPRIGHT * lengths
    if not upright.any():
        return np.eye(3)
    second = aside[int(np.where(upright, lengths, 0.0).argmax())]
    second = second / np.linalg.norm(second)
    return np.stack([first, second, np.cross(first, second)], axis=1)


def _turns_of_a_cube(axes: Floats) -> list[Floats]:
    """Return the 23 turns of a cube along axes, (3, 3) columns."""
    return [
        axes @ matrix @ axes.T
        for signs in product((1.0, -1.0), repeat=3)
        for order in permutations(range(3))
        for matrix in [np.diag(signs)[:, order]]
        if np.linalg.det(matrix) > 0.0 and np.trace(matrix) < 3.0
    ]


def _parts_of_a_turn(moments: Floats, axes: Floats) -> list[Floats]:
    """Return parts of a turn about each principal axis whose two moments are equal."""
    turns = []
    for k in range(3):
        one, two = moments[(k + 1) % 3], moments[(k + 2) % 3]
        if abs(one - two) <= ALIKE * max(one, two):
            turns += [
                Rotation.from_rotvec(2.0 * np.pi * part / order * axes[:, k]).as_matrix()
                for order in ORDERS
                for part in range(1, order)
            ]
    return turns
