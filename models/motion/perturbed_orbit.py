"""An orbit as it really is: in a real field under which the Earth turns, in air and light."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp

from models.arrays import Floats
from models.gravity.disturbances import SUN_MU_M3_S2, air_density, drag, solar_pressure, third_body
from models.gravity.field import earth_gravity
from models.sky.earth_rotation import earth_from_inertial
from models.sky.moon_ephemeris import MOON_MU_M3_S2, moon_position_in_inertial
from models.sky.sun_ephemeris import sun_position_in_inertial

RELATIVE_TOLERANCE, POSITION_TOLERANCE_M, SPEED_TOLERANCE_M_S = 1e-13, 1e-6, 1e-9
LONGEST_STEP_RAD = 0.0125  # of the orbit: longer ones step over the penumbra, metres a day


@dataclass(frozen=True)
class Ball:
    """A satellite as air and light meet it.

    Attributes
    ----------
    mass_kg : float, kg
    area_m2 : float, m2
        That it turns to both.
    drag_coefficient, pressure_coefficient : float
    """

    mass_kg: float
    area_m2: float
    drag_coefficient: float = 2.2
    pressure_coefficient: float = 1.3


@dataclass(frozen=True)
class Manoeuvre:
    """A constant push for a while.

    Attributes
    ----------
    start_s, end_s : float, s
    acceleration_in_lvlh : (float, float, float), m/s2
        Radial, along the track, normal.
    """

    start_s: float
    end_s: float
    acceleration_in_lvlh: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class PerturbedOrbit:
    """The motion of a satellite from a given state.

    Attributes
    ----------
    epoch : datetime
        Of time zero.
    position_m, velocity_m_s : (3,) array
        At time zero; inertial (ICRS, whose z axis is taken as the Earth's).
    duration_s : float, s
        How long it is followed.
    satellite : Ball
    degree : int
        Of the gravity field.
    manoeuvres : tuple of Manoeuvre
        One after the other.
    earth_turns : bool
        False only to show what it does: the field then stands still.
    """

    epoch: datetime
    position_m: Floats
    velocity_m_s: Floats
    duration_s: float
    satellite: Ball
    degree: int = 36
    manoeuvres: tuple[Manoeuvre, ...] = ()
    earth_turns: bool = True

    def states(self, times_s: Floats) -> Floats:
        """Return inertial positions and velocities, (n, 6), m and m/s.

        Parameters
        ----------
        times_s : (n,) array, s
            From 0 to ``duration_s``.
        """
        times_s = np.asarray(times_s, dtype=np.float64)
        found = np.empty((len(times_s), 6))
        for start_s, end_s, solution in self._pieces:
            own = (times_s >= start_s) & (times_s <= end_s)
            if own.any():
                found[own] = solution(times_s[own]).T
        return found

    def acceleration(self, time_s: float, position: Floats, velocity: Floats) -> Floats:
        """Return all of the acceleration, (3,), m/s2.

        Parameters
        ----------
        time_s : float, s
        position, velocity : (3,) array, m and m/s
        """
        sun = sun_position_in_inertial(self.epoch, time_s)
        moon = moon_position_in_inertial(self.epoch, time_s)
        turn = earth_from_inertial(self.epoch, time_s if self.earth_turns else 0.0)
        return (
            turn.T @ earth_gravity(self.degree).acceleration(turn @ position)
            + third_body(position, sun, SUN_MU_M3_S2)
            + third_body(position, moon, MOON_MU_M3_S2)
            + self.push(time_s, position, velocity, sun)
        )

    def push(self, time_s: float, position: Floats, velocity: Floats, sun: Floats) -> Floats:
        """Return what an accelerometer would feel: all but gravity, (3,), m/s2.

        Parameters
        ----------
        time_s : float, s
        position, velocity : (3,) array, m and m/s
        sun : (3,) array, m
        """
        ball = self.satellite
        area = ball.area_m2 / ball.mass_kg
        pushed = solar_pressure(position, sun, ball.pressure_coefficient * area)
        density = air_density(position, sun)
        if density > 0.0:
            pushed += drag(position, velocity, density, ball.drag_coefficient * area)
        for each in self.manoeuvres:
            if each.start_s <= time_s < each.end_s:
                pushed += lvlh_axes(position, velocity) @ np.array(each.acceleration_in_lvlh)
        return pushed

    @cached_property
    def _pieces(self) -> list[tuple[float, float, OdeSolution]]:
        return list(self._integrated())

    def _integrated(self) -> Iterator[tuple[float, float, OdeSolution]]:
        switches = {s for each in self.manoeuvres for s in (each.start_s, each.end_s)}
        inside = sorted(s for s in switches if 0.0 < s < self.duration_s)
        state = np.concatenate([self.position_m, self.velocity_m_s])
        radius = float(np.linalg.norm(self.position_m))
        rate_rad_s = float(np.linalg.norm(self.velocity_m_s)) / radius
        bounds = [0.0, *inside, self.duration_s]
        for start_s, end_s in pairwise(bounds):
            middle_s = np.nextafter(end_s, start_s)  # the push of this piece, not of the next

            def slope(time_s: float, state: Floats, last_s: float = middle_s) -> Floats:
                pull = self.acceleration(min(time_s, last_s), state[:3], state[3:])
                return np.concatenate([state[3:], pull])

            found = solve_ivp(
                slope,
                (start_s, end_s),
                state,
                method="DOP853",
                dense_output=True,
                rtol=RELATIVE_TOLERANCE,
                atol=[*3 * [POSITION_TOLERANCE_M], *3 * [SPEED_TOLERANCE_M_S]],
                max_step=LONGEST_STEP_RAD / rate_rad_s,
            )
            if not found.success or found.sol is None:
                raise RuntimeError(f"the orbit could not be integrated: {found.message}")
            state = found.y[:, -1]
            yield start_s, end_s, found.sol


def lvlh_axes(position: Floats, velocity: Floats) -> Floats:
    """Return the (3, 3) rotation whose columns are radial, along-track and normal.

    Parameters
    ----------
    position, velocity : (3,) array, m and m/s
    """
    radial = position / np.linalg.norm(position)
    normal = np.cross(position, velocity)
    normal /= np.linalg.norm(normal)
    return np.stack([radial, np.cross(normal, radial), normal], axis=1)
