"""A receiver's clock: bias and drift, and the noise of its oscillator.

References
----------
R. G. Brown and P. Y. C. Hwang, Introduction to Random Signals and Applied Kalman Filtering: the
two-state clock; Allan parameters of a temperature-compensated crystal. The first bias and drift:
VINAG 2018, section 5.2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.gnss.tracking_noise import SPEED_OF_LIGHT_M_S


@dataclass(frozen=True)
class ReceiverClock:
    """A clock.

    Attributes
    ----------
    bias_s, drift : float, s and s/s
        At the start.
    h0, h_minus_2 : float, s and 1/s
        Of white and of random-walk frequency noise.
    """

    bias_s: float = 0.3
    drift: float = 6e-6
    h0: float = 2e-19
    h_minus_2: float = 2e-20

    def at_start(self, runs: int) -> Floats:
        """Return bias and drift as ranges and rates, (runs, 2), m and m/s."""
        return np.tile(SPEED_OF_LIGHT_M_S * np.array([self.bias_s, self.drift]), (runs, 1))

    def after(self, state: Floats, duration_s: float, draws: Floats) -> Floats:
        """Return the clock some time later, (runs, 2), m and m/s.

        Parameters
        ----------
        state : (runs, 2) array, m and m/s
        duration_s : float, s
        draws : (runs, 2) array
            Standard normal.
        """
        t, squared = duration_s, SPEED_OF_LIGHT_M_S**2
        phase, frequency = 0.5 * squared * self.h0, 2.0 * np.pi**2 * squared * self.h_minus_2
        noise = np.array(
            [
                [phase * t + frequency * t**3 / 3.0, frequency * t**2 / 2.0],
                [frequency * t**2 / 2.0, frequency * t],
            ]
        )
        moved = state @ np.array([[1.0, 0.0], [t, 1.0]])
        return moved + draws @ np.linalg.cholesky(noise).T
