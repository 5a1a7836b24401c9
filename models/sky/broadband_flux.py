"""Photons of a star of magnitude zero over a broad band, as bare silicon counts them.

Bessell, Castelli and Plez 1998 (A&A 333, 231, Table A2) give the flux of an A0 star of magnitude 0
at the middles of B, V, R and I; between them its logarithm is taken as straight, beyond them level
in slope. Real spectra differ: a K star of one Hipparcos magnitude gives silicon some 10 % more, a B
star 10 % less, for it sees a little further into the red. No position depends on it.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.sensors.camera_chip import LIGHT_SPEED_M_S, PLANCK_J_S

_NM = np.array([438.0, 545.0, 641.0, 798.0])
_W_M2_UM = np.array([6.320e-8, 3.631e-8, 2.177e-8, 1.126e-8])
STEP_NM = 1.0


def zero_magnitude_photons_m2_s(low_nm: float, high_nm: float) -> float:
    """Return the photons between two wavelengths that fall on a surface facing the star, 1/m2/s.

    Parameters
    ----------
    low_nm, high_nm : float, nm
    """
    wavelengths = np.arange(low_nm + 0.5 * STEP_NM, high_nm, STEP_NM)
    energy_j = PLANCK_J_S * LIGHT_SPEED_M_S / (wavelengths * 1e-9)
    return float(np.sum(_flux(wavelengths) / energy_j) * STEP_NM * 1e-3)


def _flux(wavelengths_nm: Floats) -> Floats:
    """Return W m-2 um-1: powers of the wavelength between the bands, and on beyond them."""
    x, y = np.log(_NM), np.log(_W_M2_UM)
    piece = np.clip(np.searchsorted(x, np.log(wavelengths_nm)) - 1, 0, len(x) - 2)
    slope = np.diff(y) / np.diff(x)
    return np.exp(y[piece] + slope[piece] * (np.log(wavelengths_nm) - x[piece]))
