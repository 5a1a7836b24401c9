"""Fine detail of an image: what is drawn on a surface, without the light that slides over it.

Highlights, terminators and shading move over a turning body and are places of none; they are
smooth. Seams, cells and corners are not. So features are looked for, and followed, in what a
narrow high pass leaves of the image, and where that has structure both ways: along the rim of a
ring one place looks like the next.
"""

from __future__ import annotations

import cv2
import numpy as np

from models.arrays import Labels, Mask
from pipelines.detection.target_region import TargetRegion

SMOOTH_PX = 2.5  # what is smoother than this is light, not surface
MIDDLE = 128.0
CONTRAST_GREY = 127.0  # of the strongest details, but for one in a thousand
BLOCK_PX = 5
EDGE_RATIO = 0.2  # of the two slopes squared: below, it is an edge
OVER_SURFACE = 8.0  # times the median over the target, where most of the surface is plain; or
OF_BEST = 0.05  # of the best places, where it is not


def fine_detail(region: TargetRegion) -> Labels:
    """Return eight bits of fine detail about a middle grey, (height, width).

    The root of a signal has the same noise everywhere (Anscombe 1948): a logarithm, which shows
    what lies in shadow, shows its noise as well, and noise has corners.

    Parameters
    ----------
    region : TargetRegion
    """
    floor = 4.0 * region.sky_sigma_dn
    root = np.sqrt(np.maximum(region.signal, 0.0) + floor)
    detail = root - cv2.GaussianBlur(root, (0, 0), SMOOTH_PX)
    top = max(float(np.percentile(np.abs(detail[region.lit]), 99.0)), 1e-3) if region else 1.0
    grey = MIDDLE + CONTRAST_GREY / top * detail
    return np.asarray(np.clip(grey, 0.0, 255.0).astype(np.uint8))


def has_corners(grey: Labels, lit: Mask) -> Mask:
    """Tell where an image of fine detail has structure both ways, (height, width).

    Parameters
    ----------
    grey : (height, width) uint8 array
    lit : (height, width) array of bool
        The target's pixels.
    """
    if not lit.any():
        return np.zeros(grey.shape, dtype=bool)
    found = cv2.cornerEigenValsAndVecs(grey, BLOCK_PX, 3)
    large, small = found[..., :2].max(axis=2), found[..., :2].min(axis=2)
    plain, best = np.quantile(small[lit], (0.5, 0.99))
    least = min(OVER_SURFACE * plain, OF_BEST * best)
    return np.asarray((small > EDGE_RATIO * large) & (small > least))
