"""The stars as the sensor knows them: those to look for, pairs of bright ones, and who is crowded.

Pairs are sorted by their distance, so that all pairs of about one distance are found by two binary
searches (the k-vector of Mortari and Neta 2000 spares their logarithm, which numpy does not feel).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.spatial import cKDTree

from models.arrays import Floats, Indices, Mask
from models.camera import Camera
from models.sky.hipparcos import COMPLETE_TO_MAG, hipparcos_stars
from pipelines.star_attitude.options import StarAttitudeOptions


@dataclass(frozen=True, eq=False)
class OnboardCatalogue:
    """Stars and pairs.

    Attributes
    ----------
    numbers : (n,) int array
        In the Hipparcos catalogue, brightest first.
    directions : (n, 3) array
        Unit vectors, ICRS.
    magnitude : (n,) array
    crowded : (n,) bool array
        Whether a neighbour spoils a star's image.
    tree : cKDTree
        Of the directions.
    chord : (pairs,) array
        Distances of the unit vectors of pairs, ascending.
    first, second : (pairs,) int arrays
        Their rows.
    """

    numbers: Indices
    directions: Floats
    magnitude: Floats
    crowded: Mask
    tree: cKDTree
    chord: Floats
    first: Indices
    second: Indices

    def pairs(self, chord: float, tolerance: float) -> tuple[Indices, Indices]:
        """Return the rows of all pairs about so far apart, (n,) each, both ways round.

        Parameters
        ----------
        chord, tolerance : float
            Of unit vectors.
        """
        low, high = np.searchsorted(self.chord, [chord - tolerance, chord + tolerance])
        first, second = self.first[low:high], self.second[low:high]
        return np.concatenate([first, second]), np.concatenate([second, first])


@lru_cache(maxsize=4)
def onboard_catalogue(camera: Camera, options: StarAttitudeOptions) -> OnboardCatalogue:
    """Return the catalogue for a camera.

    Parameters
    ----------
    camera : Camera
        Its pixels decide who is crowded.
    options : StarAttitudeOptions
    """
    stars = hipparcos_stars()
    own = np.flatnonzero(stars.magnitude <= COMPLETE_TO_MAG)
    directions, magnitude = stars.directions_in_icrs[own], stars.magnitude[own]
    near = cKDTree(stars.directions_in_icrs).query_pairs(
        options.crowded_px / camera.fx, output_type="ndarray"
    )
    spoilt = np.zeros(len(stars.magnitude), dtype=np.bool_)
    for one, other in ((near[:, 0], near[:, 1]), (near[:, 1], near[:, 0])):
        fainter = stars.magnitude[other] - stars.magnitude[one]
        spoilt[one[fainter < options.crowded_mag]] = True
    crowded = spoilt[own]
    bright = np.flatnonzero((magnitude <= options.pattern_mag) & ~crowded)
    widest, narrowest = (
        2.0 * np.sin(0.5 * np.deg2rad(each)) for each in (options.widest_deg, options.narrowest_deg)
    )
    pairs = bright[cKDTree(directions[bright]).query_pairs(widest, output_type="ndarray")]
    chord = np.linalg.norm(directions[pairs[:, 0]] - directions[pairs[:, 1]], axis=1)
    order = np.argsort(chord, kind="stable")
    order = order[chord[order] >= narrowest]
    return OnboardCatalogue(
        stars.numbers[own],
        directions,
        magnitude,
        crowded,
        cKDTree(directions),
        chord[order],
        pairs[order, 0],
        pairs[order, 1],
    )
