"""How much starlight comes through the camera's 790 to 860 nm passband, from V, B-V and class.

The band lies beside Cousins' I (798 nm, 149 nm wide; Bessell 2005, ARA&A 43, 293). I = V - (V - I),
and V - I follows from B-V; but the colour of a star of class M or S hardly knows B-V, so that its
class is asked. Zero point: 1.126e-8 W m-2 um-1 at 798 nm (Bessell, Castelli and Plez 1998, A&A 333,
231, Table A2), carried to 825 nm with the inverse third power that leads from the same table's R
(641 nm) to I and from I to J (1220 nm). Redder stars fall off less: by 0.06 of V - I, as the Sun
does (ASTM E490-00a: 1.12 W m-2 nm-1 at 798 nm, 1.055 at 825 nm; V - I = 0.70, Ramirez et al. 2012,
ApJ 752, 5). The Sun itself, taken for a star of V = -26.76, comes out within 5 % of its light.

Errors: 3 % of the zero point; 5 to 10 % from V - I up to class K; 20 to 30 % in class M, whose
bands of titanium oxide are in the passband; reddened supergiants come out up to 0.4 magnitudes too
faint (Betelgeuse, V I Johnson -2.4, has I about -1.8 and gets -1.5), and variables are at V as
catalogued. Planets, the Moon, the zodiacal light and the Milky Way are left out.
"""

from __future__ import annotations

import numpy as np

ZERO_POINT_W_M2_UM = 1.126e-8 * (798.0 / 825.0) ** 3
PASSBAND_UM = 0.070
REDDER = 0.06  # of V - I, from I to the passband
ZERO_MAGNITUDE_W_M2 = ZERO_POINT_W_M2_UM * PASSBAND_UM  # 7.1e-10

# B-V and V-I (Cousins). Up to 0.8 near the dwarfs of Pecaut and Mamajek 2013, ApJS 208, 9. Beyond,
# the giants of Alonso et al. 1999, A&AS 140, 261, Table 5 for [Fe/H] = 0.2, from Johnson's I to
# Cousins' by Bessell 1979, PASP 91, 589 (0.778 of it below 2.0, 0.835 of it less 0.13 above).
_B_V = np.array(
    [-0.30, -0.156, -0.11, 0.0, 0.16, 0.295, 0.44, 0.55, 0.65, 0.80, 0.935, 1.055, 1.19]
)
_V_I = np.array([-0.35, -0.17, -0.11, 0.0, 0.17, 0.34, 0.50, 0.60, 0.69, 0.79, 0.88, 0.99, 1.12])
_RED_B_V = np.array([1.345, 1.515, 1.705, 1.93])
_RED_V_I = np.array([1.26, 1.45, 1.72, 2.21])

# Class of a giant and V-I (Cousins): intrinsic colours compiled by B. A. Skiff for the Amateur Sky
# Survey, 2002. Class S is read as M of the same number.
_M_CLASS = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])
_M_V_I = np.array([1.60, 1.88, 2.05, 2.26, 2.55, 2.87, 3.30, 3.78, 4.34])


def visual_minus_infrared(b_v: float, red_class: str) -> float:
    """Return V - I, Cousins, of a star.

    Parameters
    ----------
    b_v : float
        Beyond the ends of the table, -0.3 and 1.93, that of the end.
    red_class : str
        Such as ``M2.5`` or ``S3.5``; empty for a star of another class.
    """
    if red_class:
        return float(np.interp(float(red_class[1:]), _M_CLASS, _M_V_I))
    return float(np.interp(b_v, np.concatenate([_B_V, _RED_B_V]), np.concatenate([_V_I, _RED_V_I])))


def irradiance_w_m2(visual_mag: float, b_v: float, red_class: str = "") -> float:
    """Return the irradiance of a star in the passband, W m-2, on a surface that faces it.

    Parameters
    ----------
    visual_mag : float
        V.
    b_v : float
        B-V.
    red_class : str
        As ``visual_minus_infrared`` takes it.
    """
    colour = visual_minus_infrared(b_v, red_class)
    magnitude = visual_mag - (1.0 + REDDER) * colour
    return float(ZERO_MAGNITUDE_W_M2 * 10.0 ** (-0.4 * magnitude))
