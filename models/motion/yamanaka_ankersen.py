"""Relative motion near any elliptic orbit, solved: the matrix of Yamanaka and Ankersen.

States are (radial, along-track, normal) positions in m, then their rates in m/s, in the turning
local frame: the axes of ``clohessy_wiltshire``, to which this comes down on a circle.
"""

from __future__ import annotations

import math

import numpy as np

from models.arrays import Floats
from models.motion.kepler_orbit import KeplerOrbit

# The authors' axes are x along track, y against the normal, z to Earth.
_YA_FROM_LVLH = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])
_IN_PLANE = np.ix_([0, 2, 3, 5], [0, 2, 3, 5])
_OUT_OF_PLANE = np.ix_([1, 4], [1, 4])


def state_transition(orbit: KeplerOrbit, from_s: float, to_s: float) -> Floats:
    """Return the (6, 6) matrix that carries a state from one time to another, earlier or later.

    Parameters
    ----------
    orbit : KeplerOrbit
        Of the satellite whose local frame it is.
    from_s, to_s : float, s

    References
    ----------
    Yamanaka and Ankersen, New State Transition Matrix for Relative Motion on an Arbitrary
    Elliptical Orbit, 2002, equations 79 to 86. ``1 + e cos(nu)`` is their rho, ``h / p^2`` their
    k squared.
    """
    e = orbit.eccentricity
    rate = orbit.momentum_m2_s / orbit.semi_latus_rectum_m**2
    start, end = orbit.true_anomaly(from_s), orbit.true_anomaly(to_s)
    fundamental = np.zeros((6, 6))
    fundamental[_IN_PLANE] = _in_plane(e, end, rate * (to_s - from_s)) @ _pseudo_initial(e, start)
    s, c = math.sin(end - start), math.cos(end - start)
    fundamental[_OUT_OF_PLANE] = [[c, s], [-s, c]]
    return _from_tilde(e, end, rate) @ fundamental @ _to_tilde(e, start, rate)


def _to_tilde(e: float, anomaly: float, rate: float) -> Floats:
    """Return what scales a state by rho and takes the anomaly for time, from local axes."""
    rho = 1.0 + e * math.cos(anomaly)
    scaled = np.zeros((6, 6))
    scaled[:3, :3] = rho * _YA_FROM_LVLH
    scaled[3:, :3] = -e * math.sin(anomaly) * _YA_FROM_LVLH
    scaled[3:, 3:] = _YA_FROM_LVLH / (rate * rho)
    return scaled


def _from_tilde(e: float, anomaly: float, rate: float) -> Floats:
    rho = 1.0 + e * math.cos(anomaly)
    back = _YA_FROM_LVLH.T
    unscaled = np.zeros((6, 6))
    unscaled[:3, :3] = back / rho
    unscaled[3:, :3] = rate * e * math.sin(anomaly) * back
    unscaled[3:, 3:] = rate * rho * back
    return unscaled


def _pseudo_initial(e: float, anomaly: float) -> Floats:
    """Return the (4, 4) inverse fundamental matrix of (x, z, x', z') at the start."""
    rho = 1.0 + e * math.cos(anomaly)
    s, c = rho * math.sin(anomaly), rho * math.cos(anomaly)
    up = 1.0 + 1.0 / rho
    return np.array(
        [
            [1.0 - e * e, 3.0 * e * (s / rho) * up, -e * s * up, 2.0 - e * c],
            [0.0, -3.0 * (s / rho) * (1.0 + e * e / rho), s * up, c - 2.0 * e],
            [0.0, -3.0 * (c / rho + e), c * up + e, -s],
            [0.0, 3.0 * rho + e * e - 1.0, -(rho**2), e * s],
        ]
    ) / (1.0 - e * e)


def _in_plane(e: float, anomaly: float, elapsed: float) -> Floats:
    """Return the (4, 4) fundamental matrix at the end; ``elapsed`` is the paper's J."""
    sin, cos = math.sin(anomaly), math.cos(anomaly)
    rho = 1.0 + e * cos
    s, c = rho * sin, rho * cos
    s_prime = cos + e * math.cos(2.0 * anomaly)
    c_prime = -(sin + e * math.sin(2.0 * anomaly))
    up = 1.0 + 1.0 / rho
    return np.array(
        [
            [1.0, -c * up, s * up, 3.0 * rho**2 * elapsed],
            [0.0, s, c, 2.0 - 3.0 * e * s * elapsed],
            [0.0, 2.0 * s, 2.0 * c - e, 3.0 * (1.0 - 2.0 * e * s * elapsed)],
            [0.0, s_prime, c_prime, -3.0 * e * (s_prime * elapsed + s / rho**2)],
        ]
    )
