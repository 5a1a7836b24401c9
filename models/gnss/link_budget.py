"""How strong a navigation signal arrives: transmit and receive pattern, distance, noise.

References
----------
NASA ODTBX, gpslinkbudget:
C/N0 = P_t + G_t + G_r + 20 log10(lambda / 4 pi d) - 10 log10 T + 228.6 + L.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.gnss.tracking_noise import WAVELENGTH_M
from models.gnss.transmit_pattern import azimuth_averaged_gain_db, transmit_gain_db

MINUS_BOLTZMANN_DB = 228.6


@dataclass(frozen=True)
class ReceiveAntenna:
    """One antenna, round about its boresight.

    Attributes
    ----------
    gain_dbi : float, dBi
        On its boresight.
    edge_deg : float, deg
        Beyond which it receives nothing.
    exponent : float
        Gain falls as this power of the cosine of the angle off boresight; 0 for none.
    boresight_in_body : (float, float, float)
        Unit vector.
    """

    gain_dbi: float
    edge_deg: float = 90.0
    exponent: float = 0.0
    boresight_in_body: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def gain_db(self, cosine: Floats) -> Floats:
        """Return the gain by the cosine of the angle off boresight, (...,), dBi."""
        inside = cosine > np.cos(np.deg2rad(self.edge_deg))
        fall = 10.0 * self.exponent * np.log10(np.maximum(cosine, 1e-9))
        return np.where(inside, self.gain_dbi + fall, -np.inf)


@dataclass(frozen=True)
class LinkBudget:
    """What is the same for all signals.

    Attributes
    ----------
    transmit_power_dbw : float, dBW
        GPS IIA, IIF and III; 15.0 of IIR.
    noise_temperature_k : float, K
    losses_db : float, dB
    azimuth_averaged : bool
        Whether the transmit pattern is taken as round.
    """

    transmit_power_dbw: float = 14.3
    noise_temperature_k: float = 290.0
    losses_db: float = 1.0
    azimuth_averaged: bool = False

    def cn0_dbhz(
        self,
        receiver: Floats,
        boresight: Floats,
        sender: Floats,
        sun: Floats,
        antenna: ReceiveAntenna,
    ) -> Floats:
        """Return the carrier to noise density ratio, (..., n), dB-Hz; minus infinity for none.

        Parameters
        ----------
        receiver, boresight : (..., 3) array, m and a unit vector
            Inertial, of the antenna.
        sender : (..., n, 3) array, m
            Inertial.
        sun : (..., 3) array
            Towards it: senders turn their y axis square to Sun and Earth.
        antenna : ReceiveAntenna
        """
        way = receiver[..., None, :] - sender
        distance = np.sqrt(np.sum(way * way, axis=-1))
        direction = way / distance[..., None]
        z = -sender / np.sqrt(np.sum(sender * sender, axis=-1))[..., None]
        cosine_off = np.sum(z * direction, axis=-1)
        off = np.arccos(np.clip(cosine_off, -1.0, 1.0))
        if self.azimuth_averaged:
            transmit_db = azimuth_averaged_gain_db(off)
        else:
            y = np.cross(z, sun[..., None, :])
            y /= np.maximum(np.sqrt(np.sum(y * y, axis=-1)), 1e-12)[..., None]
            x = np.cross(y, z)
            azimuth = np.arctan2(np.sum(direction * y, axis=-1), np.sum(direction * x, axis=-1))
            transmit_db = transmit_gain_db(off, azimuth)
        cosine_on = -np.sum(direction * boresight[..., None, :], axis=-1)
        return (
            self.transmit_power_dbw
            + transmit_db
            + antenna.gain_db(cosine_on)
            + 20.0 * np.log10(WAVELENGTH_M / (4.0 * np.pi * distance))
            - 10.0 * np.log10(self.noise_temperature_k)
            + MINUS_BOLTZMANN_DB
            - self.losses_db
        )
