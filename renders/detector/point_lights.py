"""Points of light on the chip, each at the fraction of a pixel that it hits.

They fall as the lens's Gaussian point spread averaged over pixels, evaluated where the point is: so
the centroid is exact but for what pixels of that size must lose (0.003 px at 0.5 px of spread).
"""

from __future__ import annotations

import numpy as np
from scipy.special import erf

from models.arrays import Floats

REACH = 6.0  # of the point spread, in sigmas
SHARPEST_PX = 1e-3  # a point spread below it is this, well within one pixel


def add_points(charge: Floats, pixels: Floats, electrons: Floats, sigma_px: float) -> None:
    """Add points of light to the charge, each spread by the lens; what falls beside it is lost.

    Parameters
    ----------
    charge : (height, width) array, e
        Is changed.
    pixels : (n, 2) array, px
        Column and row; pixel centres are integers.
    electrons : (n,) array, e
    sigma_px : float, px
        Of the point spread.
    """
    if not len(pixels):
        return
    height, width = charge.shape
    sigma = max(sigma_px, SHARPEST_PX)
    reach = int(np.ceil(REACH * sigma)) + 1
    around = np.arange(-reach, reach + 1)
    columns, rows = (np.rint(pixels[:, k, None]).astype(np.int64) + around for k in range(2))
    across = _averaged(columns - pixels[:, :1], sigma) * ((columns >= 0) & (columns < width))
    down = _averaged(rows - pixels[:, 1:], sigma) * ((rows >= 0) & (rows < height))
    places = np.clip(rows, 0, height - 1)[:, :, None], np.clip(columns, 0, width - 1)[:, None, :]
    np.add.at(charge, places, electrons[:, None, None] * (down[:, :, None] * across[:, None, :]))


def _averaged(aside_px: Floats, sigma_px: float) -> Floats:
    """Return the share of a Gaussian that pixels of a line hold whose centres are so far aside."""
    scale = 1.0 / (np.sqrt(2.0) * sigma_px)
    return np.asarray(0.5 * (erf((aside_px + 0.5) * scale) - erf((aside_px - 0.5) * scale)))
