"""A strapdown inertial unit: gyroscopes and accelerometers with noise and bias.

References
----------
VINAG 2018, equation 1 and section 4.1: 100 Hz, bias stability of 0.1 deg/h and 0.015 mg. The noise
is not printed: random walks of tactical MEMS units of that class.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats

STANDARD_GRAVITY_M_S2 = 9.80665
DEG_H = np.deg2rad(1.0) / 3600.0


@dataclass(frozen=True)
class InertialUnit:
    """An inertial unit.

    Attributes
    ----------
    rate_hz : float, Hz
    gyro_noise_deg_rth : float, deg/sqrt(h)
        Angular random walk.
    gyro_bias_deg_h, gyro_bias_s : float, deg/h and s
        1 sigma and time constant of the bias in flight, a Gauss-Markov process.
    gyro_turn_on_deg_h : float, deg/h
        1 sigma of the constant part.
    force_noise_m_s_rth : float, m/s/sqrt(h)
        Velocity random walk.
    force_bias_mg : float, mg
        1 sigma, constant.
    """

    rate_hz: float = 100.0
    gyro_noise_deg_rth: float = 0.05
    gyro_bias_deg_h: float = 0.1
    gyro_bias_s: float = 3600.0
    gyro_turn_on_deg_h: float = 1.0
    force_noise_m_s_rth: float = 0.03
    force_bias_mg: float = 0.015

    @property
    def sample_s(self) -> float:
        """Time between samples, s."""
        return 1.0 / self.rate_hz

    @property
    def turn_sigma_rad(self) -> float:
        """1 sigma of the noise of one sample's turn, rad."""
        return float(np.deg2rad(self.gyro_noise_deg_rth) / 60.0 * np.sqrt(self.sample_s))

    @property
    def force_sigma_m_s2(self) -> float:
        """1 sigma of the noise of one sample's specific force, m/s2."""
        return float(self.force_noise_m_s_rth / 60.0 / np.sqrt(self.sample_s))

    def turns(self, rates: Floats, biases: Floats, draws: Floats) -> Floats:
        """Return what the gyroscopes give, turns between samples, (..., 3), rad.

        Parameters
        ----------
        rates : (..., 3) array, rad/s
            True, in the middle of each sample.
        biases : (..., 3) array, rad/s
        draws : (..., 3) array
            Standard normal.
        """
        return self.sample_s * (rates + biases) + self.turn_sigma_rad * draws

    def bias_steps(self, duration_s: float) -> tuple[float, float]:
        """Return what is left of a bias after a while, and 1 sigma of what comes, rad/s."""
        left = float(np.exp(-duration_s / self.gyro_bias_s))
        return left, float(self.gyro_bias_deg_h * DEG_H * np.sqrt(1.0 - left**2))
