"""What a line of sight meets: whether a spacecraft hides the Sun, and how far its surface is."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.spacecraft.part import Spacecraft


def is_hidden(spacecraft: Spacecraft, point: Floats, direction: Floats) -> bool:
    """Tell whether the ray from a point meets any triangle (Möller and Trumbore 1997).

    Parameters
    ----------
    spacecraft : Spacecraft
    point : (3,) array, m
        In the spacecraft's frame.
    direction : (3,) array
        Towards what is far away, in the spacecraft's frame.
    """
    return any(
        np.isfinite(distances(part.mesh.triangles, point, direction)).any()
        for part in spacecraft.parts
        if _meets_box(part.mesh.bounds, point, direction)
    )


def _meets_box(bounds: Floats, point: Floats, direction: Floats) -> bool:
    """Tell whether the ray meets a box, (2, 3) m, or so nearly that its triangles must say."""
    way = np.where(np.abs(direction) < 1e-12, 1e-12, direction)
    enters, leaves = np.sort((bounds - point) / way, axis=0)
    return bool(enters.max() <= leaves.min() + 1e-9 and leaves.min() >= 0.0)


def distances(triangles: Floats, point: Floats, direction: Floats) -> Floats:
    """Return how far a ray goes to each of (f, 3, 3) triangles, (f,) m; infinite where it misses.

    Parameters
    ----------
    triangles : (f, 3, 3) array, m
    point : (3,) array, m
        Where the ray begins.
    direction : (3,) array
        A unit vector; distances come in units of its length.
    """
    corner = triangles[:, 0]
    first, second = triangles[:, 1] - corner, triangles[:, 2] - corner
    across = np.cross(direction, second)
    volume = np.einsum("ij,ij->i", first, across)
    faces = np.abs(volume) > 1e-12 * np.linalg.norm(first, axis=1) * np.linalg.norm(second, axis=1)
    inverse = np.divide(1.0, volume, out=np.zeros_like(volume), where=faces)
    away = point - corner
    u = inverse * np.einsum("ij,ij->i", away, across)
    turned = np.cross(away, first)
    v = inverse * (turned @ direction)
    ahead = inverse * np.einsum("ij,ij->i", second, turned)
    met = faces & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (ahead > 0.0)
    return np.where(met, ahead, np.inf)
