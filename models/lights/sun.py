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
from models.lights.sun_names import SUN_NAMES

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

# The same words in the papers' orbital frame, for the eye-in-hand camera (Table 7): azimuth in the
# orbital plane from +x towards +z, elevation towards +y.
EYE_IN_HAND_SUNS_DEG: dict[str, tuple[float, float]] = {
    "E-SB": (270.0, 0.0),
    "E-S1": (16.66, -7.07), "E-S2": (18.09, -22.99), "E-S3": (18.31, 22.38),
    "E-S4": (19.08, 4.7), "E-S5": (21.13, 15.23), "E-S6": (23.72, -14.42),
    "E-S7": (46.58, -7.04), "E-S8": (48.0, -22.98), "E-S9": (49.01, 4.74),
    "E-S10": (50.23, 22.14), "E-S11": (51.97, 14.95), "E-S12": (53.64, -14.45),
    "E-S13": (76.5, -7.01), "E-S14": (77.91, -22.97), "E-S15": (79.81, 4.38),
    "E-S16": (80.14, 22.15), "E-S17": (81.89, 14.98), "E-S18": (83.56, -14.48),
    "E-S19": (107.33, -7.36), "E-S20": (107.82, -22.96), "E-S21": (109.74, 4.42),
    "E-S22": (110.06, 22.16), "E-S23": (111.81, 15.0), "E-S24": (113.48, -14.5),
    "E-S25": (137.25, -7.33), "E-S26": (137.73, -22.96), "E-S27": (139.66, 4.45),
    "E-S28": (139.98, 22.18), "E-S29": (141.74, 15.03), "E-S30": (143.4, -14.53),
    "E-S31": (167.18, -7.3), "E-S32": (168.71, -23.03), "E-S33": (169.59, 4.48),
    "E-S34": (169.9, 22.19), "E-S35": (171.66, 15.05), "E-S36": (173.32, -14.56),
}  # fmt: skip
NAMED_SUNS = (*SUN_CASES_DEG, *EYE_IN_HAND_SUNS_DEG)


def direction_in_orbital_frame(azimuth_deg: float, elevation_deg: float) -> Floats:
    """Return the unit vector towards the Sun, in the target frame.

    ``s = (cos El cos Az, sin El, cos El sin Az)``: the angles of Opromolla et al. 2022, Table 7, as
    settled against its text (E-SB stands straight behind the target).
    """
    azimuth, elevation = np.deg2rad([azimuth_deg, elevation_deg])
    return np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.sin(elevation),
            np.cos(elevation) * np.sin(azimuth),
        ]
    )


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
    """Read ``S1`` to ``S7``, ``E-SB``, ``E-S1`` to ``E-S36`` or ``x,y,z`` into a unit vector.

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
    if name.upper() in EYE_IN_HAND_SUNS_DEG:
        return direction_in_orbital_frame(*EYE_IN_HAND_SUNS_DEG[name.upper()])
    try:
        vector = [float(part) for part in name.split(",")]
    except ValueError as error:
        raise ScenarioError(
            f"expected a Sun among {SUN_NAMES} (`rvbench list`) or a vector x,y,z in the target "
            f"frame, got {text!r}"
        ) from error
    return unit_direction(vector)
