"""The orbit that is flown, as the sensors ask for it: block after block of instants."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from models.arrays import Floats
from renders.flight.flight import Flight


class TrueMotion(Protocol):
    """Positions and velocities as time goes on."""

    def block(self, times_s: Floats, draws: Floats) -> Floats:
        """Return the next states, (runs or 1, n, 9): position, velocity, acceleration left out."""
        ...


class RealMotion:
    """One real orbit for all runs.

    Parameters
    ----------
    flight : Flight
    """

    def __init__(self, flight: Flight) -> None:
        self._flight = flight

    def block(self, times_s: Floats, draws: Floats) -> Floats:
        """Return the states, (1, n, 9); the last three are not known, and NaN.

        Parameters
        ----------
        times_s : (n,) array, s
        draws : array of any shape
            Not needed: a scalar for all it matters.
        """
        states = self._flight.orbit.states(times_s)
        return np.concatenate([states, np.full((len(states), 3), np.nan)], axis=1)[None]
