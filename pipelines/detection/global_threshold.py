"""Detection as the paper prints it: one threshold for the whole image (section 3.1.1)."""

from __future__ import annotations

import numpy as np

from models.camera import Camera
from models.sensors.camera_chip import Detector
from pipelines.detection.area_opening import area_threshold_px, open_areas
from pipelines.detection.binarisation import binarise, threshold_dn
from pipelines.detection.blobs import find_blobs
from pipelines.detection.border_margin import border_margin_px, inside_margin
from pipelines.detection.candidates import Candidates
from pipelines.detection.centroids import weighted_centroids
from pipelines.detection.circularity import circularity
from pipelines.detection.detection_options import DetectionOptions
from pipelines.detection.image_difference import clipped_difference, saturated
from pipelines.detection.image_pair import ImagePair


def detect_by_global_threshold(
    pair: ImagePair,
    camera: Camera,
    detector: Detector,
    radius_px: float,
    options: DetectionOptions,
) -> Candidates:
    """Find candidate markers: difference, threshold, area, circularity, centroid, border.

    Parameters
    ----------
    pair : ImagePair
    camera : Camera
    detector : Detector
    radius_px : float, px
        Expected radius of a marker's image (equation 4).
    options : DetectionOptions
    """
    difference = clipped_difference(pair)
    threshold = threshold_dn(
        difference, saturated(pair, detector), options.tau_bin, options.threshold_rule
    )
    blobs = find_blobs(binarise(difference, threshold))
    blobs = open_areas(blobs, area_threshold_px(radius_px, options.s_ao))
    blobs = blobs.kept(np.asarray(circularity(blobs, options.perimeter) >= options.tau_circ))
    found = Candidates(weighted_centroids(blobs, difference))
    margin = border_margin_px(radius_px, options.s_bord)
    return found.kept(inside_margin(found.points_px, camera, margin))
