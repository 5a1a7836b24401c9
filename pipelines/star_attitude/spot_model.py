"""How a star's light is shared among pixels: a Gaussian over their area, drawn out by motion."""

from __future__ import annotations

import numpy as np
from scipy.special import erf

from models.arrays import Floats

STEP_PX = 0.5  # between places along the way; less is not told from a line by any pixel


def spot_shares(
    offset_px: Floats, smear_px: Floats, sigma_px: float, half: int
) -> tuple[Floats, Floats]:
    """Return the shares of windows' pixels and their slopes.

    Parameters
    ----------
    offset_px : (n, 2) array, px
        Of the spots' middles from their windows' central pixels, columns first.
    smear_px : (n, 2) array, px
        By which each moves during the exposure, evenly, its middle in the middle.
    sigma_px : float, px
    half : int, px
        Windows have 2 half + 1 pixels a side.

    Returns
    -------
    shares : (n, rows, columns) array
    slopes : (n, 2, rows, columns) array, 1/px
        By column and row of the middle.
    """
    count = 1 + int(np.ceil(np.hypot(*smear_px.T).max(initial=0.0) / STEP_PX))
    instants = (np.arange(count) + 0.5) / count - 0.5
    pixels = np.arange(-half, half + 1, dtype=np.float64)
    middles = offset_px[:, None, :] + instants[:, None] * smear_px[:, None, :]
    aside = pixels - middles[..., None]  # (n, instants, 2, pixels)
    scale = 1.0 / (np.sqrt(2.0) * sigma_px)
    high, low = (aside + 0.5) * scale, (aside - 0.5) * scale
    share = 0.5 * (erf(high) - erf(low))
    slope = (np.exp(-(low**2)) - np.exp(-(high**2))) * scale / np.sqrt(np.pi)
    across, down = share[:, :, 0], share[:, :, 1]
    pair = "nkr,nkc->nrc"
    shares = np.einsum(pair, down, across) / count
    slopes = np.stack(
        [
            np.einsum(pair, down, slope[:, :, 0]) / count,
            np.einsum(pair, slope[:, :, 1], across) / count,
        ],
        axis=1,
    )
    return shares, slopes
