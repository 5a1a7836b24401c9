"""Detection as printed: region, grey, adaptive threshold, areas, circularity, centroids, border.

Opromolla et al. 2022, section 3.2: equations 15 and 16, then 3 to 7 as for the other camera. What
the print leaves open: holes that the threshold leaves in large dots are filled.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Image
from models.camera import Camera
from models.sensors.camera_chip import Detector
from pipelines.detection.adaptive_threshold import (
    above_threshold,
    adaptive_threshold,
    ceil_odd,
    without_holes,
)
from pipelines.detection.area_opening import area_threshold_px, open_areas
from pipelines.detection.bayer_grey import demosaiced_grey
from pipelines.detection.blobs import find_blobs
from pipelines.detection.border_margin import border_margin_px, inside_margin
from pipelines.detection.candidates import Candidates
from pipelines.detection.centroids import weighted_centroids
from pipelines.detection.circularity import circularity
from pipelines.detection.image_difference import Region, saturation_level_dn
from pipelines.detection.region_of_interest import region_of_interest
from pipelines.eye_in_hand.options import EyeInHandOptions


def detect_as_printed(
    raw: Image,
    camera: Camera,
    detector: Detector,
    predicted_px: Floats,
    radius_px: float,
    options: EyeInHandOptions,
) -> Candidates:
    """Find candidate dots.

    Parameters
    ----------
    raw : (height, width) uint16 array, DN
        Behind Bayer's filters.
    camera : Camera
    detector : Detector
    predicted_px : (n, 2) array, px
        The dots' centres by the guess.
    radius_px : float, px
        Expected radius of a dot's image (equation 4).
    options : EyeInHandOptions
    """
    region = region_of_interest(camera, predicted_px, (options.s_x, options.s_y))
    if region is None:
        return Candidates.none()
    # The mosaic's first pixel is a red one in the region, too.
    region = Region(region.top & ~1, region.bottom, region.left & ~1, region.right)
    grey = demosaiced_grey(np.ascontiguousarray(raw[region.part]), detector)
    full_dn = saturation_level_dn(detector) - detector.bias_dn
    level = np.clip(grey / np.float32(full_dn), 0.0, 1.0)
    window = ceil_odd(radius_px * options.s_cu), ceil_odd(radius_px * options.s_cv)
    foreground = above_threshold(level, adaptive_threshold(level, window, options.tau_s))
    blobs = find_blobs(without_holes(foreground, np.pi * radius_px**2))
    blobs = open_areas(blobs, area_threshold_px(radius_px, options.s_ao))
    blobs = blobs.kept(np.asarray(circularity(blobs, options.perimeter) >= options.tau_circ))
    found = Candidates(weighted_centroids(blobs, np.maximum(grey, 0.0)) + region.origin_px)
    margin = border_margin_px(radius_px, options.s_bord)
    return found.kept(inside_margin(found.points_px, camera, margin))
