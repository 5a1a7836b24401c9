"""What pushes and pulls a satellite beside the Earth's own field: Sun, Moon, light and air.

References
----------
O. Montenbruck and E. Gill, Satellite Orbits, 2000: third bodies, equation 3.37; solar pressure and
the conical shadow, sections 3.4.1 and 3.4.2; air drag, equation 3.97; density of Harris and
Priester, section 3.5.2 and table 3.8, for a mean Sun.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.lights.eclipse import share_past_earth
from models.sky.earth_rotation import EARTH_RATE_RAD_S
from models.sky.sun_ephemeris import ASTRONOMICAL_UNIT_M

SUN_MU_M3_S2 = 1.32712440041e20
SUN_RADIUS_M = 6.957e8
SOLAR_PRESSURE_N_M2 = 4.56e-6  # at one astronomical unit
EARTH_RADIUS_M = 6_378_137.0
EARTH_FLATTENING = 1.0 / 298.257223563
BULGE_LAG_RAD = np.deg2rad(30.0)
BULGE_EXPONENT = 6  # of polar orbits; 2 for low inclinations

# Height, km; least and largest density, g/km3.
DENSITY = np.array(
    [
        (400, 2.249, 7.492), (420, 1.558, 5.684), (440, 1.091, 4.355), (460, 0.7701, 3.362),
        (480, 0.5474, 2.612), (500, 0.3916, 2.042), (520, 0.2819, 1.605), (540, 0.2042, 1.267),
        (560, 0.1488, 1.005), (580, 0.1092, 0.7997), (600, 0.0807, 0.639), (620, 0.06012, 0.5123),
        (640, 0.04519, 0.4121), (660, 0.0343, 0.3325), (680, 0.02632, 0.2691),
        (700, 0.02043, 0.2185), (720, 0.01607, 0.1779), (740, 0.01281, 0.1452),
        (760, 0.01036, 0.119), (780, 0.008496, 0.09776), (800, 0.007069, 0.08059),
        (840, 0.00468, 0.05741), (880, 0.0032, 0.0421), (920, 0.00221, 0.0313),
        (960, 0.00156, 0.0236), (1000, 0.00115, 0.0181),
    ]
)  # fmt: skip


def third_body(position: Floats, body: Floats, mu_m3_s2: float) -> Floats:
    """Return the acceleration by a body far away, with respect to the Earth, (..., 3), m/s2.

    Parameters
    ----------
    position : (..., 3) array, m
        Of the satellite, from the Earth's centre.
    body : (3,) array, m
    mu_m3_s2 : float, m3/s2
        Of that body.
    """
    to_body = body - position
    distance = np.sqrt(np.sum(to_body * to_body, axis=-1, keepdims=True))
    return mu_m3_s2 * (to_body / distance**3 - body / float(body @ body) ** 1.5)


def sunlit_share(position: Floats, sun: Floats) -> float:
    """Return how much of the Sun's disc is seen past the Earth, 0 to 1.

    Parameters
    ----------
    position, sun : (3,) array, m
    """
    to_sun = sun - position
    distance, radius = float(np.linalg.norm(to_sun)), float(np.linalg.norm(position))
    sun_rad = float(np.arcsin(SUN_RADIUS_M / distance))
    return share_past_earth(to_sun / distance, -position / radius, 1e-3 * radius, sun_rad)


def solar_pressure(position: Floats, sun: Floats, area_over_mass: float) -> Floats:
    """Return the acceleration by sunlight on a ball, in the Earth's shadow none, (3,), m/s2.

    Parameters
    ----------
    position, sun : (3,) array, m
    area_over_mass : float, m2/kg
        Times the coefficient of the pressure: 1 where all light is swallowed.
    """
    from_sun = position - sun
    distance = float(np.linalg.norm(from_sun))
    flux = SOLAR_PRESSURE_N_M2 * (ASTRONOMICAL_UNIT_M / distance) ** 2
    return sunlit_share(position, sun) * flux * area_over_mass * from_sun / distance


def air_density(position: Floats, sun: Floats) -> float:
    """Return the density of the air, kg/m3; none above 1000 km.

    Parameters
    ----------
    position, sun : (3,) array, m
        Inertial.

    Raises
    ------
    ValueError
        Below 400 km, where the table does not reach.
    """
    radius = float(np.linalg.norm(position))
    height_km = 1e-3 * (radius - _ground_radius_m(position[2] / radius))
    if height_km < DENSITY[0, 0]:
        raise ValueError(f"expected a height of at least 400 km, got {height_km:.1f} km")
    if height_km >= DENSITY[-1, 0]:
        return 0.0
    place = int(np.searchsorted(DENSITY[:, 0], height_km, side="right")) - 1
    low, high = DENSITY[place], DENSITY[place + 1]
    part = (height_km - low[0]) / (high[0] - low[0])
    least, most = low[1:] * (high[1:] / low[1:]) ** part
    s, c = np.sin(BULGE_LAG_RAD), np.cos(BULGE_LAG_RAD)
    bulge = np.array([c * sun[0] - s * sun[1], s * sun[0] + c * sun[1], sun[2]])
    cosine = float(position @ bulge) / (radius * float(np.linalg.norm(bulge)))
    weight = (0.5 + 0.5 * cosine) ** (BULGE_EXPONENT / 2)
    return 1e-12 * float(least + (most - least) * weight)


def drag(position: Floats, velocity: Floats, density: float, area_over_mass: float) -> Floats:
    """Return the acceleration by air that turns with the Earth, (3,), m/s2.

    Parameters
    ----------
    position, velocity : (3,) array, m and m/s
        Inertial.
    density : float, kg/m3
    area_over_mass : float, m2/kg
        Times the drag coefficient.
    """
    wind = EARTH_RATE_RAD_S * np.array([-position[1], position[0], 0.0])
    through = velocity - wind
    return -0.5 * density * area_over_mass * float(np.linalg.norm(through)) * through


def _ground_radius_m(sine_of_latitude: float) -> float:
    squared = EARTH_FLATTENING * (2.0 - EARTH_FLATTENING)
    cosine = 1.0 - sine_of_latitude**2
    return EARTH_RADIUS_M * float(np.sqrt((1.0 - squared) / (1.0 - squared * cosine)))
