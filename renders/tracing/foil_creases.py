"""Creases of crumpled foil, finer than its mesh: a field of slopes, and what it does to a lobe.

**The field** is fixed in the target's frame. Foil that was crumpled is facets on facets, flat or a
little bent, over a wide range of sizes (Blair and Kudrolli 2005, Phys. Rev. Lett. 94, 166107). At
each of three scales space is cut into cells, each the places nearest to one of a jittered grid's
points (Worley 1996, A cellular texture basis function, SIGGRAPH). Over the cell of point f the
foil's height is

    H(p) = A (FLAT g.(p - f) + BENT |p - f|^2 / (2 L)) + a constant,

g a random slope; what counts is its gradient S along the surface. Random numbers come of the
point's place in the grid (Jarzynski and Olano 2020, Hash functions for GPU rendering, JCGT 9(3),
pcg3d): nothing is kept, and every variant finds the same.

**The lobe.** A slope S leans a mirror lobe whose microfacets have density D(h) over slopes h of the
half vector. Of GGX, ``log D(h - S) = log D(h) + (4 h.S - 2 S.S) / (alpha^2 + h.h) + ...``; the lobe
is multiplied by the exponential of that, over its mean over all places. With b and k the factors of
S and -S.S, and S normal with variance s along each direction, that is

    m = (1 + 2 k s) exp(b.S - k S.S - b.b s / (2 (1 + 2 k s))).

So every pair of directions gets, on average over the surface, what the material says: foil has the
same light from near and far, and nothing is lost or won. Normals are not turned: no light leaks
through a hillside, the lobe is reciprocal, and no correction for shading normals (Veach 1997,
equation 5.19) is due.

**Footprint.** A scale whose cells a pixel does not resolve is faded out, of the slopes and of their
variance alike. What then is left of it is the roughness that the material has anyway: the normal
distribution of a pixel's footprint (Yan et al. 2014, ACM Trans. Graph. 33(4), 116) in its limit.

Written once, for Dr.Jit and NumPy: ``calc`` is the one or the other.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import mitsuba as mi
import numpy as np
from scipy.spatial.transform import Rotation

Triple = tuple[Any, Any, Any]

SEED = 2005
CELLS_M = (0.004, 0.013, 0.042)
SHARES = (0.09, 0.29, 0.62)  # of the slopes' variance
JITTER = 0.7  # of a grid's step; more, and the nearest point may lie beyond the eight looked at
FLAT, BENT = 0.86, 0.51  # roots of their shares of the variance
FLAT_SCALE, BENT_SCALE = 6.0**0.5, 0.0927**-0.5  # to variance 1: of a triangular law; measured
PIXELS_A_CELL = 3.0  # fewer, and its borders would show as noise of the samples
WIDEST_M = max(CELLS_M) / PIXELS_A_CELL  # a pixel that sees more resolves nothing
CORNERS = tuple(product((0, 1), repeat=3))


def _grid(purpose: int) -> tuple[list[Triple], list[float]]:
    """Return a grid's axes and where it starts, as Python's own floats."""
    rng = np.random.default_rng([SEED, purpose])
    axes = Rotation.random(random_state=rng).as_matrix().tolist()
    return [(x, y, z) for x, y, z in axes], rng.random(3).tolist()


GRIDS = [_grid(number) for number in range(len(CELLS_M))]


def _hashed(words: list[Any]) -> list[Any]:
    """Return three random words of three (pcg3d)."""
    x, y, z = (word * 1664525 + 1013904223 for word in words)
    for turn in range(2):
        x = x + y * z
        y = y + z * x
        z = z + x * y
        if turn == 0:
            x, y, z = (word ^ (word >> 16) for word in (x, y, z))
    return [x, y, z]


def _words(calc: Any, values: list[Any]) -> list[Any]:
    """Return whole numbers as words of 32 bits."""
    if calc is np:
        return [value.astype(np.int64).astype(np.uint32) for value in values]
    return [mi.UInt32(mi.Int32(value)) for value in values]


def _numbers(calc: Any, words: list[Any]) -> list[Any]:
    return [word.astype(np.float64) if calc is np else mi.Float(word) for word in words]


def _cell_slopes(calc: Any, place: Triple, number: int) -> list[Any]:
    """Return the slopes of one scale, of variance 1, along the grid's axes."""
    select = np.where if calc is np else calc.select
    axes, start = GRIDS[number]
    step = 1.0 / CELLS_M[number]
    at = [
        (axis[0] * place[0] + axis[1] * place[1] + axis[2] * place[2]) * step + begin
        for axis, begin in zip(axes, start, strict=True)
    ]
    low = [calc.floor(each - 0.5) for each in at]
    words = _words(calc, low)
    nearest: Any = 1e9
    found: list[Any] = []
    for corner in CORNERS:
        drawn = _hashed([word + k for word, k in zip(words, corner, strict=True)])
        jitter = _numbers(calc, [word >> 16 for word in drawn])
        off = [
            place_on - begin - (k + 0.5 - 0.5 * JITTER) - jump * (JITTER / 65536.0)
            for place_on, begin, k, jump in zip(at, low, corner, jitter, strict=True)
        ]
        distance = off[0] * off[0] + off[1] * off[1] + off[2] * off[2]
        nearer = distance < nearest
        nearest = select(nearer, distance, nearest)
        now = [*off, *drawn]
        if found:
            now = [select(nearer, a, b) for a, b in zip(now, found, strict=True)]
        found = now
    slopes = []
    for off_by, word in zip(found[:3], found[3:], strict=True):
        first, second = _numbers(calc, [word & 255, (word >> 8) & 255])
        facet = (first + second) * (FLAT * FLAT_SCALE / 255.0) - FLAT * FLAT_SCALE
        slopes.append(facet + off_by * (BENT * BENT_SCALE))
    return slopes


