"""The Sun: its disc, its light through the camera's filter, and the papers' directions.

Inside the code a Sun is always ``sun_dir_in_target``, a unit vector towards it. The azimuth and
elevation of Opromolla et al. 2022, Table 6, are turned into one here.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from models.arrays import Floats
from models.errors import ScenarioError
from models.lights.solar_spectrum import band_irradiance_w_m2

ANGULAR_DIAMETER_DEG = 0.533  # at 1 au

PASSBAND_NM = (790.0, 860.0)
PASSBAND_IRRADIANCE_W_M2 = band_irradiance_w_m2(*PASSBAND_NM)  # 74.8

# Azimuth and elevation, deg, in the face's own convention (see ``direction_from_azimuth``).
SUN_CASES_DEG: dict[str, tuple[float, float]] = {
    "S1": (0.0, 90.0),
    "S2": (270.0, 45.0),
    "S3": (270.0, 0.0),
    "S4": (270.0, -60.0),
    "S5": (90.0, 45.0),
    "S6": (90.0, 80.0),
    "S7": (67.0, 75.0),
}


def direction_from_azimuth(azimuth_deg: float, elevation_deg: float) -> Floats:
    """Return the unit vector towards the Sun, in the target frame.

    Azimuth runs clockwise from +y seen from +z, elevation from the face plane towards +z:
    ``s = (cos El sin Az, cos El cos Az, sin El)`` (Opromolla et al. 2022, Table 6, as settled
    against its text: S1 is straight behind the chaser, S4 below the face).
    """
    azimuth, elevation = np.deg2rad([azimuth_deg, elevation_deg])
    return np.array(
        [
            np.cos(elevation) * np.sin(azimuth),
            np.cos(elevation) * np.cos(azimuth),
            np.sin(elevation),
        ]
    )


def unit_direction(vector: ArrayLike) -> Floats:
    """Scale a typed Sun vector, target frame, to length one.

    Parameters
    ----------
    vector : (3,) array
        Towards the Sun, of any length.

    Returns
    -------
    (3,) array

    Raises
    ------
    ScenarioError
        If it is not three finite numbers or has no length.
    """
    direction = np.asarray(vector, dtype=np.float64)
    if direction.shape != (3,) or not np.isfinite(direction).all():
        raise ScenarioError(f"expected a Sun direction of three finite numbers, got {vector!r}")
    largest = float(np.abs(direction).max())
    if largest < 1e-12:
        raise ScenarioError(
            f"expected a Sun direction with a length, got {vector!r}; "
            "give the vector from the target towards the Sun, in the target frame"
        )
    direction = direction / largest  # so that no square overflows
    return direction / np.linalg.norm(direction)


def sun_direction(text: str) -> Floats:
    """Read ``S1`` to ``S7`` or ``x,y,z`` into a unit vector in the target frame.

    Returns
    -------
    (3,) array
        Towards the Sun.

    Raises
    ------
    ScenarioError
        If the text is neither, or the vector has no length.
    """
    name = text.strip()
    if name.upper() in SUN_CASES_DEG:
        return direction_from_azimuth(*SUN_CASES_DEG[name.upper()])
    try:
        vector = [float(part) for part in name.split(",")]
    except ValueError as error:
        raise ScenarioError(
            f"expected a Sun among {', '.join(SUN_CASES_DEG)} or a vector x,y,z in the target "
            f"frame, got {text!r}"
        ) from error
    return unit_direction(vector)
