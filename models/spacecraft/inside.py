"""Whether a point lies inside a spacecraft, where no camera can be."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.spacecraft.part import Spacecraft

INSIDE = 0.5  # between 0 outside and 1 inside; blankets with open seams give values near these


def winding_number(spacecraft: Spacecraft, point: Floats) -> float:
    """Return how often the surface encloses a point, 0 outside and 1 inside a closed part.

    Sum of the triangles' signed solid angles over 4 pi (van Oosterom and Strackee 1983; for open
    surfaces Jacobson et al. 2013).

    Parameters
    ----------
    spacecraft : Spacecraft
    point : (3,) array, m
        In the spacecraft's frame.
    """
    total = 0.0
    for part in spacecraft.parts:
        a, b, c = (part.mesh.triangles - point).transpose(1, 0, 2)
        la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
        triple = np.einsum("ij,ij->i", a, np.cross(b, c))
        below = (
            la * lb * lc
            + np.einsum("ij,ij->i", a, b) * lc
            + np.einsum("ij,ij->i", b, c) * la
            + np.einsum("ij,ij->i", c, a) * lb
        )
        total += float(np.arctan2(triple, below).sum()) / (2.0 * np.pi)
    return total


def is_inside(spacecraft: Spacecraft, point: Floats) -> bool:
    """Tell whether a point, (3,) m in the spacecraft's frame, lies inside it."""
    low, high = spacecraft.bounds
    if (point < low).any() or (point > high).any():
        return False
    return abs(winding_number(spacecraft, point)) > INSIDE
