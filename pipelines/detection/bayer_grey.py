"""A grey image of what a chip behind Bayer's filters has taken.

``demosaiced_grey`` is the plain way: bilinear interpolation, then the luma of ITU-R BT.601, as
MATLAB's ``demosaic`` and ``rgb2gray`` are used. ``quad_grey`` averages each two by two pixels: half
the resolution, nothing invented. Both are in DN above the bias.
"""

from __future__ import annotations

import cv2
import numpy as np

from models.arrays import Image, Radiance
from models.sensors.camera_chip import Detector

LUMA = (0.299, 0.587, 0.114)  # red, green, blue


def demosaiced_grey(raw: Image, detector: Detector) -> Radiance:
    """Return the luma at every pixel, (height, width) float32, DN above the bias.

    Parameters
    ----------
    raw : (height, width) uint16 array, DN
        Behind the filters that ``detector.mosaic`` names, or none; its first pixel is a red one.
    detector : Detector
    """
    grey = np.float32(-detector.bias_dn)
    if detector.mosaic == "none":
        return raw.astype(np.float32) + grey
    colours = cv2.cvtColor(raw, cv2.COLOR_BayerRGGB2RGB).astype(np.float32)
    return np.asarray(cv2.transform(colours, np.array([LUMA], np.float32)) + grey)


def quad_grey(raw: Image, detector: Detector) -> Radiance:
    """Return the mean of each two by two pixels, (height // 2, width // 2) float32, DN above bias.

    The quad (i, j) has its middle at pixel (2 i + 0.5, 2 j + 0.5) of the image.
    """
    height, width = raw.shape[0] // 2, raw.shape[1] // 2
    even = np.ascontiguousarray(raw[: 2 * height, : 2 * width])
    small = cv2.resize(even.astype(np.float32), (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(small - np.float32(detector.bias_dn))
