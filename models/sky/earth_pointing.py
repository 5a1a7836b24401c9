"""How an Earth-pointing satellite at GEO stands among the stars, and how it turns.

The nominal axes of the target are those of ``models.motion.approach``: z away from the Earth, x
backward along the orbit, y opposite to the orbit's normal, so that solar wings along y point north
and south. The orbit lies in the equator of the ICRS, as a kept geostationary one does to a tenth
of a degree (station keeping) and the equator's own precession (0.14 deg from 2000 to 2025).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from models.arrays import Floats
from models.motion.clohessy_wiltshire import GEO_SEMI_MAJOR_AXIS_M, mean_motion

GEO_RATE_DEG_H = round(float(np.rad2deg(mean_motion(GEO_SEMI_MAJOR_AXIS_M)) * 3600.0), 4)


def earth_pointing(zenith_right_ascension_deg: float) -> Floats:
    """Return the (3, 3) rotation ``R_target_from_icrs`` of a satellite below that meridian.

    Parameters
    ----------
    zenith_right_ascension_deg : float, deg
        Of the point of the celestial equator that +z points at: it rises by 15 deg an hour.
    """
    angle = np.deg2rad(zenith_right_ascension_deg)
    away = np.array([np.cos(angle), np.sin(angle), 0.0])
    ahead = np.array([-np.sin(angle), np.cos(angle), 0.0])
    north = np.array([0.0, 0.0, 1.0])
    return np.stack([-ahead, -north, away])


def rotation_from_wxyz(wxyz: ArrayLike) -> Floats:
    """Return the (3, 3) rotation ``R_a_from_b`` of a quaternion ``q_a_from_b``, scalar first."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(np.asarray(wxyz, dtype=np.float64), scalar_first=True).as_matrix()


def turned(
    rotation: Floats, rate_in_target_deg_h: tuple[float, float, float], time_s: float
) -> Floats:
    """Return ``R_target_from_icrs`` after ``time_s``, (3, 3).

    Parameters
    ----------
    rotation : (3, 3) array
        ``R_target_from_icrs`` at time 0.
    rate_in_target_deg_h : (3,) tuple, deg/h
        Angular velocity of the target with respect to the stars, in its own axes; constant.
    time_s : float, s
    """
    from scipy.spatial.transform import Rotation

    turn_deg = np.asarray(rate_in_target_deg_h) * (time_s / 3600.0)
    return Rotation.from_rotvec(-turn_deg, degrees=True).as_matrix() @ rotation
