"""The threshold on the difference image: tau_bin of its maximum, Otsu's, or the larger.

The paper names both Otsu's method and tau_bin (section 3.1.1). What it tells of case S7, where
sunlit markers raise the threshold, fits ``T = tau_bin * max(difference)``, the default here.
Saturated pixels and their rim never set a threshold.
"""

from __future__ import annotations

import cv2
import numpy as np

from models.arrays import Floats, Image, Mask
from pipelines.detection.detection_options import ThresholdRule

LEVELS = 65536


def histogram(difference: Image, excluded: Mask | None = None) -> Floats:
    """Count the levels of a uint16 image, (65536,), leaving out the excluded pixels."""
    mask = None if excluded is None else np.where(excluded, 0, 255).astype(np.uint8)
    counts = cv2.calcHist([difference], [0], mask, [LEVELS], [0, LEVELS])
    return np.asarray(counts, dtype=np.float64).reshape(-1)


def otsu_threshold(counts: Floats) -> float:
    """Return the level that best parts a histogram in two: T, foreground being above it.

    Otsu 1979, "A threshold selection method from gray-level histograms".

    Parameters
    ----------
    counts : (levels,) array
        Pixels at each level, from 0.
    """
    levels = np.flatnonzero(counts)
    if len(levels) < 2:
        return float(levels[0]) if len(levels) else 0.0
    weights = counts[levels]
    below = np.cumsum(weights)[:-1]
    above = weights.sum() - below
    first = np.cumsum(weights * levels)
    mean_below = first[:-1] / below
    mean_above = (first[-1] - first[:-1]) / above
    between = below * above * (mean_above - mean_below) ** 2
    return float(levels[:-1][int(np.argmax(between))])


def threshold_dn(
    difference: Image, excluded: Mask | None, tau_bin: float, rule: ThresholdRule
) -> float:
    """Return the global threshold, DN; a pixel above it is foreground.

    Parameters
    ----------
    difference : (height, width) uint16 array, DN
    excluded : (height, width) array of bool, or None
        Saturated pixels.
    tau_bin : float
    rule : str
    """
    counts = histogram(difference, excluded)
    levels = np.flatnonzero(counts)
    fraction = tau_bin * float(levels[-1]) if len(levels) else 0.0
    if rule == "fraction_of_max":
        return fraction
    otsu = otsu_threshold(counts)
    return otsu if rule == "otsu" else max(otsu, fraction)


def binarise(difference: Image, threshold: float) -> Mask:
    """Return the foreground, (height, width): what is above the threshold, DN.

    Parameters
    ----------
    difference : (height, width) array, DN
    threshold : float, DN
    """
    return np.asarray(cv2.compare(difference, float(threshold), cv2.CMP_GT) > 0)
