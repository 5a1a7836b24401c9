"""The multiplicative extended Kalman filter of an attitude and a rate.

It is the baseline of the minimum-energy filter. Between images ``rotation_process`` carries it on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from pipelines.filters.kalman import update as kalman_update
from pipelines.filters.rotation_process import RotationState, skew, turn_between

_TURN_IS_SEEN = np.hstack([np.eye(3), np.zeros((3, 3))])
_NONE = np.zeros((3, 0))


@dataclass(frozen=True, eq=False)
class RotationUpdate:
    """An attitude and a rate after a measurement, and the innovation's NIS, chi2 of three."""

    state: RotationState
    nis: float


def update(
    state: RotationState, measured: Floats, noise: Floats, effect: Floats = _NONE
) -> RotationUpdate:
    """Take in a measured attitude.

    Parameters
    ----------
    state : RotationState
        Predicted.
    measured : (3, 3) array
        ``R_lvlh_from_target`` of a pose.
    noise : (3, 3) array, rad2
        Covariance of its turn in target axes, without what lasts.
    effect : (3, n) array, rad
        Of the state's n lasting errors on it.

    References
    ----------
    Lefferts, Markley and Shuster, Kalman Filtering for Spacecraft Attitude Estimation, 1982;
    Markley, Attitude Error Representations for Kalman Filtering, 2003 (the covariance follows the
    attitude that the correction turns).
    """
    innovation = turn_between(state.R_lvlh_from_target, measured)
    seen = np.hstack([_TURN_IS_SEEN, effect])
    size = 6 + len(state.lasting)
    before = np.concatenate([np.zeros(6), state.lasting])
    found = kalman_update(before, state.covariance, innovation, seen, noise)
    turned_back = np.eye(size)
    turned_back[:3, :3] -= 0.5 * skew(found.state[:3])
    covariance = turned_back @ found.covariance @ turned_back.T
    correction = found.state - before
    return RotationUpdate(state.turned(correction, covariance), found.nis)
