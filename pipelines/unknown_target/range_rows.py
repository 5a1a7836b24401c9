"""Rows of distances, by what a range is taken to be to."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Mask
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
    sigma_m: Floats,
    options: BatchOptions,
    px_rad: float,
) -> Rows:
    """Return the rows of ranges.

    Parameters
    ----------
    where : Placed
        All frames.
    ranges : Ranges
        ``frame`` counts in ``where``.
    at : Unknowns
    live : (n,) bool array
        Points that are believed in.
    sigma_m : (n,) array, m
        Of the points, see ``point_sigmas_m``.
    options : BatchOptions
    px_rad : float, rad
        That a pixel covers.
    """
    if options.range_to == "centre":
        return centre_rows(where, ranges.frame, ranges.range_m, ranges.sigma_m)
    if options.range_to in ("facet", "hull"):
        rows, told = facet_rows(
            where, at.points, live, ranges.facets, ranges.frame, ranges.range_m, ranges.sigma_m,
            options.relief_share,
        )  # fmt: skip
        nearest = np.where(np.isfinite(told), sigma_m[rows.who], np.inf)
        return _or_hull(where, ranges, rows, np.hypot(told, nearest), options.hull_px * px_rad)
    hull = float(np.sqrt(np.mean(sigma_m[live] ** 2))) if live.any() else 0.0
    sigma = np.hypot(ranges.sigma_m, np.hypot(options.relief_m, hull))
    return surface_rows(where, at.points, live, ranges.frame, ranges.range_m, sigma)


def _or_hull(
    where: Placed, ranges: Ranges, facets: Rows, told_m: Floats, sigma_rad: float
) -> Rows:
    """Return each row by the hull or by its facet, whichever is better known along the beam."""
    if not ranges.planes.known.any():
        return facets
    views = where.take(np.maximum(ranges.planes.view, 0))
    hull, hull_m = hull_rows(
        views, where.take(ranges.frame), ranges.planes, ranges.range_m, ranges.sigma_m, sigma_rad
    )
    better = hull_m < told_m
    pick = better[:, None, None]
    return Rows(
        np.where(pick, hull.by_shared, facets.by_shared),
        np.where(pick, hull.by_point, facets.by_point),
        np.where(better[:, None], hull.error, facets.error),
        np.where(better, hull.who, facets.who),
    )


def point_sigmas_m(solved: Solved, count: int, prior: Prior) -> Floats:
    """Return how well each point is known, (n,) m; all as before it where it lacks one.

    Parameters
    ----------
    solved : Solved
    count : int
        Of the points by now.
    prior : Prior
    """
    spread = solved.point_covariances()
    if len(spread) < count:
        return np.full(count, prior.point_information**-0.5)
    return np.asarray(np.sqrt(np.maximum(np.trace(spread, axis1=1, axis2=2), 0.0)))
