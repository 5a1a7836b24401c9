"""Faint changes of reflectance from place to place, where a pixel resolves them.

**Mottling** is a sum of bent waves over decimetres, fixed in the target's frame: dust, stains,
uneven coats. **Tiles** (solar cells, mirrors) differ from one to the next; each lies at its own
tilt (``models.spacecraft.solids.tilted``), and that says how bright it is. Both multiply by
``1 + share g``, g between -1 and 1 with mean 0, and fade out of what a pixel does not resolve.

Written once, for Dr.Jit and NumPy: ``calc`` is the one or the other.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

Triple = tuple[Any, Any, Any]

SEED = 1970
MOTTLE_M = (0.11, 0.43)  # lengths of the waves
WIDEST_M = 0.5 * max(MOTTLE_M)  # a pixel that sees more resolves nothing
BEND, BEND_LENGTH = 0.22, 2.7
TILE_M = 0.06  # size of cells and mirrors
TILE_TURNS = (231.25, 291.25, 187.25)  # periods a radian: tiles tilt by some 0.2 degrees, and
# what does not tilt from an axis, a quarter from a whole number, is neither bright nor dark


def _waves(purpose: int) -> tuple[list[Triple], list[float]]:
    rng = np.random.default_rng([SEED, purpose])
    axes = Rotation.random(random_state=rng).as_matrix().tolist()
    return [(x, y, z) for x, y, z in axes], rng.random(6).tolist()


WAVES = [_waves(number) for number in range(len(MOTTLE_M))]


def _dot(axis: Triple, place: Triple) -> Any:
    return axis[0] * place[0] + axis[1] * place[1] + axis[2] * place[2]


def _around(calc: Any, turns: Any) -> Any:
    """Return turns less their nearest whole number."""
    return turns - calc.floor(turns + 0.5)


def _wave(calc: Any, turns: Any) -> Any:
    """Return a wave of parabolas, nearly a sine."""
    around = _around(calc, turns)
    return 8.0 * around * (1.0 - 2.0 * calc.abs(around))


def _left(calc: Any, footprint_m: Any, length_m: float) -> Any:
    ratio = footprint_m * (1.0 / length_m)
    left = calc.maximum(1.0 - ratio * ratio, 0.0)
    return left * left


def shade(
    calc: Any, place: Triple, normal: Triple, footprint_m: Any, mottling: Any, tiles: Any
) -> Any:
    """Return by what a place reflects more than its mean.

    Parameters
    ----------
    calc : module
        ``drjit`` or ``numpy``.
    place : three arrays, m
        Target frame.
    normal : three arrays
        Of the triangle, unit length.
    footprint_m : array
        Width of a pixel on the surface.
    mottling, tiles : arrays
        Largest shares.
    """
    mottled: Any = 0.0
    for length_m, (axes, phases) in zip(MOTTLE_M, WAVES, strict=True):
        along = [_dot(axis, place) * (1.0 / length_m) for axis in axes]
        total: Any = 0.0
        for j in range(3):
            bent = BEND * _wave(calc, along[(j + 1) % 3] * (1.0 / BEND_LENGTH) + phases[3 + j])
            total = total + _wave(calc, along[j] + phases[j] + bent)
        mottled = mottled + total * _left(calc, footprint_m, 0.5 * length_m) * (1.0 / 6.0)
    turn = _around(calc, _dot(TILE_TURNS, normal))
    tiled = (4.0 * calc.abs(turn) - 1.0) * _left(calc, footprint_m, TILE_M)
    return (1.0 + mottling * mottled) * (1.0 + tiles * tiled)
