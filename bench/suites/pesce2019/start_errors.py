"""The state from which tracking starts: the truth, wrong by as much as an acquisition is.

Pesce et al. 2019, section V.C, draw the start from the statistics of their Table 5, mean and
standard deviation of the size of the error, and do not say how. Here the size is the absolute value
of a Gaussian number of that mean and deviation, and the direction is uniform on the sphere. What
one image cannot tell, the two rates, starts at zero.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.motion.relative_state import RelativeState

START_DRAW = 0x57A7


@dataclass(frozen=True)
class StartErrors:
    """Statistics of an acquisition's error.

    Attributes
    ----------
    position_mean_m, position_std_m : float, m
    attitude_mean_deg, attitude_std_deg : float, deg
    """

    position_mean_m: float
    position_std_m: float
    attitude_mean_deg: float
    attitude_std_deg: float

    @property
    def sigma_m(self) -> float:
        """1 sigma per axis of the position error drawn, m."""
        return float(np.hypot(self.position_mean_m, self.position_std_m) / np.sqrt(3.0))

    @property
    def sigma_rad(self) -> float:
        """1 sigma per axis of the turn drawn, rad."""
        size_deg = np.hypot(self.attitude_mean_deg, self.attitude_std_deg)
        return float(np.deg2rad(size_deg) / np.sqrt(3.0))


def drawn_start(truth: RelativeState, errors: StartErrors, seed: int, run: int) -> RelativeState:
    """Return a start: the true position and attitude with a drawn error, and no rates.

    Parameters
    ----------
    truth : RelativeState
    errors : StartErrors
    seed, run : int
        The same pair always draws the same error.
    """
    draw = np.random.default_rng([seed, run, START_DRAW])
    position_m = abs(errors.position_mean_m + errors.position_std_m * draw.standard_normal())
    attitude_deg = abs(errors.attitude_mean_deg + errors.attitude_std_deg * draw.standard_normal())
    turn = Rotation.from_rotvec(np.deg2rad(attitude_deg) * _direction(draw))
    return RelativeState(
        time_s=truth.time_s,
        rho_in_lvlh=truth.rho_in_lvlh + position_m * _direction(draw),
        rho_dot_in_lvlh=np.zeros(3),
        R_lvlh_from_target=truth.R_lvlh_from_target @ turn.as_matrix(),
        omega_target_wrt_lvlh_in_target=np.zeros(3),
    )


def _direction(draw: np.random.Generator) -> Floats:
    vector = draw.standard_normal(3)
    return np.asarray(vector / np.linalg.norm(vector), dtype=np.float64)
