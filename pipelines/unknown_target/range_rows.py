"""Rows of distances, by what a range is taken to be to."""

from __future__ import annotations

import numpy as np

from models.arrays import Mask
from pipelines.unknown_target.arrow_equations import Solved
from pipelines.unknown_target.facet_in_sight import facet_rows
from pipelines.unknown_target.hull_planes import hull_rows
from pipelines.unknown_target.observation_rows import Placed, Rows, centre_rows, surface_rows
from pipelines.unknown_target.options import BatchOptions
from pipelines.unknown_target.sightings import Ranges
from pipelines.unknown_target.unknowns import Prior, Unknowns


def range_rows(
    where: Placed,
    ranges: Ranges,
    at: Unknowns,
    live: Mask,
    sigma_m: float,
    options: BatchOptions,
    px_rad: float,
) -> tuple[Rows, Rows]:
    """Return the rows of ranges by what points tell of the surface, and by the hull of outlines.

    The hull lies before the surface where that is hollow or views are few, and points behind it
    where highlights pass for them. Each has its own sigma, and where both tell, both are taken.

    Parameters
    ----------
    where : Placed
        All frames.
    ranges : Ranges
        ``frame`` counts in ``where``.
    at : Unknowns
    live : (n,) bool array
        Points that are believed in.
    sigma_m : float, m
        Of the corners of the points' hull, see ``hull_sigma_m``.
    options : BatchOptions
    px_rad : float, rad
        That a pixel covers.
    """
    if options.range_to == "centre":
        return centre_rows(where, ranges.frame, ranges.range_m, ranges.sigma_m), Rows.none()
    if options.range_to in ("facet", "hull"):
        facets = facet_rows(
            where, at.points, live, ranges.facets, ranges.frame, ranges.range_m, ranges.sigma_m,
            options.relief_share,
        )  # fmt: skip
        if not ranges.planes.known.any():
            return facets, Rows.none()
        views = where.take(np.maximum(ranges.planes.view, 0))
        hull, _ = hull_rows(
            views, where.take(ranges.frame), ranges.planes, ranges.range_m, ranges.sigma_m,
            options.hull_px * px_rad,
        )  # fmt: skip
        return facets, hull
    sigma = np.hypot(ranges.sigma_m, np.hypot(options.relief_m, sigma_m))
    rows = surface_rows(where, at.points, live, ranges.frame, ranges.range_m, sigma)
    return rows, Rows.none()


def hull_sigma_m(solved: Solved, live: Mask, prior: Prior) -> float:
    """Return how well the corners of the hull are known, m: while they are not, nor is it.

    Parameters
    ----------
    solved : Solved
    live : (n,) bool array
    prior : Prior
    """
    spread = solved.point_covariances()
    if len(spread) < len(live):
        return prior.point_information**-0.5
    own = np.trace(spread[live], axis1=1, axis2=2)
    return float(np.sqrt(np.mean(own))) if len(own) else 0.0
