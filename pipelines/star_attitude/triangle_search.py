"""Triangles of spots that are triangles of the catalogue, without any idea where the camera looks.

Three sides within some arcseconds, three magnitudes and the right handedness: few triangles of
strangers pass, and whoever passes is put to the test on all other spots (``star_match``). Triangles
are taken in Mortari's order, which moves on from a false spot at once.

References
----------
D. Mortari, M. A. Samaan, C. Bruccoleri and J. L. Junkins, The pyramid star identification
technique, Navigation 51 (2004).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from models.arrays import Floats, Indices
from pipelines.star_attitude.onboard_catalogue import OnboardCatalogue
from pipelines.star_attitude.options import StarAttitudeOptions

ARCSEC = np.deg2rad(1.0 / 3600.0)
FLATTEST = 3e-4  # twice the area over the unit sphere: flatter ones have no handedness


def triangles(count: int) -> Iterator[tuple[int, int, int]]:
    """Yield all threes of so many spots: those next to each other in brightness first."""
    for second in range(1, count - 1):
        for third in range(1, count - second):
            for first in range(count - second - third):
                yield first, first + second, first + second + third


def same_triangles(
    directions: Floats,
    magnitude: Floats,
    three: tuple[int, int, int],
    catalogue: OnboardCatalogue,
    options: StarAttitudeOptions,
) -> Indices | None:
    """Return the triangles of the catalogue that are one of spots, (n, 3) rows.

    Parameters
    ----------
    directions : (m, 3) array
        Unit vectors of the spots, camera axes.
    magnitude : (m,) array
    three : tuple of 3 int
        Which of them.
    catalogue : OnboardCatalogue
    options : StarAttitudeOptions

    Returns
    -------
    (n, 3) int array, or None where the triangle is too wide, too narrow or too flat.
    """
    corners = directions[list(three)]
    sides = [float(np.linalg.norm(corners[i] - corners[j])) for i, j in ((0, 1), (0, 2), (1, 2))]
    handedness = float(np.dot(corners[0], np.cross(corners[1], corners[2])))
    if not catalogue.chord.size or abs(handedness) < FLATTEST:
        return None
    if min(sides) < catalogue.chord[0] or max(sides) > catalogue.chord[-1]:
        return None
    tolerance = options.side_arcsec * ARCSEC
    as_bright = np.abs(catalogue.magnitude[:, None] - magnitude[list(three)])
    fits = as_bright <= options.magnitude_tolerance
    first, second = catalogue.pairs(sides[0], tolerance)
    kept = fits[first, 0] & fits[second, 1]
    first, second = first[kept], second[kept]
    again, third = catalogue.pairs(sides[1], tolerance)
    kept = fits[again, 0] & fits[third, 2]
    again, third = again[kept], third[kept]
    order = np.argsort(again, kind="stable")
    low = np.searchsorted(again[order], first, side="left")
    many = np.searchsorted(again[order], first, side="right") - low
    left = np.repeat(np.arange(len(first)), many)
    within = np.arange(int(many.sum())) - np.repeat(np.cumsum(many) - many, many)
    rows = np.stack([first[left], second[left], third[order[low[left] + within]]], axis=1)
    known = catalogue.directions[rows]
    last = np.linalg.norm(known[:, 1] - known[:, 2], axis=1)
    turned = np.einsum("nk,nk->n", known[:, 0], np.cross(known[:, 1], known[:, 2]))
    same = (np.abs(last - sides[2]) < tolerance) & (np.sign(turned) == np.sign(handedness))
    return rows[same]
