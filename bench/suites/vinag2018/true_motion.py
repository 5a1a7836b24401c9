"""Orbits that runs fly, one each, drawn from a filter's own model."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from pipelines.absolute.dynamics import carried, process_noise_factor, tides
from pipelines.absolute.error_state import ACCELERATION, POSITION, SIZE, VELOCITY
from pipelines.absolute.options import AbsoluteOptions
from renders.flight.flight import Flight

NO_TURN = np.zeros(3)


class ModelledMotion:
    """An orbit for each run, drawn from the filter's model with its process noise.

    Parameters
    ----------
    flight : Flight
        Where they all begin.
    options : AbsoluteOptions
        Of the filter.
    runs : int
    step_s : float, s
    """

    def __init__(self, flight: Flight, options: AbsoluteOptions, runs: int, step_s: float) -> None:
        self._flight, self._options, self._step_s = flight, options, step_s
        self._vector = np.zeros((runs, SIZE))
        self._vector[:, : VELOCITY.stop] = flight.orbit.states(np.zeros(1))
        self._time_s: float | None = None

    def block(self, times_s: Floats, draws: Floats) -> Floats:
        """Return the states, (runs, n, 9).

        Parameters
        ----------
        times_s : (n,) array, s
            A step apart; at the first call from zero.
        draws : (runs, n, 9) array
            Standard normal; those of the first instant of all start the acceleration left out.
        """
        own = slice(POSITION.start, ACCELERATION.stop)
        noise = process_noise_factor(self._options, self._step_s)[own, own]
        states = np.empty((len(self._vector), len(times_s), ACCELERATION.stop))
        for place, now_s in enumerate(times_s.tolist()):
            if self._time_s is None:
                self._vector[:, ACCELERATION] = self._options.left_out_m_s2 * draws[:, 0, 6:]
            else:
                tide = None
                if self._options.third_bodies:
                    bodies = self._flight.bodies(0.5 * (self._time_s + now_s))
                    tide = tides(self._vector[:, POSITION], bodies)
                still = np.broadcast_to([1.0, 0.0, 0.0, 0.0], (len(self._vector), 4))
                self._vector, _ = carried(
                    self._vector, still, NO_TURN, self._step_s, self._options, tide
                )
                self._vector[:, own] += draws[:, place] @ noise.T
            self._time_s = now_s
            states[:, place] = self._vector[:, own]
        return states
