"""Attitude errors as generalised Rodrigues parameters, scaled so that small ones are angles.

References
----------
J. L. Crassidis and F. L. Markley, Unscented filtering for spacecraft attitude estimation, JGCD 26
(2003), equations 29 and 30, with a = 1 and f = 4: four times the modified Rodrigues parameters.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats

SCALE = 4.0


def error_quaternion(error_rad: Floats) -> Floats:
    """Return unit quaternions, (..., 4), scalar first, of error parameters, (..., 3), rad."""
    squared = np.sum(error_rad * error_rad, axis=-1, keepdims=True)
    over = 1.0 / (SCALE**2 + squared)
    return np.concatenate([(SCALE**2 - squared) * over, 2.0 * SCALE * over * error_rad], axis=-1)


def error_parameters(quaternion: Floats) -> Floats:
    """Return error parameters, (..., 3), rad, of unit quaternions, (..., 4), of either sign."""
    sign = np.where(quaternion[..., :1] < 0.0, -1.0, 1.0)
    return SCALE * sign * quaternion[..., 1:] / (1.0 + sign * quaternion[..., :1])
