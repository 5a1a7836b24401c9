"""The face of a solid corner cube as it is seen: its aperture, and the dark edges on it.

Light that enters a cube's round face at q leaves it at the mirror image of q about the apex, which
lies ``sqrt(2) R`` under the face (Arnold 1979, Method of calculating retroreflector-array transfer
functions). About the point where the apex is seen, in units of the radius R, with t the tangent of
the refracted angle, along the face, towards the viewer:

* light comes back where two circles of radius 1 about ``+-sqrt(2) t`` overlap;
* the three edges and their images lie along ``+-(sqrt(2) u - t)``, where u are the edges'
  directions in the face, 120 degrees apart.

All of it is its own image about that point, so a centroid stands still for every direction.
Written once, for any arrays that know arithmetic: ``renders`` draws cubes by it, ``pipelines``
expects them by it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from models.arrays import Floats

EDGE = 0.012  # of the radius: half of a dark line, 0.15 mm of bevel and its image; our estimate
LINES = tuple((float(np.cos(a)), float(np.sin(a))) for a in np.deg2rad((0.0, 120.0, 240.0)))
ROOT2 = 2.0**0.5


def refracted_tangent(calc: Any, along: Any, across: Any, refractive_index: Any) -> tuple[Any, Any]:
    """Return t, the refracted direction's tangent along the face.

    Parameters
    ----------
    calc : module
        ``numpy`` or one with a ``sqrt`` of its own for the arrays given.
    along, across : arrays
        Parts along the face of the unit vector towards the viewer, outside.
    refractive_index : array
    """
    sine_squared = along * along + across * across
    inside = 1.0 / calc.sqrt(refractive_index * refractive_index - sine_squared)
    return along * inside, across * inside


def dark_lines(tx: Any, ty: Any) -> list[tuple[Any, Any]]:
    """Return where the three edges and their images run, each as ``+-(x, y)`` of any length.

    Parameters
    ----------
    tx, ty : arrays
        Of ``refracted_tangent``, the first along one edge's direction in the face.
    """
    return [(ROOT2 * ux - tx, ROOT2 * uy - ty) for ux, uy in LINES]


def face_axes(normal: Floats) -> tuple[Floats, Floats]:
    """Return two unit vectors in a face, (3,) each, the first along one of its cube's edges.

    How a cube is turned about its normal where nobody says otherwise: an edge lies over the x axis
    of the target as far as the face has it, or over -y where the face is turned to x.

    Parameters
    ----------
    normal : (3,) array
        Outward, of any length.
    """
    z = normal / np.linalg.norm(normal)
    helper = np.array([1.0, 0.0, 0.0]) if abs(z[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    y = np.cross(z, helper)
    y /= np.linalg.norm(y)
    return np.asarray(np.cross(y, z)), np.asarray(y)
