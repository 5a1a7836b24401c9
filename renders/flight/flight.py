"""A flight as it really is: orbit, attitude, and the satellites that are received."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from functools import cached_property
from typing import Protocol

import numpy as np

from models.arrays import Floats
from models.gnss.constellation import Constellation
from models.gnss.reception import Receiver, Reception, reception
from models.quaternions import rotated
from models.sky.moon_ephemeris import moon_position_in_inertial
from models.sky.sun_ephemeris import sun_position_in_inertial

KNOT_S = 600.0  # between places of Sun and Moon; in between they move on straight lines, to 30 km
SETTLE_S = 120.0  # by which the truth outlasts a flight


class Orbit(Protocol):
    """Where a satellite is."""

    def states(self, times_s: Floats) -> Floats:
        """Return inertial positions and velocities, (n, 6), m and m/s, at times (n,) in s."""
        ...


class Attitude(Protocol):
    """How a satellite stands and turns."""

    def quaternions(self, times_s: Floats) -> Floats:
        """Return ``q_inertial_from_body``, (n, 4), scalar first, at times (n,) in s."""
        ...

    def rates(self, times_s: Floats) -> Floats:
        """Return the inertial rates in body axes, (n, 3), rad/s, at times (n,) in s."""
        ...


@dataclass(frozen=True, eq=False)
class Flight:
    """One flight.

    Attributes
    ----------
    epoch : datetime
        Of time zero.
    orbit : Orbit
    attitude : Attitude
    duration_s : float, s
        Both last ``SETTLE_S`` longer.
    receiver : Receiver
        Whose antenna looks along its boresight in body axes.
    constellation : Constellation
        The satellites that send.
    """

    epoch: datetime
    orbit: Orbit
    attitude: Attitude
    duration_s: float
    receiver: Receiver
    constellation: Constellation

    def bodies(self, time_s: float) -> tuple[Floats, Floats]:
        """Return where Sun and Moon are, (3,) each, m, inertial."""
        knots, sun, moon = self._ephemeris
        place = min(int(time_s / KNOT_S), len(knots) - 2)
        part = (time_s - knots[place]) / KNOT_S
        return (
            sun[place] + part * (sun[place + 1] - sun[place]),
            moon[place] + part * (moon[place + 1] - moon[place]),
        )

    def reception(self, times_s: Floats) -> Reception:
        """Return which satellites are tracked at times (m,) in s, and how well."""
        turns = self.attitude.quaternions(times_s)
        boresight = self.receiver.antenna.boresight_in_body
        boresights = rotated(turns, np.broadcast_to(boresight, (len(times_s), 3)))
        positions = self.orbit.states(times_s)[:, :3]
        knots, sun, _ = self._ephemeris
        towards = np.stack([np.interp(times_s, knots, sun[:, k]) for k in range(3)], axis=1)
        towards /= np.linalg.norm(towards, axis=1, keepdims=True)
        return reception(self.receiver, self.constellation, times_s, positions, boresights, towards)

    @cached_property
    def _ephemeris(self) -> tuple[Floats, Floats, Floats]:
        knots = np.arange(0.0, self.duration_s + SETTLE_S + 2.0 * KNOT_S, KNOT_S)
        sun = np.array([sun_position_in_inertial(self.epoch, t) for t in knots.tolist()])
        moon = np.array([moon_position_in_inertial(self.epoch, t) for t in knots.tolist()])
        return knots, sun, moon
