"""A camera's automatic exposure: the next exposure time from the last image, and nothing else.

It meters as cameras do: a percentile of the levels (so that glints do not count) is held at a
share of the converter's range, in steps that are bounded, since an image that is saturated does not
say by how much.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Image
from models.sensors.camera_chip import Detector

AT_SATURATION = 0.98  # share of the range from which on a level may be cut off


@dataclass(frozen=True)
class AutoExposure:
    """How an image sets the exposure of the next.

    Attributes
    ----------
    percentile : float, percent
        The level that this share of the pixels stays below is what is metered.
    fill : float
        Where that level shall be, as a share from the bias to saturation.
    max_step : float
        Largest factor from one exposure to the next, either way.
    min_ms, max_ms : float, ms
        Shortest and longest exposure.
    """

    percentile: float = 99.9
    fill: float = 0.6
    max_step: float = 2.0
    min_ms: float = 0.01
    max_ms: float = 20.0

    def metered_dn(self, image: Image) -> float:
        """Return the metered level of a uint16 image, DN.

        It is the smallest level that at least the percentile's share of the pixels do not exceed.

        Parameters
        ----------
        image : (height, width) array, DN
        """
        counts = np.bincount(image.ravel())
        wanted = np.ceil(self.percentile / 100.0 * image.size)
        return float(np.searchsorted(np.cumsum(counts), wanted))

    def next_ms(self, exposure_ms: float, image: Image, detector: Detector) -> float:
        """Return the exposure time of the next image, ms.

        Parameters
        ----------
        exposure_ms : float, ms
            What ``image`` was exposed for.
        image : (height, width) uint16 array, DN
        detector : Detector
            As calibrated: its bias and saturation are used.
        """
        span = detector.saturation_dn - detector.bias_dn
        signal = self.metered_dn(image) - detector.bias_dn
        if signal >= AT_SATURATION * span:
            step = 1.0 / self.max_step
        else:
            dimmest = self.fill * span / self.max_step  # below it the step is the largest anyway
            step = self.fill * span / max(signal, dimmest)
        step = max(step, 1.0 / self.max_step)
        return float(np.clip(exposure_ms * step, self.min_ms, self.max_ms))
