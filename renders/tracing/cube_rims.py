"""Where samples of a corner cube's face are all or nothing: its aperture's rim, its dark lines."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Mask
from models.spacecraft.corner_cube import EDGE, dark_lines, face_axes, refracted_tangent
from models.spacecraft.retroreflector_optics import FUSED_SILICA

LINE_PX = 1.0  # a pixel this near to the middle of a dark line, beside its half-width, may see it


def near_rims(
    off_centre: Floats, to_camera: Floats, normal: Floats, width: float, reach: float
) -> Mask:
    """Tell which places on a face lie near its aperture's rim or near a dark line.

    Parameters
    ----------
    off_centre : (n, 3) array
        From the marker's point, in the face's plane, over its radius; target axes.
    to_camera : (3,) array
        Unit vector from it, target axes.
    normal : (3,) array
        Of the face, target axes.
    width : float
        Of a pixel there, over the radius.
    reach : float, px
        How far beside the rim counts.

    Returns
    -------
    (n,) array of bool
    """
    first, second = face_axes(normal)
    x, y = off_centre @ first, off_centre @ second
    tx, ty = refracted_tangent(np, to_camera @ first, to_camera @ second, FUSED_SILICA)
    ax, ay = np.sqrt(2.0) * tx, np.sqrt(2.0) * ty
    farthest = np.maximum(np.hypot(x - ax, y - ay), np.hypot(x + ax, y + ay))
    near = np.abs(farthest - 1.0) < reach * width
    inside = farthest < 1.0 + reach * width
    for cx, cy in dark_lines(tx, ty):
        aside = np.abs(x * cy - y * cx) / np.hypot(cx, cy)
        near |= inside & (aside < EDGE + LINE_PX * width)
    return np.asarray(near)
