"""What a chaser believes of its own orbit: the truth and the noise of its absolute navigation."""

from __future__ import annotations

import numpy as np

from models.motion.relative_state import ChaserState

SIGMA_M = 10.0  # per axis: Pesce et al. 2019, section V.B.3
SIGMA_M_S = 0.1
CHASER_DRAW = 0x0C4A5E  # purpose, that sets these draws apart from others of the same run


def corrupted(
    chaser: ChaserState,
    *,
    seed: int,
    run: int,
    frame: int,
    sigma_m: float = SIGMA_M,
    sigma_m_s: float = SIGMA_M_S,
) -> ChaserState:
    """Return the chaser's state with Gaussian noise on each axis, fresh for every frame.

    The same (seed, run, frame) always draws the same noise, whatever was drawn before.

    Parameters
    ----------
    chaser : ChaserState
        The truth.
    seed, run, frame : int
    sigma_m : float, m
        1 sigma of the position on each inertial axis.
    sigma_m_s : float, m/s
        1 sigma of the velocity on each.
    """
    draw = np.random.default_rng([seed, run, CHASER_DRAW, frame]).standard_normal(6)
    return ChaserState(
        chaser.time_s,
        chaser.position_in_inertial + sigma_m * draw[:3],
        chaser.velocity_in_inertial + sigma_m_s * draw[3:],
    )
