"""The face of a solid corner cube, where a pixel resolves it: ``models.spacecraft.corner_cube``.

A marker's point is where the apex is seen: at its depth, the middle of the aperture stands still
for every direction, and the centroid with it. So all is drawn about that point; it stays within the
disc. Edges are blurred by a quarter of a pixel, inwards, so that its samples bring next to no
noise; lines likewise.
What a pixel sees of it has the mean, over the disc, of the effective disc's share A
(``renders.tracing.retroreflector``), and is that where a pixel is larger than a part of the disc.

Written once, for Dr.Jit and NumPy: ``calc`` is the one or the other.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from models.spacecraft.corner_cube import EDGE, ROOT2, dark_lines, refracted_tangent

SOFT = 0.25  # of a pixel: edges are blurred over that
RESOLVED, UNRESOLVED = 0.12, 0.3  # blurs over the radius between which the two are blended
CENTRE = EDGE**2 * 6.0 * 3.0**0.5 / float(np.pi)  # where lines meet they were counted twice
LEAST_SHARE = 0.02  # of the disc: thinner apertures than that return next to nothing


@dataclass(frozen=True)
class CubeView:
    """Places on cubes' faces, and how large pixels are there.

    Attributes
    ----------
    x, y : arrays
        Along the face from the marker's point, over the radius.
    pixel : array
        A pixel's width there, over the radius.
    near : array
        The radius over the viewer's distance.
    """

    x: Any
    y: Any
    pixel: Any
    near: Any


def _one_if(calc: Any, condition: Any) -> Any:
    if calc is np:
        return np.where(condition, 1.0, 0.0)
    return calc.select(condition, 1.0, 0.0)


def _share(calc: Any, value: Any) -> Any:
    return calc.minimum(calc.maximum(value, 0.0), 1.0)


def _arc_cosine(calc: Any, value: Any) -> Any:
    return np.arccos(value) if calc is np else calc.acos(value)


def aperture_share(
    calc: Any, cube: CubeView, half_x: Any, half_y: Any, index: Any, effective: Any
) -> Any:
    """Return what a place of the disc returns, for a mean over the disc of ``effective``.

    Parameters
    ----------
    calc : module
        ``drjit`` or ``numpy``.
    cube : CubeView
    half_x, half_y : arrays
        Along the face, the unit vector halfway between the light's and the viewer's directions.
        The aperture's is that at the marker's point, for lamps about as far as the viewer: one
        aperture a cube, even about its middle.
    index : array
        Refractive index.
    effective : array
        The disc's active aperture for that vector.
    """
    half_z_squared = calc.maximum(1.0 - half_x * half_x - half_y * half_y, 0.0)
    half_x, half_y = half_x + cube.x * cube.near, half_y + cube.y * cube.near
    # What points from the marker's point was of length one where it came from, not there.
    length = 1.0 / calc.sqrt(calc.maximum(half_x * half_x + half_y * half_y + half_z_squared, 1e-6))
    half_x, half_y = half_x * length, half_y * length
    tx, ty = refracted_tangent(calc, half_x, half_y, index)
    ax, ay = ROOT2 * tx, ROOT2 * ty  # half of the way between the circles
    soft = SOFT * cube.pixel
    blur = calc.minimum(soft, UNRESOLVED)
    radius = 1.0 - 0.5 * blur
    squared = radius * radius
    apart_squared = calc.minimum(ax * ax + ay * ay, squared)
    apart = calc.sqrt(apart_squared) / radius
    across = calc.sqrt(calc.maximum(1.0 - apart * apart, 0.0))
    area = squared * (_arc_cosine(calc, calc.minimum(apart, 1.0)) - apart * across) * (2.0 / np.pi)
    x, y = cube.x, cube.y
    farthest = calc.sqrt(x * x + y * y + ax * ax + ay * ay + 2.0 * calc.abs(x * ax + y * ay))
    open_there = _share(calc, (1.0 - farthest) / blur)
    area = area * (1.0 + blur * blur / (12.0 * squared))  # mean over what is blurred
    half = calc.maximum(0.5 * blur, EDGE)
    edge = EDGE * _share(calc, (UNRESOLVED - 2.0 * soft) * (1.0 / RESOLVED))
    for cx, cy in dark_lines(tx, ty):
        length = 1.0 / calc.sqrt(cx * cx + cy * cy)
        cx, cy = cx * length, cy * length
        covered = _share(calc, (half + 0.5 * blur - calc.abs(x * cy - y * cx)) / blur)
        open_there = open_there * (1.0 - covered * (edge / half))
        along = calc.abs(ax * cx + ay * cy)
        reach = calc.sqrt(calc.maximum(along * along + squared - apart_squared, 0.0)) - along
        area = area - reach * edge * (4.0 / np.pi)
    area = area + CENTRE
    share = effective * open_there / calc.maximum(area, LEAST_SHARE)
    seen = (UNRESOLVED - soft) * (1.0 / (UNRESOLVED - RESOLVED))
    seen = _share(calc, seen) * _one_if(calc, area > LEAST_SHARE)
    return effective + seen * (share - effective)
