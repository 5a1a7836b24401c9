"""How a path that both ends can find is shared between them.

A path lens - x1 - x2 - ... - xk - Sun is found from the lens, the Sun sampled at xk, or from the
Sun, the lens sampled at x1. Both count, each by its share of the squared densities with which they
find it (Veach 1997, power heuristic, equation 9.14, and 10.2 for the densities). Projected to
solid angles of surfaces, the ratio of the densities is a product over the segments of what the
surfaces themselves do, times what one path from the Sun and one sample of a pixel are worth.
"""

from __future__ import annotations

from typing import Any

import drjit as dr

SAMPLES = 16.0  # of a pixel, as the shares take it; that others are traced only makes them worse
LEAST_COSINE = 1e-4


def projected(density: Any, normal: Any, direction: Any) -> Any:
    """Return a density of directions, 1/sr, as one of projected solid angle.

    Parameters
    ----------
    density : Float, 1/sr
    normal, direction : Vector3f
    """
    return density / dr.maximum(dr.abs(dr.dot(normal, direction)), LEAST_COSINE)


def share_from_lens(ratio: Any) -> Any:
    """Return what share a path counts if found from the lens.

    Parameters
    ----------
    ratio : Float
        Of the densities with which it is found, from the Sun over from the lens.
    """
    return 1.0 / (1.0 + ratio * ratio)


def share_from_sun(ratio: Any) -> Any:
    """Return what share a path counts if found from the Sun."""
    return dr.select(ratio < 1e18, 1.0 - share_from_lens(ratio), 1.0)


def lens_end(normal: Any, towards_lens: Any, distance: Any, pixel_sr: Any) -> Any:
    """Return one over the density of first surfaces, 1/m2, that a pixel's samples are.

    Parameters
    ----------
    normal, towards_lens : Vector3f
    distance : Float, m
    pixel_sr : Float, sr
        Solid angle of the pixel.
    """
    cosine = dr.maximum(dr.abs(dr.dot(normal, towards_lens)), LEAST_COSINE)
    return pixel_sr * distance * distance / (SAMPLES * cosine)
