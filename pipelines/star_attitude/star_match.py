"""Putting an attitude to the test: which spots stand where stars do, and whether by chance."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np

from models.arrays import Floats, Indices
from models.sky.aberration import aberrated
from pipelines.star_attitude.onboard_catalogue import OnboardCatalogue
from pipelines.star_attitude.options import StarAttitudeOptions
from pipelines.star_attitude.triangle_search import ARCSEC
from pipelines.star_attitude.wahba import wahba_attitude

DENSEST = 3.0  # times the mean density of stars, as in the Milky Way
FOUND = 3  # spots that every triangle matches by itself


@dataclass(frozen=True, eq=False)
class StarMatch:
    """Spots and the stars they are.

    Attributes
    ----------
    spots, stars : (n,) int arrays
        Rows of the spots and of the catalogue, one to one.
    cam_from_icrs : (3, 3) array
        By these, evenly weighted.
    chance : float
        Of so many spots matching at a wrong attitude.
    """

    spots: Indices
    stars: Indices
    cam_from_icrs: Floats
    chance: float


def matched(
    seen: Floats,
    first_spots: Indices,
    first_stars: Indices,
    velocity_m_s: Floats,
    catalogue: OnboardCatalogue,
    options: StarAttitudeOptions,
) -> StarMatch | None:
    """Match all spots from a first few, round after round; None if those do not hold themselves.

    Parameters
    ----------
    seen : (m, 3) array
        Unit vectors of the spots, camera axes.
    first_spots, first_stars : (k,) int arrays
        The triangle, or more.
    velocity_m_s : (3,) array, m/s
        Of the camera against the barycentre.
    catalogue : OnboardCatalogue
    options : StarAttitudeOptions
    """
    spots, stars = first_spots, first_stars
    for within_arcsec in options.match_arcsec:
        known = aberrated(catalogue.directions[stars], velocity_m_s)
        attitude = wahba_attitude(seen[spots], known, np.ones(len(spots)))
        from_sky = aberrated(seen @ attitude, -velocity_m_s)
        found = catalogue.tree.query(from_sky, distance_upper_bound=within_arcsec * ARCSEC)
        apart, nearest = (np.atleast_1d(np.asarray(each)) for each in found)
        hit = np.flatnonzero(np.isfinite(apart))
        hit = hit[np.argsort(apart[hit], kind="stable")]
        _, once = np.unique(nearest[hit], return_index=True)  # a star is one spot, the nearest
        spots = np.sort(hit[once])
        stars = nearest[spots].astype(np.int64)
        if len(spots) < FOUND:
            return None
    return StarMatch(spots, stars, attitude, _chance(len(seen), len(spots), catalogue, options))


def _chance(
    seen: int, found: int, catalogue: OnboardCatalogue, options: StarAttitudeOptions
) -> float:
    """Bound the chance that so many more spots than three match at a wrong attitude."""
    more = found - FOUND
    radius = options.match_arcsec[-1] * ARCSEC
    mean = DENSEST * len(catalogue.magnitude) * 0.25 * radius**2 * max(seen - FOUND, 0)
    return float(mean**more / factorial(more)) if more < 100 else 0.0
