"""Circles among the blobs of a raw image, where dots are predicted, as large as they may be."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from models.arrays import Image
from models.camera import Camera
from models.sensors.camera_chip import Detector
from pipelines.detection.adaptive_threshold import above_threshold, adaptive_threshold, ceil_odd
from pipelines.detection.bayer_grey import quad_grey
from pipelines.detection.dot_candidates import DotCandidates, find_dots
from pipelines.detection.image_difference import Region, saturation_level_dn
from pipelines.detection.marker_search import PredictedMarkers
from pipelines.detection.region_of_interest import region_of_interest
from pipelines.eye_in_hand.options import EyeInHandOptions

SCALE = 1.8  # of radii that are looked for at once


def circles_near(
    raw: Image,
    camera: Camera,
    detector: Detector,
    dots: PredictedMarkers,
    slack: float,
    options: EyeInHandOptions,
) -> DotCandidates:
    """Look for circles in the region of interest, at half the resolution.

    Parameters
    ----------
    raw : (height, width) uint16 array, DN
    camera, detector
    dots : PredictedMarkers
    slack : float, px
        How far from its prediction a dot may lie.
    options : EyeInHandOptions
    """
    region = region_of_interest(
        camera,
        dots.outlines.area_centres_px,
        (0.0, 0.0),
        float(slack + 3.0 * dots.radii_px[1]),
    )
    if region is None:
        return DotCandidates.none()
    region = Region(region.top & ~1, region.bottom, region.left & ~1, region.right)
    grey = quad_grey(raw[region.part], detector)
    full_dn = saturation_level_dn(detector) - detector.bias_dn
    level = np.clip(grey / np.float32(full_dn), 0.0, 1.0)
    faint = 6.0 * detector.read_noise_e / detector.gain_e_dn / full_dn
    expected = 0.5 * (dots.outlines.area_centres_px - region.origin_px - 0.5)
    found = DotCandidates.none()
    for low, middle, high in _scales(dots):
        window = (
            ceil_odd(0.5 * middle * options.s_cu),
            ceil_odd(0.5 * middle * options.s_cv),
        )
        threshold = adaptive_threshold(level, window, options.tau_s)
        foreground = above_threshold(level, np.maximum(threshold, np.float32(faint)))
        sizes, reach = (0.5 * low, 0.5 * high), 0.5 * float(slack)
        found = found.joined(find_dots(level, foreground, sizes, expected, reach))
    centres = 2.0 * found.centres + 0.5 + region.origin_px
    return DotCandidates(centres, 2.0 * found.radii, found.arcs)


def _scales(dots: PredictedMarkers) -> list[tuple[float, float, float]]:
    """Return least, middle and largest radii, px; one alone where the distance is well known."""
    low, high = dots.radii_px
    count = int(np.ceil(np.log(high / low) / np.log(SCALE)))
    if count <= 1:
        return [(low, dots.radius_px, high)]
    ends = low * (high / low) ** (np.arange(count + 1) / count)
    return [(a, float(np.sqrt(a * b)), b) for a, b in pairwise(ends.tolist())]
