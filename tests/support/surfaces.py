"""Surfaces as the one-pass kernel sees them, asked about directions in their own axes."""

from __future__ import annotations

from typing import Any

import numpy as np

from models.arrays import Floats
from renders.tracing.surfaces import Surface

BANDS = (0, 1, 2)


def seen_from(surface: Surface, towards_viewer: Floats) -> Any:
    """Return a ``SurfaceSeen`` whose normals are +z, from directions (3, n) or (3, 1)."""
    import drjit as dr
    import mitsuba as mi

    from renders.tracing.surface_table import SurfaceSeen, SurfaceTable

    table = SurfaceTable([surface], {0: 0})
    viewer = mi.Vector3f(np.ascontiguousarray(towards_viewer, dtype=np.float32))
    count = dr.width(viewer)
    up = mi.Vector3f(0.0, 0.0, 1.0) + dr.zeros(mi.Vector3f, count)
    dr.make_opaque(viewer, up)  # as a literal each angle would be a kernel of its own
    active = dr.full(mi.Bool, True, count)
    return SurfaceSeen(table, dr.zeros(mi.UInt32, count), up, up, viewer, BANDS, active)


def value(surface: Surface, towards_viewer: Floats, towards_light: Floats) -> Floats:
    """Return ``f cos`` of each band, (3, n); both directions (3, n) or (3, 1)."""
    import drjit as dr
    import mitsuba as mi

    viewer, light = np.broadcast_arrays(towards_viewer, towards_light)
    seen = seen_from(surface, viewer)
    towards = mi.Vector3f(np.ascontiguousarray(light, dtype=np.float32))
    good = seen.faces(towards)
    values = [dr.select(good, seen.value(band, towards), 0.0) for band in BANDS]
    return np.array([np.array(each, dtype=float) for each in values])


def density(surface: Surface, towards_viewer: Floats, towards_light: Floats) -> Floats:
    """Return the density with which directions are drawn, (n,), 1/sr; 0 below the surface."""
    import drjit as dr
    import mitsuba as mi

    viewer, light = np.broadcast_arrays(towards_viewer, towards_light)
    seen = seen_from(surface, viewer)
    towards = mi.Vector3f(np.ascontiguousarray(light, dtype=np.float32))
    return np.array(dr.select(seen.faces(towards), seen.density(towards), 0.0), dtype=float)


def drawn(surface: Surface, towards_viewer: Floats, square: Floats) -> tuple[Floats, Floats]:
    """Return directions (3, n), and weights of each band (3, n), from points of the square (2, n).

    The direction of the viewer is one for all, (3, 1).
    """
    import mitsuba as mi

    seen = seen_from(surface, np.broadcast_to(towards_viewer, (3, square.shape[1])))
    direction, _, weights = seen.sample(mi.Point2f(np.asarray(square, dtype=np.float32)))
    return np.array(direction, dtype=float), np.array([np.array(weights[band]) for band in BANDS])


def chi_square(surface: Surface, towards_viewer: Floats, samples: int, **resolution: int) -> Any:
    """Return Mitsuba's own chi-square test of how directions are drawn, ready to ``run``."""
    import drjit as dr
    import mitsuba as mi

    def sample(square: Any) -> tuple[Any, Any]:
        viewer = np.broadcast_to(towards_viewer, (3, dr.width(square)))
        direction, _, weights = seen_from(surface, viewer).sample(square)
        used = sum((weights[band] for band in BANDS), mi.Float(0.0)) > 0.0
        return direction, dr.select(used, 1.0, 0.0)

    def claimed(towards: Any) -> Any:
        seen = seen_from(surface, np.broadcast_to(towards_viewer, (3, dr.width(towards))))
        return dr.select(seen.faces(towards), seen.density(towards), 0.0)

    return mi.chi2.ChiSquareTest(
        domain=mi.chi2.SphericalDomain(),
        sample_func=sample,
        pdf_func=claimed,
        sample_dim=2,
        sample_count=samples,
        **resolution,
    )


def density_back(surface: Surface, towards_viewer: Floats, towards_light: Floats) -> Floats:
    """Return the density with which the viewer would be drawn from the light's side, (n,), 1/sr."""
    import mitsuba as mi

    viewer, light = np.broadcast_arrays(towards_viewer, towards_light)
    seen = seen_from(surface, viewer)
    towards = mi.Vector3f(np.ascontiguousarray(light, dtype=np.float32))
    return np.array(seen.density_back(towards), dtype=float)
