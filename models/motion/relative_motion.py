"""The motion of one satellite in the local frame of another, on any orbit, near or far.

States are (x, y, z) in m, then their rates in m/s: of the target with respect to the chaser, in
the chaser's local frame (x radial, y along track, z normal).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import OdeSolution, solve_ivp

from models.arrays import Floats
from models.motion.clohessy_wiltshire import EARTH_MU_M3_S2
from models.motion.kepler_orbit import KeplerOrbit

RELATIVE_TOLERANCE = 1e-12
ABSOLUTE_TOLERANCE = 1e-12  # m and m/s: a picometre of tens of metres
LONGEST_STEP_S = 60.0  # the dense output is of lower order than the steps

Flow: TypeAlias = Callable[[KeplerOrbit, float, Floats], Floats]


def nonlinear_rate(orbit: KeplerOrbit, time_s: float, state: Floats) -> Floats:
    """Return the (6,) rate of a state under Kepler's attraction, without approximation.

    The difference of the two attractions loses eight digits when taken as printed; Battin's q
    takes it without loss: ``(1 + q)`` is the ratio of the two squared distances from Earth.

    Parameters
    ----------
    orbit : KeplerOrbit
        The chaser's.
    time_s : float, s
    state : (6,) array, m and m/s

    References
    ----------
    Pesce et al. 2019, equation 11; Battin, An Introduction to the Mathematics and Methods of
    Astrodynamics, 1999, section 8.4 (Encke's method).
    """
    place = state[:3]
    radius = orbit.radius_m(time_s)
    q = (2.0 * radius * place[0] + float(place @ place)) / radius**2
    cube = (1.0 + q) ** 1.5
    less = -q * (3.0 + q * (3.0 + q)) / (1.0 + cube) / cube
    pull = -EARTH_MU_M3_S2 / radius**3 * (place / cube + np.array([radius * less, 0.0, 0.0]))
    return _in_turning_frame(orbit, time_s, state, pull)


def linear_rate(orbit: KeplerOrbit, time_s: float, state: Floats) -> Floats:
    """Return the (6,) rate of a state, linear in it: what Yamanaka and Ankersen solved.

    Parameters
    ----------
    orbit : KeplerOrbit
        The chaser's.
    time_s : float, s
    state : (6,) array, m and m/s

    References
    ----------
    Yamanaka and Ankersen, New State Transition Matrix for Relative Motion on an Arbitrary
    Elliptical Orbit, 2002, equations 8 to 10.
    """
    tide = EARTH_MU_M3_S2 / orbit.radius_m(time_s) ** 3 * np.array([2.0, -1.0, -1.0])
    return _in_turning_frame(orbit, time_s, state, tide * state[:3])


def integrate(
    orbit: KeplerOrbit, state: ArrayLike, span_s: tuple[float, float], rate: Flow = nonlinear_rate
) -> OdeSolution:
    """Integrate a state over a span of time; the result is a function of time, s.

    Parameters
    ----------
    orbit : KeplerOrbit
        The chaser's.
    state : (6,) array, m and m/s
        At the span's first time.
    span_s : (float, float), s
        Earlier, then later.
    rate : callable
        ``nonlinear_rate`` or ``linear_rate``, or another of their arguments.

    Raises
    ------
    ValueError
        If the state is not six finite numbers or the span has no length.
    RuntimeError
        If the integrator gives up: the two satellites met Earth's centre.
    """
    start = np.asarray(state, dtype=np.float64)
    if start.shape != (6,) or not np.isfinite(start).all():
        raise ValueError(f"expected six finite numbers in m and m/s, got {state!r}")
    if not span_s[1] > span_s[0]:
        raise ValueError(f"expected a span of time in s, earlier then later, got {span_s}")
    found = solve_ivp(
        lambda time_s, now: rate(orbit, time_s, now),
        span_s,
        start,
        method="DOP853",
        dense_output=True,
        rtol=RELATIVE_TOLERANCE,
        atol=ABSOLUTE_TOLERANCE,
        max_step=LONGEST_STEP_S,
    )
    if not found.success or found.sol is None:
        raise RuntimeError(f"relative motion from {start} could not be integrated: {found.message}")
    return found.sol


def _in_turning_frame(orbit: KeplerOrbit, time_s: float, state: Floats, pull: Floats) -> Floats:
    x, y, _, vx, vy, _ = state
    spin, spin_up = orbit.anomaly_rate(time_s), orbit.anomaly_acceleration(time_s)
    apparent = np.array(
        [
            2.0 * spin * vy + spin_up * y + spin**2 * x,
            -2.0 * spin * vx - spin_up * x + spin**2 * y,
            0.0,
        ]
    )
    return np.concatenate([state[3:], pull + apparent])
