"""Sunlight that the lens scatters onto the chip: how much, by the angle to the Sun.

Every polished, slightly dusty surface scatters a little light about the direction in which it lets
it through; the sum over a lens is taken as one scattering function of Harvey's form (Harvey 1976;
Fest 2013, Stray Light Analysis and Control, chapter 4)

    B(theta) = peak / (1 + (sin theta / sin shoulder)^2)^(slope / 2)          1/sr

with ``theta`` from a pixel's line of sight to the Sun. The Sun need not be in the field. Light that
falls on the lens with the irradiance ``E`` then makes a pixel as bright as a scene of the radiance
``E B(theta)`` would, and the point source transmittance, irradiance on the chip over that on the
lens, is ``tau pi / (4 N^2) B(theta)``. A hood shades the lens from a Sun further off the boresight
than its cut-off; what it lets through nevertheless is its leak.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import AnyArray, Floats
from models.sensors.camera_chip import Optics


@dataclass(frozen=True)
class LensScatter:
    """What a lens scatters and what its hood keeps out.

    Attributes
    ----------
    peak_1_sr : float, 1/sr
        Of the scattering function, towards the Sun itself; 0 is a lens that scatters nothing.
    shoulder_deg : float, deg
        Within it the function is level; outside it falls.
    slope : float
        Power of its fall.
    hood_deg : float, deg
        Off-axis angle of the Sun from which on the hood shades the lens; 90 is no hood.
    hood_leak : float
        Share of the scattered light that is left then.
    """

    peak_1_sr: float = 0.0
    shoulder_deg: float = 0.6
    slope: float = 2.0
    hood_deg: float = 90.0
    hood_leak: float = 0.0

    def scattered(self, cosine: AnyArray) -> Floats:
        """Return the scattering function, 1/sr, by the cosine of the angle to the Sun.

        Beyond a right angle nothing reaches the lens: 0.

        Parameters
        ----------
        cosine : (...,) array

        Returns
        -------
        (...,) array, 1/sr
        """
        cosine = np.asarray(cosine, dtype=np.float64)
        sine2 = np.maximum(1.0 - cosine**2, 0.0) / np.sin(np.deg2rad(self.shoulder_deg)) ** 2
        return np.where(cosine > 0.0, self.peak_1_sr * (1.0 + sine2) ** (-0.5 * self.slope), 0.0)

    def hood(self, sun_off_axis_deg: float) -> float:
        """Return the share that the hood lets through of a Sun so far off the boresight."""
        if sun_off_axis_deg >= 90.0:
            return 0.0
        return 1.0 if sun_off_axis_deg < self.hood_deg else self.hood_leak

    def point_source_transmittance(self, optics: Optics, sun_off_axis_deg: float) -> float:
        """Return irradiance at the chip's middle over that on a surface facing the Sun."""
        cosine = float(np.cos(np.deg2rad(sun_off_axis_deg)))
        solid_angle = optics.transmission * np.pi / (4.0 * optics.f_number**2)
        on_lens = max(cosine, 0.0) * self.hood(sun_off_axis_deg)
        return float(solid_angle * on_lens * self.scattered(np.array(cosine)))
