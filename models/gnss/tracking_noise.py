"""Thermal noise of a receiver's code and frequency loops.

References
----------
E. D. Kaplan and C. J. Hegarty, Understanding GPS, 2nd edition, 2006: code loop, equations 5.22 and
5.23, early minus late power discriminator; frequency loop, equation 5.13.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats

SPEED_OF_LIGHT_M_S = 299_792_458.0
L1_HZ = 1_575.42e6
CHIP_RATE_HZ = 1.023e6  # of GPS C/A and of Galileo E1
WAVELENGTH_M = SPEED_OF_LIGHT_M_S / L1_HZ
CHIP_M = SPEED_OF_LIGHT_M_S / CHIP_RATE_HZ


@dataclass(frozen=True)
class TrackingLoops:
    """The loops of a receiver.

    Attributes
    ----------
    code_bandwidth_hz : float, Hz
    spacing_chips : float
        Between early and late.
    front_end_hz : float, Hz
    integration_s : float, s
    frequency_bandwidth_hz : float, Hz
    """

    code_bandwidth_hz: float = 0.2
    spacing_chips: float = 0.3
    front_end_hz: float = 12e6
    integration_s: float = 0.02
    frequency_bandwidth_hz: float = 2.0

    def code_sigma_m(self, cn0_dbhz: Floats) -> Floats:
        """Return 1 sigma of a pseudorange, (...,), m, by C/N0, (...,), dB-Hz."""
        cn0 = 10.0 ** (0.1 * np.asarray(cn0_dbhz))
        squaring = 1.0 + 2.0 / (self.integration_s * cn0 * (2.0 - self.spacing_chips))
        return CHIP_M * np.sqrt(
            self.code_bandwidth_hz / (2.0 * cn0) * self._correlation_chips * squaring
        )

    def rate_sigma_m_s(self, cn0_dbhz: Floats) -> Floats:
        """Return 1 sigma of a range rate, (...,), m/s, by C/N0, (...,), dB-Hz."""
        cn0 = 10.0 ** (0.1 * np.asarray(cn0_dbhz))
        squaring = 1.0 + 1.0 / (self.integration_s * cn0)
        jitter_hz = np.sqrt(4.0 * self.frequency_bandwidth_hz / cn0 * squaring) / (
            2.0 * np.pi * self.integration_s
        )
        return WAVELENGTH_M * jitter_hz

    @property
    def _correlation_chips(self) -> float:
        """How steep the correlation is between early and late: three branches by the front end."""
        chips = CHIP_RATE_HZ / self.front_end_hz
        spacing = self.spacing_chips
        if spacing >= np.pi * chips:
            return spacing
        if spacing <= chips:
            return chips
        return chips + (spacing - chips) ** 2 / (chips * (np.pi - 1.0))
