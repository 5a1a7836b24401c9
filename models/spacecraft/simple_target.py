"""The simple target of Volpe et al. 2017: a box with two panels, and twelve corners of it.

The drawing with the dimensions (Figure 4) and the numbers of the inertia are lost to us: a box of
2 by 2 by 2.4 m of 800 kg and two panels of 3 by 1.2 m of 25 kg each are our choice. The twelve
points (Figure 5) are the box's eight corners and the four outer corners of the panels.

Body axes are principal, the origin is the centre of mass, the panels lie along +-y.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats

BOX_M = np.array([2.0, 2.0, 2.4])
BOX_KG = 800.0
PANEL_M = np.array([1.2, 3.0, 0.03])  # x, y, z
PANEL_KG = 25.0
_SIGNS = np.array(np.meshgrid([-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0])).reshape(3, -1).T
TIP_Y_M = 0.5 * BOX_M[1] + PANEL_M[1]


def points_in_target() -> Floats:
    """Return the twelve points, (12, 3), m: the box's corners, then the panels' outer ones."""
    tips = [[x, y, 0.0] for y in (TIP_Y_M, -TIP_Y_M) for x in (-0.5 * PANEL_M[0], 0.5 * PANEL_M[0])]
    return np.concatenate([0.5 * BOX_M * _SIGNS, tips])


def points_on_box(count: int) -> Floats:
    """Return points spread over the box's faces, (count, 3), m, the same every time."""
    draw = np.random.default_rng(count)
    points = draw.uniform(-0.5, 0.5, (count, 3))
    axis = draw.integers(0, 3, count)
    points[np.arange(count), axis] = draw.choice([-0.5, 0.5], count)
    return np.asarray(points * BOX_M)


def inertia_kg_m2() -> Floats:
    """Return the inertia about the centre of mass, (3, 3), kg m2: of uniform boxes."""
    place = np.array([0.0, 0.5 * (BOX_M[1] + PANEL_M[1]), 0.0])
    off = float(place @ place) * np.eye(3) - np.outer(place, place)
    return _of_box(BOX_KG, BOX_M) + 2.0 * (_of_box(PANEL_KG, PANEL_M) + PANEL_KG * off)


def range_to_surface_m(origin_in_target: Floats, direction_in_target: Floats) -> float:
    """Return how far a ray goes before it meets the target, m; infinite where it misses.

    Parameters
    ----------
    origin_in_target : (3,) array, m
        Outside of it.
    direction_in_target : (3,) array
        Unit vector.
    """
    place = np.array([0.0, 0.5 * (BOX_M[1] + PANEL_M[1]), 0.0])
    boxes = [(np.zeros(3), BOX_M), (place, PANEL_M), (-place, PANEL_M)]
    met = [
        _entry(origin_in_target - centre, direction_in_target, 0.5 * size) for centre, size in boxes
    ]
    return min(met)


def _entry(origin: Floats, direction: Floats, half: Floats) -> float:
    """Return where a ray enters a box about the origin, by the slabs between its faces."""
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = (-half - origin) / direction, (half - origin) / direction
    enters, leaves = np.nanmax(np.minimum(one, other)), np.nanmin(np.maximum(one, other))
    missed = bool(np.any((direction == 0.0) & (np.abs(origin) > half)))
    return float(enters) if 0.0 <= enters <= leaves and not missed else float(np.inf)


def _of_box(mass_kg: float, size_m: Floats) -> Floats:
    squares = size_m**2
    return np.diag(mass_kg / 12.0 * (squares.sum() - squares))
