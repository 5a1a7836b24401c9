"""How much of the Sun's disc the Earth leaves free: full light, penumbra and umbra.

Sun and Earth are discs with sharp rims, as the conical shadow has them (Montenbruck and Gill,
Satellite Orbits, 2000, section 3.4.2): no air bends or reddens light, the Sun is as bright at its
limb as in its middle, the Earth is round.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.lights.earth import EARTH_RADIUS_KM
from models.lights.sun import ANGULAR_DIAMETER_DEG

SUN_RADIUS_RAD = float(np.deg2rad(0.5 * ANGULAR_DIAMETER_DEG))
SUNLIT, PENUMBRA, UMBRA = "sunlit", "penumbra", "umbra"


def free_share(apart_rad: float, disc_rad: float, cover_rad: float) -> float:
    """Return how much of a disc another before it leaves free, 0 to 1.

    The lens that two circles of a plane share (Montenbruck and Gill 2000, equations 3.87 to 3.94).

    Parameters
    ----------
    apart_rad : float, rad
        Between the middles.
    disc_rad, cover_rad : float, rad
        Angular radii of what shines and of what stands before it.

    Returns
    -------
    float
    """
    if apart_rad >= disc_rad + cover_rad:
        return 1.0
    if apart_rad <= abs(cover_rad - disc_rad):
        return 0.0 if cover_rad >= disc_rad else 1.0 - (cover_rad / disc_rad) ** 2
    along = (apart_rad**2 + disc_rad**2 - cover_rad**2) / (2.0 * apart_rad)
    across = np.sqrt(max(0.0, disc_rad**2 - along**2))
    hidden = (
        disc_rad**2 * np.arccos(np.clip(along / disc_rad, -1.0, 1.0))
        + cover_rad**2 * np.arccos(np.clip((apart_rad - along) / cover_rad, -1.0, 1.0))
        - apart_rad * across
    )
    return float(1.0 - hidden / (np.pi * disc_rad**2))


def share_past_earth(
    towards_sun: Floats,
    towards_earth: Floats,
    earth_distance_km: float,
    sun_radius_rad: float = SUN_RADIUS_RAD,
) -> float:
    """Return how much of the Sun's disc is seen past the Earth, 0 to 1.

    Parameters
    ----------
    towards_sun, towards_earth : (3,) arrays
        Unit vectors towards their middles, in any axes.
    earth_distance_km : float, km
        From its centre.
    sun_radius_rad : float, rad
        Of the Sun's disc; that at 1 au unless given.

    Returns
    -------
    float
        0 in the umbra, 1 in full light.
    """
    earth_rad = float(np.arcsin(min(1.0, EARTH_RADIUS_KM / earth_distance_km)))
    across = float(np.linalg.norm(np.cross(towards_sun, towards_earth)))
    apart = float(np.arctan2(across, towards_sun @ towards_earth))
    return free_share(apart, sun_radius_rad, earth_rad)


def lighting(share: float) -> str:
    """Return ``sunlit``, ``penumbra`` or ``umbra``, by the share of the Sun that is free."""
    if share <= 0.0:
        return UMBRA
    return SUNLIT if share >= 1.0 else PENUMBRA
