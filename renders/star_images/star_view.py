"""What a star camera looks at in one exposure: where it points, how it turns, what shines on it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from models.arrays import Floats

SUN_MAG, SUN_RADIUS_DEG = -26.76, 0.267  # V (Willmer 2018, ApJS 236, 47)
FULL_MOON_MAG, MOON_RADIUS_M = -12.73, 1.7374e6
PHASE_MAG = (0.026, 4e-9)  # a degree, and its fourth power: Allen 1976, Astrophysical Quantities


@dataclass(frozen=True, eq=False)
class Disc:
    """A bright disc: the Sun or the Moon.

    Attributes
    ----------
    direction_in_icrs : (3,) array
        Unit vector to its middle, as it seems.
    magnitude : float
    radius_deg : float, deg
    """

    direction_in_icrs: Floats
    magnitude: float
    radius_deg: float


@dataclass(frozen=True, eq=False)
class EarthView:
    """The Earth from a satellite.

    Attributes
    ----------
    centre_in_icrs : (3,) array, m
        From the camera.
    sun_in_icrs : (3,) array
        Unit vector.
    """

    centre_in_icrs: Floats
    sun_in_icrs: Floats


@dataclass(frozen=True, eq=False)
class StarView:
    """One exposure.

    Attributes
    ----------
    cam_from_icrs : (3, 3) array
        At the middle of the exposure.
    rate_in_cam_rad_s : (3,) array, rad/s
        Of the camera against the stars, camera axes.
    velocity_m_s : (3,) array, m/s
        Against the solar system's barycentre, ICRS.
    discs : tuple of Disc
    earth : EarthView or None
    false_px : (n, 2) array, px
        Where something shines that is no star, and stands still in the image.
    false_mag : (n,) array
    """

    cam_from_icrs: Floats
    rate_in_cam_rad_s: Floats = field(default_factory=lambda: np.zeros(3))
    velocity_m_s: Floats = field(default_factory=lambda: np.zeros(3))
    discs: tuple[Disc, ...] = ()
    earth: EarthView | None = None
    false_px: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    false_mag: Floats = field(default_factory=lambda: np.zeros(0))


def sun_disc(direction_in_icrs: Floats) -> Disc:
    """Return the Sun in a direction, (3,)."""
    return Disc(direction_in_icrs, SUN_MAG, SUN_RADIUS_DEG)


def moon_disc(moon_from_camera_m: Floats, sun_in_icrs: Floats) -> Disc:
    """Return the Moon, as bright as its phase makes it; its disc is taken as whole.

    Parameters
    ----------
    moon_from_camera_m : (3,) array, m
    sun_in_icrs : (3,) array
        Unit vector.
    """
    distance = float(np.linalg.norm(moon_from_camera_m))
    towards = moon_from_camera_m / distance
    phase_deg = float(np.rad2deg(np.arccos(np.clip(-towards @ sun_in_icrs, -1.0, 1.0))))
    magnitude = FULL_MOON_MAG + PHASE_MAG[0] * phase_deg + PHASE_MAG[1] * phase_deg**4
    return Disc(towards, magnitude, float(np.rad2deg(np.arcsin(MOON_RADIUS_M / distance))))
