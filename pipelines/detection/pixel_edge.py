"""The signal of square pixels along the edge of a uniform disc, blurred by the lens.

A pixel whose centre lies ``d`` inside a straight edge with unit normal ``(a, b)`` sees the edge
through its own square, whose shadow along the normal is the convolution of two boxes of widths
``|a|`` and ``|b|`` (a trapezium), and through the lens, a Gaussian of ``s``. With
``H(x) = ((x^2 + s^2) Phi(x / s) + x s phi(x / s)) / 2``, the second integral of the Gaussian edge
``Phi(x / s)``, the signal is the sum of ``+-H(d +- |a| / 2 +- |b| / 2) / |a b|``. A disc's edge is
curved: across a blur of variance ``v`` it recedes by ``v / 2r`` in the mean.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from models.arrays import Floats

PIXEL_VARIANCE = 1.0 / 12.0
NARROWEST = 1e-3  # of a box: where the edge runs along the pixels, the limit is reached to 1e-6


@dataclass(frozen=True, eq=False)
class EdgeSignal:
    """The signal and its derivatives.

    Attributes
    ----------
    value : (...,) array
        From 1 well inside to 0 well outside.
    by_depth, by_blur : (...,) arrays, 1/px
        Derivatives with respect to d and s.
    """

    value: Floats
    by_depth: Floats
    by_blur: Floats


def edge_signal(
    depth: Floats, normal_x: Floats, normal_y: Floats, radius: float, blur: float
) -> EdgeSignal:
    """Evaluate the signal.

    Parameters
    ----------
    depth : (...,) array, px
        d, how far inside the edge each pixel's centre lies.
    normal_x, normal_y : (...,) arrays
        The edge's unit normal nearest to each pixel.
    radius, blur : float, px
        r and s, positive.
    """
    half_a = 0.5 * np.maximum(np.abs(normal_x), NARROWEST)
    half_b = 0.5 * np.maximum(np.abs(normal_y), NARROWEST)
    depth = depth - (blur**2 + PIXEL_VARIANCE) / (2.0 * radius)
    wide, narrow = half_a + half_b, half_a - half_b
    corners = np.stack([depth + wide, depth + narrow, depth - narrow, depth - wide])
    scaled = corners / blur
    gauss = np.exp(-0.5 * scaled**2) * (blur / np.sqrt(2.0 * np.pi))
    first = ndtr(scaled)
    second = corners * first + gauss
    third = 0.5 * (corners * second + blur**2 * first)
    share = 0.25 / (half_a * half_b)
    by_depth = (second[0] - second[1] - second[2] + second[3]) * share
    by_blur = blur * ((first[0] - first[1] - first[2] + first[3]) * share - by_depth / radius)
    value = (third[0] - third[1] - third[2] + third[3]) * share
    return EdgeSignal(value, by_depth, by_blur)
