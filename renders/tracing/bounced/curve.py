"""The curve on which a brick's voxels are numbered (Morton 1966): 2 x 2 x 2 follow each other."""

from __future__ import annotations

import numpy as np

from models.arrays import AnyArray

LEVELS = 4  # voxels of 2.5, 5, 10 and 20 cm


def along_curve(x: AnyArray, y: AnyArray, z: AnyArray) -> AnyArray:
    """Return the place of voxels on the curve.

    Parameters
    ----------
    x, y, z : (...,) arrays of int
        0 to 7.

    Returns
    -------
    (...,) array of int
        0 to 511.
    """
    place = np.zeros_like(x)
    for bit in range(LEVELS - 1):
        for axis, value in enumerate((x, y, z)):
            place |= ((value >> bit) & 1) << (3 * bit + axis)
    return place
