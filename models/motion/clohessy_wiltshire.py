"""Relative motion near a circular orbit: the equations of Hill, Clohessy and Wiltshire, solved.

States are (radial, along-track, normal) positions in m, then velocities in m/s, of the chaser
with respect to the target in the target's rotating orbital frame: radial away from Earth,
along-track forward, normal along the orbital momentum.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from models.arrays import Floats

EARTH_MU_M3_S2 = 3.986004418e14  # EGM96, as in the IERS Conventions 2010, table 1.1
GEO_SEMI_MAJOR_AXIS_M = 42_164_000.0  # Opromolla et al. 2022, Table 4


def mean_motion(semi_major_axis_m: float) -> float:
    """Return the mean motion n of an Earth orbit, rad/s.

    Raises
    ------
    ValueError
        If the semi-major axis is not positive.
    """
    if not semi_major_axis_m > 0.0:
        raise ValueError(f"expected a semi-major axis in m above zero, got {semi_major_axis_m}")
    return float(np.sqrt(EARTH_MU_M3_S2 / semi_major_axis_m**3))


def state_transition(mean_motion_rad_s: float, time_s: float) -> Floats:
    """Return the (6, 6) matrix that carries a state over ``time_s``, which may be negative.

    References
    ----------
    Clohessy and Wiltshire 1960; in this order of axes Vallado, Fundamentals of Astrodynamics and
    Applications, section 6.8.
    """
    n, angle = mean_motion_rad_s, mean_motion_rad_s * time_s
    s, c = float(np.sin(angle)), float(np.cos(angle))
    return np.array(
        [
            [4.0 - 3.0 * c, 0.0, 0.0, s / n, 2.0 * (1.0 - c) / n, 0.0],
            [6.0 * (s - angle), 1.0, 0.0, -2.0 * (1.0 - c) / n, (4.0 * s - 3.0 * angle) / n, 0.0],
            [0.0, 0.0, c, 0.0, 0.0, s / n],
            [3.0 * n * s, 0.0, 0.0, c, 2.0 * s, 0.0],
            [-6.0 * n * (1.0 - c), 0.0, 0.0, -2.0 * s, 4.0 * c - 3.0, 0.0],
            [0.0, 0.0, -n * s, 0.0, 0.0, c],
        ]
    )


def propagate(state: ArrayLike, mean_motion_rad_s: float, time_s: float) -> Floats:
    """Return the (6,) state ``time_s`` later, no thrust and no perturbation between.

    Parameters
    ----------
    state : (6,) array, m and m/s
    mean_motion_rad_s : float, rad/s
    time_s : float, s
        May be negative.
    """
    return state_transition(mean_motion_rad_s, time_s) @ np.asarray(state, dtype=np.float64)


def state_on_closed_ellipse(
    semi_major_axis_m: float, mean_motion_rad_s: float, radial_m: float, normal_m: float = 0.0
) -> Floats:
    """Return the (6,) state on the closed 2-by-1 ellipse that comes down through the origin.

    Closed because it is centred on the target's orbit: ``radial = b sin(phi)``,
    ``along = 2 b (1 - cos(phi))``, where b is half the semi-major axis and phi falls at the mean
    motion. It crosses the target at phi = 0 along the radial, at the speed b n.

    Parameters
    ----------
    semi_major_axis_m : float, m
        Of the relative ellipse, along-track.
    mean_motion_rad_s : float, rad/s
    radial_m : float, m
        Height above the target where the state is wanted; less than half the semi-major axis.
    normal_m : float, m
        Out-of-plane offset, at the turning point of its own oscillation.

    Raises
    ------
    ValueError
        If the ellipse does not reach so high.
    """
    b, n = 0.5 * semi_major_axis_m, mean_motion_rad_s
    if not abs(radial_m) < b:
        raise ValueError(
            f"expected a height within the ellipse's semi-minor axis of {b} m, got {radial_m} m"
        )
    phi = float(np.arcsin(radial_m / b))
    along = 2.0 * b * (1.0 - np.cos(phi))
    return np.array([radial_m, along, normal_m, -b * n * np.cos(phi), -2.0 * n * radial_m, 0.0])


def state_on_inclined_ellipse(
    mean_motion_rad_s: float, radial_m: float, normal_m: float, phase_rad: float = 0.0
) -> Floats:
    """Return a (6,) state on a closed ellipse about the target, out of the orbit's plane.

    ``x = radial cos(phi), y = -2 radial sin(phi), z = normal sin(phi)``, phi rising at the mean
    motion: it never crosses the along-track axis, and drifts nowhere.

    Parameters
    ----------
    mean_motion_rad_s : float, rad/s
    radial_m : float, m
        Largest height; twice that along the track.
    normal_m : float, m
        Largest distance from the orbit's plane.
    phase_rad : float, rad
        phi of the state.
    """
    n, c, s = mean_motion_rad_s, float(np.cos(phase_rad)), float(np.sin(phase_rad))
    place = [radial_m * c, -2.0 * radial_m * s, normal_m * s]
    return np.array(
        [*place, -n * radial_m * s, -2.0 * n * radial_m * c, n * normal_m * c], dtype=np.float64
    )