def crease_slopes(calc: Any, place: Triple, footprint_m: Any) -> tuple[Triple, Any]:
    """Return the creases' slopes, of variance 1 along each direction where all are resolved.

    Parameters
    ----------
    calc : module
        ``drjit`` or ``numpy``.
    place : three arrays, m
        Target frame.
    footprint_m : array
        Width of a pixel on the surface.

    Returns
    -------
    slopes : three arrays
        A vector, target frame; of it the part along the surface counts.
    variance : array
        Of what the footprint leaves.
    """
    total: list[Any] = [0.0, 0.0, 0.0]
    variance: Any = 0.0
    for number, share in enumerate(SHARES):
        ratio = footprint_m * (PIXELS_A_CELL / CELLS_M[number])
        left = calc.maximum(1.0 - ratio * ratio, 0.0)
        left = left * left
        variance = variance + share * (left * left)
        axes, _ = GRIDS[number]
        for axis, slope in zip(axes, _cell_slopes(calc, place, number), strict=True):
            scaled = slope * (left * share**0.5)
            total = [each + scaled * axis[k] for k, each in enumerate(total)]
    return (total[0], total[1], total[2]), variance


def lobe_factor(
    calc: Any, lean: Any, slope_squared: Any, creased_squared: Any, width: Any, variance: Any
) -> Any:
    """Return m, by which a place's creases change its mirror lobe.

    Parameters
    ----------
    calc : module
    lean : array
        h.S, of the half vector's slopes and the creases'.
    slope_squared, creased_squared : arrays
        h.h and S.S.
    width : array
        The lobe's, alpha squared.
    variance : array
        Of S along each direction, mean over all places.
    """
    narrow = 2.0 / (width + slope_squared)
    spread = 1.0 + 2.0 * narrow * variance
    mean = 2.0 * narrow * narrow * slope_squared * variance / spread
    return spread * calc.exp(narrow * (2.0 * lean - creased_squared) - mean)
