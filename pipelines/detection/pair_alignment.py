"""The 800 nm image moved to where the 850 nm one has the same things.

Between the two exposures of a pair the target moves by hundredths to tenths of a pixel. What is
subtracted then leaves a thin rim of whatever surrounds a marker, brighter in sunlight than the
marker's own dark face, and pulls its centre by a few thousandths of a pixel, outward motion
pulling all centres inward: a range error of 2 ppm. Once the motion is known it is taken out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from models.arrays import AnyArray, Floats
from pipelines.detection.disc_window import WINDOW_MARGIN_PX

SPARE_PX = 3.0  # round the window that the fit cuts, for the motion and for a moved centre


@dataclass(frozen=True, eq=False)
class AlignedPatch:
    """A piece of both images round one marker.

    Attributes
    ----------
    image_800, image_850 : (height, width) arrays, DN
        800 nm as it would be at the time of the 850 nm exposure.
    corner_px : (2,) array, px
        Column and row of the piece's first pixel in the whole image.
    """

    image_800: AnyArray
    image_850: AnyArray
    corner_px: Floats


def aligned_patch(
    image_800: AnyArray,
    image_850: AnyArray,
    centre_px: Floats,
    half_extent_px: Floats,
    motion_px: Floats,
    saturation_dn: float,
) -> AlignedPatch:
    """Cut out one marker's surroundings and move the 800 nm piece by bilinear interpolation.

    Parameters
    ----------
    image_800, image_850 : (height, width) arrays, DN
    centre_px, half_extent_px : (2,) arrays, px
        Of the marker's outline.
    motion_px : (2,) array, px
        From the 800 nm exposure to the 850 nm one.
    saturation_dn : float, DN
        A pixel that a saturated one is moved into counts as saturated.
    """
    reach = half_extent_px + WINDOW_MARGIN_PX + SPARE_PX
    height, width = image_800.shape
    low = np.clip(np.floor(centre_px - reach), 0, [width - 1, height - 1]).astype(int)
    high = np.clip(np.ceil(centre_px + reach) + 1, low + 1, [width, height]).astype(int)
    part = (slice(low[1], high[1]), slice(low[0], high[0]))
    before = image_800[part].astype(np.float64)
    by_row_and_column = motion_px[::-1]
    moved = ndimage.shift(before, by_row_and_column, order=1, mode="nearest")
    full = (before >= saturation_dn).astype(np.float64)
    if full.any():
        touched = ndimage.shift(full, by_row_and_column, order=1, mode="nearest") > 0.0
        moved = np.where(touched, np.maximum(moved, saturation_dn), moved)
    return AlignedPatch(moved, image_850[part], low.astype(np.float64))
