"""Where the target is: what shines against black space, and how bright each place is in its noise.

The sky is black and most of it is empty, so its level and noise are read off the image. What is
lit only by the Earth is a hundred times dimmer than what the Sun lights; an inverse hyperbolic
sine shows both, linear within the noise and logarithmic above it (Lupton et al. 1999,
Astronomical Journal 118).
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import Image, Mask, Radiance
from models.sensors.camera_chip import Detector

KNEE_SIGMAS = 4.0  # of the sky's noise, where the stretch turns from linear to logarithmic
LIT_SIGMAS = 5.0  # of the smoothed sky's noise: none of a million sky pixels
SMOOTHING_PX = 1.2
LEAST_NOISE_DN = 0.3  # of any detector: rounding alone
LEAST_AREA = 3e-4  # of the image, and
LEAST_PIXELS = 120  # that many: two of the brightest stars in one cover fewer
SMALL_PART = 0.02  # of the largest one
NORMAL_MAD = 1.4826  # sigma of a normal distribution over its median absolute deviation
SMOOTHED_NOISE = 0.24  # of independent pixels' noise, after a Gaussian of 1.2 px


@dataclass(frozen=True, eq=False)
class TargetRegion:
    """An image as the detectors of corners and edges take it.

    Attributes
    ----------
    signal : (height, width) float32 array, DN
        Above the sky.
    stretched : (height, width) float32 array
        Inverse hyperbolic sine of the signal over ``knee_dn``.
    lit : (height, width) array of bool
        The target's pixels that shine; stars and noise are left out.
    sky_sigma_dn : float, DN
    knee_dn : float, DN
    saturated : float
        Share of the lit pixels at the converter's or the well's end.
    """

    signal: Radiance
    stretched: Radiance
    lit: Mask
    sky_sigma_dn: float
    knee_dn: float
    saturated: float

    def __bool__(self) -> bool:
        return bool(self.lit.any())


def find_target(image: Image, detector: Detector | None = None) -> TargetRegion:
    """Tell the lit target from space.

    Parameters
    ----------
    image : (height, width) uint16 array, DN
    detector : Detector, optional
        As calibrated: gives the least noise there can be, and what saturated means.

    Returns
    -------
    TargetRegion
        Falsy where nothing shines, or where the sky is so bright that nothing stands out of it.
    """
    pixels = image.astype(np.float32)
    sample = pixels[::3, ::3]
    sky = float(np.median(sample))
    least = LEAST_NOISE_DN
    if detector is not None:  # a target that fills the image is no sky
        least = float(detector.noise_dn(np.array([detector.bias_dn]))[0])
        sky = min(sky, detector.bias_dn + 3.0 * least)
    below = sample[sample <= sky]
    spread = NORMAL_MAD * float(np.median(sky - below)) if below.size else 0.0
    sigma = max(spread, least)
    signal = pixels - sky
    smooth = cv2.GaussianBlur(signal, (0, 0), SMOOTHING_PX)
    lit = _without_specks(smooth > LIT_SIGMAS * SMOOTHED_NOISE * sigma)
    knee = KNEE_SIGMAS * sigma
    top = float(np.iinfo(image.dtype).max) if detector is None else detector.saturation_dn
    saturated = float((pixels[lit] >= 0.999 * top).mean()) if lit.any() else 0.0
    return TargetRegion(signal, np.arcsinh(signal / knee), lit, sigma, knee, saturated)


def _without_specks(shining: Mask) -> Mask:
    """Leave out what is small: stars, hot pixels, and tracks of particles."""
    opened = cv2.morphologyEx(shining.astype(np.uint8), cv2.MORPH_OPEN, np.ones((2, 2), np.uint8))
    count, labels, stats, _ = cv2.connectedComponentsWithStats(opened, connectivity=8)
    if count < 2:
        return np.zeros_like(shining)
    areas = stats[:, cv2.CC_STAT_AREA].copy()
    areas[0] = 0
    largest = float(areas.max())
    if largest < max(LEAST_AREA * shining.size, LEAST_PIXELS):
        return np.zeros_like(shining)
    # What the dark cuts off from the largest part is still the target.
    keep = areas >= min(max(LEAST_AREA * shining.size, LEAST_PIXELS), SMALL_PART * largest + 12.0)
    keep[0] = False
    return np.asarray(keep[labels])
