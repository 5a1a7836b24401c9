"""How the relative position moves between two frames, and how well that is known."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.motion.clohessy_wiltshire import EARTH_MU_M3_S2
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.yamanaka_ankersen import state_transition


def transition_and_noise(
    orbit: KeplerOrbit,
    state: Floats,
    from_s: float,
    to_s: float,
    *,
    sigma_m: float,
    sigma_m_s: float,
    acceleration_m_s2: float,
) -> tuple[Floats, Floats]:
    """Return the (6, 6) transition of (rho, rho_dot) and its process noise.

    Parameters
    ----------
    orbit : KeplerOrbit
        The chaser's, as its absolute navigation has it.
    state : (6,) array, m and m/s
        Where the target is at ``from_s``.
    from_s, to_s : float, s
    sigma_m, sigma_m_s : float
        1 sigma per axis of the state that gave ``orbit``.
    acceleration_m_s2 : float, m/s2
        1 sigma of an acceleration that the model leaves out. It stays the same for about a radian
        of the orbit: white noise of that correlation time has the spectral density of its square
        times twice the time. The orbit's noise is drawn anew for every frame.
    """
    step_s = to_s - from_s
    kick = tidal_sigma(orbit, state, to_s, sigma_m, sigma_m_s)
    lever = np.array([0.5 * step_s**2, step_s])
    density = 2.0 * acceleration_m_s2**2 / orbit.anomaly_rate(to_s)
    drift = np.array([[step_s**3 / 3.0, 0.5 * step_s**2], [0.5 * step_s**2, step_s]])
    noise = np.kron(kick**2 * np.outer(lever, lever) + density * drift, np.eye(3))
    return state_transition(orbit, from_s, to_s), np.asarray(noise, dtype=np.float64)


def tidal_sigma(
    orbit: KeplerOrbit, state: Floats, time_s: float, sigma_m: float, sigma_m_s: float
) -> float:
    """Return the 1 sigma of the relative acceleration for a noisy orbit of the chaser, m/s2.

    In the local frame the target at rho is accelerated by the tide, ``mu / r^3`` times rho, and
    by the turning of the frame, at a rate and an acceleration that follow from the eccentricity
    vector: that is what the paper calls the error of the true anomaly. A velocity in error by dv
    moves this vector by ``2 dv / v``, a position by ``dr / r``; what they move is at most
    ``3 mu / r^3 |rho| + 2 (d nu / dt) |rho_dot|`` of it.

    Parameters
    ----------
    orbit : KeplerOrbit
        The chaser's.
    state : (6,) array, m and m/s
        (rho, rho_dot) of the target, local frame.
    time_s : float, s
    sigma_m, sigma_m_s : float, m and m/s
        1 sigma per axis of the state that gave ``orbit``.
    """
    radius = orbit.radius_m(time_s)
    speed = float(np.sqrt(EARTH_MU_M3_S2 * (2.0 / radius - 1.0 / orbit.semi_major_axis_m)))
    share = float(np.hypot(2.0 * sigma_m_s / speed, sigma_m / radius))
    tide = 3.0 * EARTH_MU_M3_S2 / radius**3 * float(np.linalg.norm(state[:3]))
    turning = 2.0 * orbit.anomaly_rate(time_s) * float(np.linalg.norm(state[3:]))
    return share * (tide + turning)
