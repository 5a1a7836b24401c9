"""Turns that carry a wireframe onto itself: an image cannot tell poses apart that differ by one."""

from __future__ import annotations

from itertools import product

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


def symmetries_of(wireframe: Wireframe) -> tuple[Floats, ...]:
    """Return the turns about the frame's origin that carry a wireframe onto itself.

    Half turns and quarter turns about its principal axes are tried, and where two moments are
    equal all usual parts of a turn about the third axis.

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
    for turn in _candidates(moments, axes):
        away, _ = tree.query(points @ turn.T)
        known = any(np.trace(turn @ other.T) > 3.0 - 1e-4 for other in found)
        if not known and (away > reach + spacing).mean() <= MOST_OFF:
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


def _candidates(moments: Floats, axes: Floats) -> list[Floats]:
    """Return turns about the principal axes."""
    turns = [
        axes @ matrix @ axes.T
        for signs in product((1.0, -1.0), repeat=3)
        for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2))
        for matrix in [np.diag(signs)[:, order]]
        if np.linalg.det(matrix) > 0.0 and np.trace(matrix) < 3.0
    ]
    for k in range(3):
        one, two = moments[(k + 1) % 3], moments[(k + 2) % 3]
        if abs(one - two) <= ALIKE * max(one, two):
            turns += [
                Rotation.from_rotvec(2.0 * np.pi * part / order * axes[:, k]).as_matrix()
                for order in ORDERS
                for part in range(1, order)
            ]
    return turns
