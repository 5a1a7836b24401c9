"""Edge pixels of an image with their directions.

The steepness of the stretched image is counted in its own noise, so that an edge between two dim
faces is as good as one between two bright ones (Canny 1986 does the rest).
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import Mask, Radiance
from models.sensors.camera_chip import Detector
from pipelines.detection.target_region import TargetRegion

SMOOTHING_PX = 1.0
GRADIENT_NOISE = 0.2  # of the smoothed image's gradient, over that of independent pixels
NOISE_GATE = 4.0  # sigmas below which a gradient is noise
LEAST_GRADIENT = 0.02  # per px, of the stretched image: a step of 6 % in brightness
STRONG, WEAK = 2.0, 1.0  # Canny's thresholds, in units of the above
NEAR_TARGET_PX = 4.0


@dataclass(frozen=True, eq=False)
class EdgeMap:
    """Edges of one image.

    Attributes
    ----------
    smooth : (height, width) float32 array
        The stretched image, smoothed.
    edges : (height, width) array of bool
        Thin edges on the target.
    angle_rad : (height, width) float32 array
        Direction of the gradient, in [0, pi).
    noise : (height, width) float32 array
        Gradient of the smoothed image below which there is no edge.
    """

    smooth: Radiance
    edges: Mask
    angle_rad: Radiance
    noise: Radiance


def find_edges(target: TargetRegion, detector: Detector | None = None) -> EdgeMap:
    """Find the edges of the target.

    Parameters
    ----------
    target : TargetRegion
    detector : Detector, optional
        As calibrated, for its noise; without one the sky's noise is taken everywhere.
    """
    smooth = cv2.GaussianBlur(target.stretched, (0, 0), SMOOTHING_PX)
    level = np.sinh(smooth) * target.knee_dn
    if detector is None:
        noise_dn = np.full_like(level, target.sky_sigma_dn)
    else:
        noise_dn = detector.noise_dn(level + detector.bias_dn).astype(np.float32)
        noise_dn = np.maximum(noise_dn, target.sky_sigma_dn)
    noise = noise_dn / np.hypot(level, target.knee_dn)
    gate = np.maximum(NOISE_GATE * GRADIENT_NOISE * noise, LEAST_GRADIENT).astype(np.float32)
    gx = cv2.Scharr(smooth, cv2.CV_32F, 1, 0, scale=1.0 / 32.0)
    gy = cv2.Scharr(smooth, cv2.CV_32F, 0, 1, scale=1.0 / 32.0)
    scale = 1000.0 / gate
    thin = cv2.Canny(
        np.clip(gx * scale, -32000, 32000).astype(np.int16),
        np.clip(gy * scale, -32000, 32000).astype(np.int16),
        1000.0 * WEAK,
        1000.0 * STRONG,
        L2gradient=True,
    )
    reach = 2 * round(NEAR_TARGET_PX) + 1
    near = cv2.dilate(target.lit.astype(np.uint8), np.ones((reach, reach), np.uint8)) > 0
    angle = (np.arctan2(gy, gx) % np.pi).astype(np.float32)
    return EdgeMap(smooth, np.asarray((thin > 0) & near), angle, gate)
