"""A light group: one light that keeps its own radiance, so that frames are composed afterwards.

Light is linear. A frame is a sum of groups, each scaled as a study wants: lamp power, exposure
time and the choice of Sun cost no rendering. Each group lives in one band of the three that a
rendering carries at once: sunlight through the camera's filter, 800 nm, 850 nm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from models.arrays import Floats
from models.lights.earth import Earth
from models.lights.led_beam import LedRing
from models.lights.sun import ANGULAR_DIAMETER_DEG, PASSBAND_IRRADIANCE_W_M2
from models.pose import RigidTransform

SUNLIGHT, NIR800, NIR850 = 0, 1, 2  # channels of a three-band rendering


@dataclass(frozen=True)
class SunGroup:
    """A Sun disc, far enough off that every point sees it in the same direction.

    Attributes
    ----------
    name : str
        Name of the group's channel, such as ``sun_S2``.
    direction_in_target : tuple of 3 floats
        Unit vector towards its centre.
    irradiance_w_m2 : float, W/m2
        Within the camera's passband, on a surface that faces it.
    angular_diameter_deg : float, deg
    """

    name: str
    direction_in_target: tuple[float, float, float]
    irradiance_w_m2: float = PASSBAND_IRRADIANCE_W_M2
    angular_diameter_deg: float = ANGULAR_DIAMETER_DEG
    channel: int = SUNLIGHT

    @property
    def sine_of_radius(self) -> float:
        """Sine of the disc's angular radius."""
        return float(np.sin(np.deg2rad(0.5 * self.angular_diameter_deg)))


@dataclass(frozen=True)
class EarthGroup:
    """The Earth, lit by one Sun: it lights the target, and is seen where nothing hides it.

    Attributes
    ----------
    name : str
        Such as ``earth_S2``.
    earth : Earth
    channel : int
        The band in which sunlight is carried.
    """

    name: str
    earth: Earth
    channel: int = SUNLIGHT


@dataclass(frozen=True)
class LampGroup:
    """One ring of LEDs on the chaser: a wavelength's, or a floodlight.

    Attributes
    ----------
    name : str
        ``lamps_800``, ``lamps_850`` or ``floodlight``.
    ring : LedRing
        Rendered at its own intensity; scale the group for another.
    channel : int
        Band in which it shines.
    """

    name: str
    ring: LedRing
    channel: int

    def points_in_target(self, cam_from_target: RigidTransform) -> Floats:
        """Return where the LEDs stand, (count, 3), m, target frame."""
        return np.asarray(cam_from_target.inverse() @ self.ring.points_in_cam)


LightGroup: TypeAlias = SunGroup | EarthGroup | LampGroup
