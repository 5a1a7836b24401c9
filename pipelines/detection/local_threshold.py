"""Detection with a threshold for each blob: half of its own height above its own background.

A low threshold, a small share of the brightest unsaturated difference but above the noise, finds
seeds. Each seed is then cut at half of its own height, so that a marker in full lamp light or in
the Sun does not raise the threshold of one at the edge of the beam or in shadow, and a thin line
of residual motion that touches a marker is cut off. At half height a blob has its disc's area.
"""

from __future__ import annotations

import cv2
import numpy as np

from models.arrays import Floats, Image, Mask
from models.sensors.camera_chip import Detector
from pipelines.detection.blobs import Blobs, find_blobs
from pipelines.detection.candidates import Candidates
from pipelines.detection.centroids import weighted_centroids
from pipelines.detection.circularity import circularity
from pipelines.detection.detection_options import DetectionOptions
from pipelines.detection.image_difference import Region, saturated, signed_difference
from pipelines.detection.image_pair import ImagePair

SEED_SHARE = 0.25  # of tau_bin: the seeds' threshold is 5 % of the brightest difference
SEED_SIGMAS = 6.0
SAMPLE_STRIDE = 8  # pixels from one noise sample to the next
LEAST_AREA, LARGEST_AREA = 0.4, 2.5  # over the smallest and largest expected disc
MOST_SEEDS = 150  # looked at in one region, brightest first
MARGIN_PX = 4  # seen round a seed


def _seed_threshold_dn(
    difference: Floats, excluded: Mask | None, detector: Detector, tau_bin: float
) -> float:
    stride = SAMPLE_STRIDE if difference.size > 100_000 else 1
    sample = difference[::stride, ::stride]
    spread = 1.4826 * float(np.median(np.abs(sample - np.median(sample))))
    dark = float(np.sqrt(2.0) * detector.noise_dn(np.array(detector.bias_dn)))
    # A maximum over a copy: excluded pixels are few, and most images have none.
    shown = difference if excluded is None else np.where(excluded, 0.0, difference)
    return max(SEED_SHARE * tau_bin * float(shown.max()), SEED_SIGMAS * max(spread, dark))


def _cut_at_half_height(
    difference: Floats,
    own: Mask,
    rim: Mask,
    areas_px: tuple[float, float],
    options: DetectionOptions,
) -> Candidates:
    """Cut one seed's crop at half height; usually one blob is left, rarely more.

    A blob that reaches the region's ``rim`` goes on beyond it: another region shows it whole.
    """
    inside = np.sort(difference[own])[::-1]
    # Half of the smallest expected disc is brighter than this, whatever else hangs on the seed.
    peak = float(inside[min(int(0.5 * areas_px[0]), len(inside) - 1)])
    outside = difference[~own]
    background = float(np.median(outside)) if len(outside) else 0.0
    blobs = find_blobs(own & (difference > background + 0.5 * (peak - background)))
    area_fits = (blobs.area_px >= LEAST_AREA * areas_px[0]) & (
        blobs.area_px <= max(LARGEST_AREA * areas_px[1], areas_px[1] + 8.0)
    )
    on_rim = np.bincount(blobs.label, rim[blobs.rows, blobs.columns], minlength=len(blobs)) > 0.0
    blobs = blobs.kept(area_fits & ~on_rim)
    blobs = blobs.kept(np.asarray(circularity(blobs, options.perimeter) >= options.tau_circ))
    light = np.maximum(difference - background, 0.0)
    grown = _grown(blobs)  # the threshold cuts off light unevenly; a rim of one pixel has it all
    return Candidates(weighted_centroids(grown if len(grown) == len(blobs) else blobs, light))


def _inner_rim(region: Region, image: Image) -> Mask:
    """Tell which pixels of a region are its outermost; the image's own edge is none of it."""
    rim = np.zeros((region.bottom - region.top, region.right - region.left), dtype=np.bool_)
    height, width = image.shape
    rim[0] |= region.top > 0
    rim[-1] |= region.bottom < height
    rim[:, 0] |= region.left > 0
    rim[:, -1] |= region.right < width
    return rim


def _grown(blobs: Blobs) -> Blobs:
    """Return the blobs with a rim of one pixel; fewer where rims touch."""
    if len(blobs) == 0:
        return blobs
    mask = np.zeros(blobs.foreground.shape, np.uint8)
    mask[blobs.rows, blobs.columns] = 1
    return find_blobs(np.asarray(cv2.dilate(mask, np.ones((3, 3), np.uint8)) > 0))


def detect_in_region(
    pair: ImagePair,
    detector: Detector,
    region: Region,
    radii_px: tuple[float, float],
    options: DetectionOptions,
) -> Candidates:
    """Find candidate markers in a part of the image.

    Parameters
    ----------
    pair : ImagePair
    detector : Detector
    region : Region
        The whole image, or the surroundings of a predicted marker.
    radii_px : tuple of float, px
        Smallest and largest radius that a marker's image may have.
    options : DetectionOptions
    """
    if region.pixels == 0:
        return Candidates.none()
    difference = signed_difference(pair, region)
    excluded = saturated(pair, detector, region)
    threshold = _seed_threshold_dn(difference, excluded, detector, options.tau_bin)
    areas_px = (np.pi * radii_px[0] ** 2, np.pi * radii_px[1] ** 2)
    seeds = find_blobs(difference > threshold)
    seeds = seeds.kept(seeds.area_px >= LEAST_AREA * areas_px[0])
    if len(seeds) == 0:
        return Candidates.none()

    rim = _inner_rim(region, pair.image_850)
    boxes = seeds.bounding_boxes()
    light = np.bincount(seeds.label, weights=difference[seeds.rows, seeds.columns])
    order = np.argsort(seeds.label, kind="stable")
    starts = np.concatenate([[0], np.cumsum(seeds.area_px)]).astype(np.int64)
    found = []
    for index in np.argsort(-light, kind="stable")[:MOST_SEEDS]:
        top, bottom, left, right = boxes[index]
        top, left = max(top - MARGIN_PX, 0), max(left - MARGIN_PX, 0)
        near = np.s_[top : bottom + MARGIN_PX + 1, left : right + MARGIN_PX + 1]
        crop = difference[near]
        pixels = order[starts[index] : starts[index + 1]]
        own = np.zeros(crop.shape, dtype=np.bool_)
        own[seeds.rows[pixels] - top, seeds.columns[pixels] - left] = True
        cut = _cut_at_half_height(crop, own, rim[near], areas_px, options)
        origin = region.origin_px + np.array([left, top])
        found.append(Candidates(cut.points_px + origin))
    return Candidates.merged(found, same_px=1.0)
