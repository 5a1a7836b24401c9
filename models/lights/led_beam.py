"""The lamps: 800 and 850 nm LEDs interleaved in one ring close round the lens, and their beam."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from models.arrays import Floats


@dataclass(frozen=True)
class LedRing:
    """One wavelength's LEDs, all facing along the boresight.

    Attributes
    ----------
    wavelength_nm : float, nm
    intensity_w_sr : float, W/sr
        On axis, of all LEDs together.
    count : int
    radius_m : float, m
        Of the ring, in the lens's plane, centred on the lens.
    phase_deg : float, deg
        Turn of the first LED from the camera's x axis; half a step interleaves the two rings.
    half_intensity_deg : float, deg
        Angle off axis at which the intensity has fallen to half.
    centre_in_cam : tuple of 3 floats, m
        Middle of the ring: the lens for the pair's lamps, elsewhere for a floodlight.
    """

    wavelength_nm: float
    intensity_w_sr: float = 12.0
    count: int = 8
    radius_m: float = 0.03
    phase_deg: float = 0.0
    half_intensity_deg: float = 25.0
    centre_in_cam: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @cached_property
    def exponent(self) -> float:
        """The n of ``I(theta) = I0 cos^n(theta)``."""
        return float(np.log(0.5) / np.log(np.cos(np.deg2rad(self.half_intensity_deg))))

    def relative_intensity(self, cosine: ArrayLike) -> Floats:
        """Return I(theta) / I0 for cosines of the angle off axis; nothing goes backwards.

        Parameters
        ----------
        cosine : (...,) array

        Returns
        -------
        (...,) array
            In [0, 1].
        """
        return np.maximum(np.asarray(cosine, dtype=np.float64), 0.0) ** self.exponent

    @property
    def points_in_cam(self) -> Floats:
        """(count, 3) array, m: where the LEDs stand, camera axes, lens at the origin."""
        angles = np.deg2rad(self.phase_deg) + 2.0 * np.pi * np.arange(self.count) / self.count
        circle = np.stack([np.cos(angles), np.sin(angles), np.zeros(self.count)], axis=-1)
        return np.asarray(np.asarray(self.centre_in_cam) + self.radius_m * circle)

    def irradiance(self, points_in_cam: ArrayLike, normals_in_cam: ArrayLike) -> Floats:
        """Return the irradiance, W/m2, on unshadowed surface points.

        Parameters
        ----------
        points_in_cam, normals_in_cam : (n, 3) arrays, m and unit

        Returns
        -------
        (n,) array, W/m2
        """
        points = np.asarray(points_in_cam, dtype=np.float64)[:, None, :]
        normals = np.asarray(normals_in_cam, dtype=np.float64)[:, None, :]
        to_point = points - self.points_in_cam
        distance = np.linalg.norm(to_point, axis=-1)
        beam = self.relative_intensity(to_point[..., 2] / distance)
        facing = np.maximum(-(to_point * normals).sum(axis=-1) / distance, 0.0)
        each = self.intensity_w_sr / self.count * beam * facing / distance**2
        return np.asarray(each.sum(axis=-1))


LAMPS_800 = LedRing(wavelength_nm=800.0)
LAMPS_850 = LedRing(wavelength_nm=850.0, phase_deg=22.5)
