"""Errors of what a pipeline is told: a stated offset and a seeded draw, quantity by quantity.

Every draw is keyed by run, purpose and quantity: another quantity that is drawn too changes none
that was drawn before.
"""

from __future__ import annotations

import zlib

import numpy as np

from models.arrays import Floats
from renders.scenario.told_tables import Difference, VectorDifference

TOLD_DRAW = 103  # purpose, that sets these draws apart from others of the same run
EXACT, EXACT_VECTOR = Difference(), VectorDifference()  # type: ignore[call-arg]


def drawn(run: int, quantity: str, count: int) -> Floats:
    """Return standard normal numbers that no other run or quantity shares.

    Parameters
    ----------
    run : int
    quantity : str
        Such as ``camera.fx``.
    count : int

    Returns
    -------
    (count,) array
    """
    key = [run, TOLD_DRAW, zlib.crc32(quantity.encode())]
    return np.random.default_rng(key).standard_normal(count)


def error_of(difference: Difference | None, run: int, quantity: str) -> float:
    """Return told minus true of a number in a run.

    Parameters
    ----------
    difference : Difference or None
        None where it is told as it is.
    run : int
    quantity : str
        Such as ``camera.fx``.

    Returns
    -------
    float
        In the quantity's unit.
    """
    table = difference or EXACT
    return float(table.offset + table.sigma * drawn(run, quantity, 1)[0])


def errors_of(
    difference: VectorDifference | None, run: int, quantity: str, count: int = 1
) -> Floats:
    """Return told minus true of vectors in a run.

    Parameters
    ----------
    difference : VectorDifference or None
        None where they are told as they are.
    run : int
    quantity : str
        Such as ``markers.place_m``.
    count : int
        Of vectors.

    Returns
    -------
    (count, 3) array
        In the quantity's unit.
    """
    table = difference or EXACT_VECTOR
    return np.array(table.offset) + table.sigma * drawn(run, quantity, 3 * count).reshape(-1, 3)
