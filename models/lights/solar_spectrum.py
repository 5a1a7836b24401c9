"""The Sun's spectrum above the atmosphere, near the camera's passband, and what a band of it holds.

ASTM E490-00a (2006), Standard solar constant and zero air mass solar spectral irradiance tables,
at 1 au; the stretch from 779 to 863 nm.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats

E490: tuple[tuple[float, float], ...] = (
    (779, 1187), (781, 1187), (783, 1176), (785, 1180), (787, 1177), (789, 1174), (791, 1158),
    (793, 1143), (795, 1134), (797, 1152), (799, 1135), (801, 1142), (803, 1129), (805, 1115),
    (807, 1120), (809, 1095), (811, 1114), (813, 1115), (815, 1107), (817, 1104), (819, 1063),
    (821, 1080), (823, 1073), (825, 1075), (826, 1080), (828, 1081), (830, 1063), (832, 1051),
    (834, 1041), (836, 1052), (838, 1044), (840, 1040), (842, 1036), (844, 1024), (846, 1028),
    (848, 1023), (850, 966), (852, 996.1), (854, 878), (856, 975.5), (858, 1005), (860, 996.9),
    (862, 994.9),
)  # fmt: skip
"""Wavelength, nm, and spectral irradiance, W m-2 um-1. The dips are the calcium triplet."""


def band_irradiance_w_m2(low_nm: float, high_nm: float) -> float:
    """Return the irradiance of a band on a surface that faces the Sun, by the trapezoidal rule.

    Raises
    ------
    ValueError
        If the band is empty or leaves the table.
    """
    wavelength_nm, spectral = (np.array(column, dtype=float) for column in zip(*E490, strict=True))
    if not wavelength_nm[0] <= low_nm < high_nm <= wavelength_nm[-1]:
        raise ValueError(
            f"expected a band within {wavelength_nm[0]:g} to {wavelength_nm[-1]:g} nm, "
            f"got {low_nm:g} to {high_nm:g} nm"
        )
    within = (wavelength_nm > low_nm) & (wavelength_nm < high_nm)
    grid: Floats = np.concatenate([[low_nm], wavelength_nm[within], [high_nm]])
    return float(np.trapezoid(np.interp(grid, wavelength_nm, spectral), grid * 1e-3))
