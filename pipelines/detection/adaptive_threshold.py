"""A threshold of each pixel's own, from the mean of its neighbourhood: MATLAB's ``adaptthresh``.

For a bright foreground ``T = (1.6 - s) m`` with m the mean over an odd window and s the
sensitivity; the image goes on beyond its border as at it (replicate), levels are scaled to [0, 1]
and T is held there. Two traps: in the middle of a disc as wide as the window the mean is near the
level itself, so that with s = 0.3 the disc gets a hole; and a saturated pixel is not above a T of
1. Small holes are filled, and a saturated pixel counts where T is 1.

Source of the use: Opromolla et al. 2022, equation 16.
"""

from __future__ import annotations

import cv2
import numpy as np

from models.arrays import Mask, Radiance


def ceil_odd(value: float) -> int:
    """Return the least odd integer that is not below a value, at least 1."""
    return max(1, 2 * int(np.ceil(0.5 * (value - 1.0))) + 1)


def adaptive_threshold(grey: Radiance, window: tuple[int, int], sensitivity: float) -> Radiance:
    """Return the threshold of each pixel, (height, width), in [0, 1].

    Parameters
    ----------
    grey : (height, width) float32 array
        Levels in [0, 1].
    window : tuple of 2 odd int, px
        Width and height of the neighbourhood.
    sensitivity : float
        In [0, 1]; more makes more of the image foreground.
    """
    mean = cv2.blur(grey, window, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(np.clip(np.float32(1.6 - sensitivity) * mean, 0.0, 1.0))


def above_threshold(grey: Radiance, threshold: Radiance) -> Mask:
    """Return the foreground, (height, width): above the threshold, or saturated where that is 1."""
    return np.asarray((grey > threshold) | (grey >= 1.0))


def without_holes(foreground: Mask, most_px: float) -> Mask:
    """Fill the holes of a foreground, but none that is large.

    A board in a bright surround is a hole, too, and stays one.

    Parameters
    ----------
    foreground : (height, width) array of bool
    most_px : float, px
        Pixels of the largest hole that is filled.

    Returns
    -------
    (height, width) array of bool
    """
    count, label, stats, _ = cv2.connectedComponentsWithStats(
        (~foreground).astype(np.uint8), connectivity=4
    )
    small = stats[:, cv2.CC_STAT_AREA] <= most_px
    small[0] = False  # the foreground itself
    left, top = stats[:, cv2.CC_STAT_LEFT], stats[:, cv2.CC_STAT_TOP]
    right, bottom = left + stats[:, cv2.CC_STAT_WIDTH], top + stats[:, cv2.CC_STAT_HEIGHT]
    height, width = foreground.shape
    small &= (left > 0) & (top > 0) & (right < width) & (bottom < height)
    if not small[1:count].any():
        return foreground
    return np.asarray(foreground | small[label])
