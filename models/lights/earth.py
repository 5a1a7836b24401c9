"""The Earth as a light: a sunlit Lambert sphere of one albedo, far enough off that it stands still.

Behind the target it fills the background; beside it, it lights the shadow side. Clouds, oceans and
the terminator's twilight are left out: what matters here is how much light comes from where.

Albedo: 0.297 over the solar spectrum (Goode et al. 2001, Geophys. Res. Lett. 28, 1671); vegetation
and cloud are brighter near 825 nm and water vapour is darker there, so it serves the band as well
as any one number. Radii: IERS Conventions 2010 (equator), GEO from Kepler's third law.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from models.arrays import Floats

EARTH_RADIUS_KM = 6378.137
GEO_RADIUS_KM = 42164.2
ALBEDO = 0.297
RINGS, SPOKES = 32, 64  # of directions that a disc's light is summed over: exact to 1e-4 of it


@dataclass(frozen=True)
class Earth:
    """Where the Earth stands, and how it shines.

    Attributes
    ----------
    direction_in_target : tuple of 3 floats
        Unit vector towards its centre.
    sun_dir_in_target : tuple of 3 floats
        Unit vector towards the Sun that lights it.
    orbit_radius_km : float, km
        Distance from its centre.
    albedo : float
        In the camera's band.
    sun_irradiance_w_m2 : float, W/m2
        On a surface that faces the Sun, in the band.
    """

    direction_in_target: tuple[float, float, float]
    sun_dir_in_target: tuple[float, float, float]
    orbit_radius_km: float
    albedo: float
    sun_irradiance_w_m2: float

    @property
    def sine_of_radius(self) -> float:
        """Sine of the angular radius of its disc: 8.7 deg at GEO, 68 deg at 500 km."""
        return EARTH_RADIUS_KM / self.orbit_radius_km

    @property
    def solid_angle_sr(self) -> float:
        """Solid angle of its disc, lit or not, sr."""
        return float(2.0 * np.pi * (1.0 - np.sqrt(1.0 - self.sine_of_radius**2)))

    def radiance(self, directions_in_target: ArrayLike) -> Floats:
        """Return what comes from unit directions (..., 3), W m-2 sr-1; zero beside the disc.

        ``L = albedo E cos(z) / pi`` with z the Sun's zenith angle where the ray meets the sphere.
        """
        rays = np.asarray(directions_in_target, dtype=np.float64)
        along = rays @ np.asarray(self.direction_in_target)
        reach = 1.0 / self.sine_of_radius  # distance in Earth radii
        inside = 1.0 - reach**2 * (1.0 - along**2)
        met = (inside > 0.0) & (along > 0.0)
        distance = reach * along - np.sqrt(np.maximum(inside, 0.0))
        centre = reach * np.asarray(self.direction_in_target)
        normals = distance[..., None] * rays - centre
        lit = np.maximum(normals @ np.asarray(self.sun_dir_in_target), 0.0)
        level = self.albedo * self.sun_irradiance_w_m2 / np.pi
        return np.asarray(np.where(met, level * lit, 0.0))


@lru_cache(maxsize=256)
def facing_share(cosine: float, orbit_radius_km: float) -> float:
    """Return the Earth's light over the Sun's, on faces that meet the middle of each squarely.

    Far off it is the phase law of a Lambert sphere (Russell 1916), two thirds of the albedo times
    the square of the disc's angular radius at full phase; close by, the albedo itself.

    Parameters
    ----------
    cosine : float
        Of the angle between the Sun and the target as the Earth's centre sees them.
    orbit_radius_km : float, km
        Distance from that centre.

    Returns
    -------
    float
    """
    sine = float(np.sqrt(max(1.0 - cosine**2, 0.0)))
    earth = Earth((0.0, 0.0, 1.0), (sine, 0.0, -cosine), orbit_radius_km, ALBEDO, 1.0)
    edge = earth.sine_of_radius**2
    nodes, weights = np.polynomial.legendre.leggauss(RINGS)
    squared = 0.5 * edge * (nodes[:, None] + 1.0)  # of the sine off the centre: cos dOmega evenly
    spoke = (np.arange(SPOKES) + 0.5) * 2.0 * np.pi / SPOKES
    off = np.sqrt(squared)
    up = np.broadcast_to(np.sqrt(1.0 - squared), (RINGS, SPOKES))
    rays = np.stack([off * np.cos(spoke), off * np.sin(spoke), up], axis=-1)
    light = earth.radiance(rays).mean(axis=1)
    return float(0.5 * np.pi * edge * (weights @ light))
