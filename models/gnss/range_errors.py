"""How wrong a pseudorange is before the receiver adds its noise: Table 3 of VINAG 2018.

The paper draws every error anew at every epoch, "although this is not strictly true". The honest
variant has the same sizes as Gauss-Markov processes, one a satellite: broadcast clock and ephemeris
change with hours, the ionosphere with the minutes in which an orbit crosses it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats


@dataclass(frozen=True)
class RangeErrors:
    """1 sigma and time constants of the errors of a range.

    Attributes
    ----------
    clock_m, ephemeris_m, multipath_m, ionosphere_m : float, m
        The ionosphere's is 10 below 1000 km and none above.
    correlated : bool
        Whether all but multipath last.
    broadcast_s, ionosphere_s : float, s
        How long, if they do.
    """

    clock_m: float = 1.1
    ephemeris_m: float = 0.8
    multipath_m: float = 0.2
    ionosphere_m: float = 0.0
    correlated: bool = False
    broadcast_s: float = 7200.0
    ionosphere_s: float = 600.0

    @property
    def sigma_m(self) -> float:
        """Of all of it together, m."""
        parts = (self.clock_m, self.ephemeris_m, self.multipath_m, self.ionosphere_m)
        return float(np.sqrt(np.sum(np.square(parts))))

    @property
    def white_m(self) -> float:
        """Of the part that is new at every epoch, m."""
        return self.multipath_m if self.correlated else self.sigma_m

    @property
    def lasting(self) -> tuple[tuple[float, float], ...]:
        """1 sigma in m and time constant in s of each part that lasts."""
        if not self.correlated:
            return ()
        broadcast = (float(np.hypot(self.clock_m, self.ephemeris_m)), self.broadcast_s)
        ionosphere = (self.ionosphere_m, self.ionosphere_s)
        return (broadcast, ionosphere) if self.ionosphere_m > 0.0 else (broadcast,)


class LastingErrors:
    """The errors of every satellite's range that last, in as many runs as there are.

    Parameters
    ----------
    errors : RangeErrors
    """

    def __init__(self, errors: RangeErrors) -> None:
        self._parts = errors.lasting
        self._now: list[Floats] = []

    def after(self, duration_s: float, draws: Floats) -> Floats:
        """Return the errors some time after the last ones, (runs, satellites), m.

        Parameters
        ----------
        duration_s : float, s
            At the first call it has no meaning.
        draws : (parts, runs, satellites) array
            Standard normal; as many parts as ``RangeErrors.lasting`` has, at least.
        """
        first = not self._now
        for place, (sigma_m, time_s) in enumerate(self._parts):
            if first:
                self._now.append(sigma_m * draws[place])
                continue
            left = np.exp(-duration_s / time_s)
            fresh = sigma_m * np.sqrt(1.0 - left**2)
            self._now[place] = left * self._now[place] + fresh * draws[place]
        return np.sum(self._now, axis=0) if self._now else np.zeros(draws.shape[1:])
