"""The pixels round one predicted disc, and what their noise is."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import AnyArray, Floats, Mask
from models.sensors.camera_chip import Detector

WINDOW_MARGIN_PX = 3.0  # background seen round the outline


@dataclass(frozen=True, eq=False)
class DiscWindow:
    """A rectangle of both images.

    Attributes
    ----------
    x, y : (1, width + 2) and (height + 2, 1) arrays, px
        Columns and rows from the predicted centre, with one more on each side.
    level_800 : (height, width) array, DN
    difference : (height, width) array, DN
        850 nm minus 800 nm, signed.
    usable : (height, width) array of bool
        Not saturated; at 800 nm, where a marker is dark and only a glint saturates, nor beside
        such a pixel.
    """

    x: Floats
    y: Floats
    level_800: Floats
    difference: Floats
    usable: Mask

    def variance(self, model: Floats, background: float, detector: Detector) -> Floats:
        """Return the variance of the difference, DN^2: both images' noise and pixel response.

        The 850 nm level is taken from the model, not from the pixel, whose own noise would
        otherwise weigh it.

        Parameters
        ----------
        model : (height, width) array, DN
            The difference as the fit has it, background and all.
        background : float, DN
            Of the difference.
        detector : Detector

        Returns
        -------
        (height, width) array, DN^2
        """
        noise_800 = detector.noise_dn(self.level_800)
        noise_850 = detector.noise_dn(self.level_800 + np.maximum(model, 0.0))
        response = detector.prnu * np.maximum(model - background, 0.0)
        return noise_800**2 + noise_850**2 + response**2


def cut_window(
    image_800: AnyArray,
    image_850: AnyArray,
    area_centre_px: Floats,
    half_extent_px: Floats,
    saturation_dn: float,
) -> DiscWindow | None:
    """Cut out one disc's window; None where next to nothing of it lies in the image.

    Parameters
    ----------
    image_800, image_850 : (height, width) arrays, DN
    area_centre_px : (2,) array, px
        Predicted centre of the disc's area.
    half_extent_px : (2,) array, px
        Half width and half height of the disc's image.
    saturation_dn : float, DN
        From here on a pixel counts as saturated.
    """
    reach = half_extent_px + WINDOW_MARGIN_PX
    height, width = image_800.shape
    low = np.maximum(np.floor(area_centre_px - reach), 0.0).astype(int)
    high = np.minimum(np.ceil(area_centre_px + reach) + 1, [width, height]).astype(int)
    if (high - low < 3).any():
        return None
    part = (slice(low[1], high[1]), slice(low[0], high[0]))
    level_800 = image_800[part].astype(np.float64)
    level_850 = image_850[part].astype(np.float64)
    return DiscWindow(
        x=np.arange(low[0] - 1, high[0] + 1)[None, :] - area_centre_px[0],
        y=np.arange(low[1] - 1, high[1] + 1)[:, None] - area_centre_px[1],
        level_800=level_800,
        difference=level_850 - level_800,
        usable=(level_850 < saturation_dn) & ~_with_rim(level_800 >= saturation_dn),
    )


def _with_rim(mask: Mask) -> Mask:
    if not mask.any():
        return mask
    return np.asarray(cv2.dilate(mask.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0)
