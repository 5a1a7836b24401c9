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


@dataclass(frozen=True, eq=False)
class RotationUpdate:
    """An attitude and a rate after a measurement, and the innovation's NIS, chi2 of three."""

    state: RotationState
    nis: float


def update(state: RotationState, measured: Floats, noise: Floats) -> RotationUpdate:
    """Take in a measured attitude.

    Parameters
    ----------
    state : RotationState
        Predicted.
    measured : (3, 3) array
        ``R_lvlh_from_target`` of a pose.
    noise : (3, 3) array, rad2
        Covariance of its turn in target axes.

    References
    ----------
    Lefferts, Markley and Shuster, Kalman Filtering for Spacecraft Attitude Estimation, 1982;
    Markley, Attitude Error Representations for Kalman Filtering, 2003 (the covariance follows the
    attitude that the correction turns).
    """
    innovation = turn_between(state.R_lvlh_from_target, measured)
    found = kalman_update(np.zeros(6), state.covariance, innovation, _TURN_IS_SEEN, noise)
    turned_back = np.eye(6)
    turned_back[:3, :3] -= 0.5 * skew(found.state[:3])
    covariance = turned_back @ found.covariance @ turned_back.T
    return RotationUpdate(state.turned(found.state, covariance), found.nis)
