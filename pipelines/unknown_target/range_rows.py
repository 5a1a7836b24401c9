"""Rows of distances, by what a range is taken to be to."""

from __future__ import annotations

import numpy as np

from models.arrays import Mask
from pipelines.unknown_target.arrow_equations import Solved
from pipelines.unknown_target.facet_in_sight import facet_rows
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
) -> Rows:
    """Return the rows of ranges.

    Parameters
    ----------
    where : Placed
    ranges : Ranges
        ``frame`` counts in ``where``.
    at : Unknowns
    live : (n,) bool array
        Points that are believed in.
    sigma_m : float, m
        Of the hull's corners, see ``hull_sigma_m``.
    options : BatchOptions
    px_rad : float, rad
        That a pixel covers.
    """
    if options.range_to == "centre":
        return centre_rows(where, ranges.frame, ranges.range_m, ranges.sigma_m)
    if options.range_to in ("facet", "hull"):
        rows = facet_rows(
            where, at.points, live, ranges.facets, ranges.frame, ranges.range_m, ranges.sigma_m,
            options.relief_share,
        )  # fmt: skip
        return _or_hull(where, ranges, rows, options.hull_px * px_rad)
    sigma = np.hypot(ranges.sigma_m, np.hypot(options.relief_m, sigma_m))
    return surface_rows(where, at.points, live, ranges.frame, ranges.range_m, sigma)


def _or_hull(where: Placed, ranges: Ranges, facets: Rows, sigma_rad: float) -> Rows:
    """Return the rows by the hull where it is known, else those by facets.

    The hull is carved of what the same motion places, and grows with it: a range is a share of the
    distance to the centre of mass.
    """
    known = np.isfinite(ranges.share)
    if not known.any():
        return facets
    share = np.where(known, ranges.share, 1.0)
    sigma_m = np.hypot(ranges.sigma_m, sigma_rad * ranges.range_m)
    hull = centre_rows(where, ranges.frame, ranges.range_m / share, sigma_m / share)
    pick = known[:, None, None]
    return Rows(
        np.where(pick, hull.by_shared, facets.by_shared),
        np.where(pick, hull.by_point, facets.by_point),
        np.where(known[:, None], hull.error, facets.error),
        np.where(known, hull.who, facets.who),
    )


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
