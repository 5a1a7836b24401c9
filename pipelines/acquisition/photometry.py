"""How likely the brightness in an image is, were the target at a pose, in a light that is known.

Both are stretched as noise and glints ask for: linear within the noise, logarithmic above. A cell
is as bright as told but for the finishes' errors; or, beside an edge, anything between what is told
around; or something that no model has. What counts is the log-likelihood over that of an empty sky.
Its constants were set on frames of training motions, so that true poses are likeliest among rivals.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from scipy.special import ndtr

from models.arrays import AnyArray, Floats, Radiance
from pipelines.acquisition.cell_grid import cells_under
from pipelines.acquisition.daylight import PredictedLight
from pipelines.detection.target_region import TargetRegion

CELLS_OF_RADIUS = 40.0  # at most so many across the target's radius: the cloud is dense then
LEVEL = 0.60  # of what a face gives, in the median: gaps, rims and partly covered cells take some
SIGMA = 0.50  # of the stretched brightness about what is told
AS_TOLD, UNMODELLED = 0.95, 0.10  # share of what is modelled that is as told there; and of the rest
SKY_SIGMA, SKY_UNMODELLED = 0.5, 0.001  # of an empty sky
BLUR_PX = 0.4
STRAY = (0.0, 0.003, 0.02)  # of what is lit, that faces throw at each other: the likeliest one
STRAY_MOST = 3.0  # times as much, at most
FLAT = 0.05  # levels that differ by less are one
SQUARE = np.ones((3, 3), dtype=np.uint8)


@dataclass(frozen=True, eq=False)
class ShownLight:
    """An image's brightness in cells.

    Attributes
    ----------
    level : (rows, columns) float32 array
        Stretched.
    cell_px : float, px
    corner_px : (2,) array, px
        Of the first cell's outer corner.
    knee_dn, full_dn : float, DN
        Where the stretch turns logarithmic; and what saturates.
    most : float
        Log-likelihood over an empty sky's that the best of all poses could have.
    """

    level: Radiance
    cell_px: float
    corner_px: Floats
    knee_dn: float
    full_dn: float
    most: float

    @property
    def highest(self) -> float:
        """What is saturated, stretched."""
        return float(np.arcsinh(self.full_dn / self.knee_dn))

    def stretched(self, signal_dn: AnyArray) -> Radiance:
        """Return signals as levels, (rows, columns) float32.

        Parameters
        ----------
        signal_dn : (rows, columns) array, DN
            Above the sky.
        """
        clipped = np.clip(signal_dn, 0.0, self.full_dn)
        return np.asarray(np.arcsinh(clipped / self.knee_dn), dtype=np.float32)


def shown_light(
    target: TargetRegion, radius_px: float, full_dn: float, cells: float = CELLS_OF_RADIUS
) -> ShownLight:
    """Cut an image into cells.

    Parameters
    ----------
    target : TargetRegion
        With something lit on it.
    radius_px : float, px
        About how large the target is.
    full_dn : float, DN
        Above the sky, that saturates.
    cells : float
        At most so many across the radius.
    """
    cell_px = int(max(1, round(radius_px / cells)))
    row, column = np.nonzero(target.lit)
    low = np.array([column.min(), row.min()]) - 2 * cell_px
    low = np.maximum((low // cell_px) * cell_px, 0)
    high = np.array([column.max(), row.max()]) + 1 + 2 * cell_px
    count = -(-(high - low) // cell_px)
    shape = (int(count[0]), int(count[1]))
    grids = []
    for grid in (target.signal, target.lit.astype(np.float32)):
        part = grid[low[1] : low[1] + shape[1] * cell_px, low[0] : low[0] + shape[0] * cell_px]
        whole = np.zeros((shape[1] * cell_px, shape[0] * cell_px), dtype=np.float32)
        whole[: part.shape[0], : part.shape[1]] = part
        grids.append(cv2.resize(whole, shape, interpolation=cv2.INTER_AREA))
    signal, lit = grids
    knee_dn = 4.0 * target.sky_sigma_dn
    # What the smoothing did not find is noise or a star.
    signal = np.where(lit >= 0.4, signal, np.minimum(signal, knee_dn))
    shown = ShownLight(signal, cell_px, low - 0.5, knee_dn, full_dn, 0.0)
    level = shown.stretched(signal)
    gains = np.log(_normal(0.0, SIGMA)) - np.log(_of_sky(level, shown.highest))
    most = float(np.maximum(gains, 0.0).sum())
    return ShownLight(level, cell_px, low - 0.5, knee_dn, full_dn, max(most, 1.0))


def likelihood(shown: ShownLight, told: PredictedLight, white_dn: float) -> float:
    """Return the log-likelihood of an image's brightness at a pose over that of an empty sky.

    Parameters
    ----------
    shown : ShownLight
    told : PredictedLight
        In the cells of the same grid.
    white_dn : float, DN
        What a white matt face that the Sun meets squarely gives.
    """
    # The lens spreads what is bright over the cells beside it.
    here = cv2.dilate(told.covered.astype(np.uint8), SQUARE) > 0
    level = cells_under(shown.level, told.corner, told.covered.shape, 0.0)[here]
    sky = float(np.log(_of_sky(level, shown.highest)).sum())
    white = LEVEL * white_dn
    lowest = cv2.erode(shown.stretched(white * told.direct), SQUARE)[here]
    blur = BLUR_PX / shown.cell_px
    best = -np.inf
    for stray in STRAY:
        mean = told.direct + stray * told.stray
        most = told.direct + STRAY_MOST * stray * told.stray
        if blur > 0.25:
            mean = cv2.GaussianBlur(mean, (0, 0), blur)
        middle = shown.stretched(white * mean)[here]
        high = np.maximum(cv2.dilate(shown.stretched(white * most), SQUARE)[here], middle)
        low = np.minimum(lowest, middle)
        width = high - low
        as_told = _normal(level - middle, SIGMA)
        between = (ndtr((level - low) / SIGMA) - ndtr((level - high) / SIGMA)) / np.maximum(
            width, 1e-3
        )
        between = np.where(width < FLAT, as_told, between)
        known = AS_TOLD * as_told + (1.0 - AS_TOLD) * between
        density = (1.0 - UNMODELLED) * known + UNMODELLED / shown.highest
        best = max(best, float(np.log(density).sum()))
    return best - sky


def _of_sky(level: Radiance, highest: float) -> Floats:
    dark = (1.0 - SKY_UNMODELLED) * _normal(level, SKY_SIGMA)
    return np.asarray(dark + SKY_UNMODELLED / highest)


def _normal(away: Radiance | float, sigma: float) -> Floats:
    return np.asarray(np.exp(-0.5 * (away / sigma) ** 2) / (sigma * np.sqrt(2.0 * np.pi)))
