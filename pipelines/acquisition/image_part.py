"""The part of an image that holds the target, with a camera of its own."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from models.arrays import Floats, Image, Mask
from models.camera import Camera
from models.sensors.camera_chip import Detector
from pipelines.acquisition.from_image import reduced
from pipelines.detection.edge_map import find_edges
from pipelines.detection.target_region import TargetRegion, find_target
from pipelines.tracking.edge_fit import EdgeImage

MARGIN_SHARE, MARGIN_PX = 0.8, 24  # of the lit part's size, that is kept round it
BLUR_SHARE, BLUR_PX = 0.03, 5  # dimmer by so much than what is so near (a window) may be its blur
OWN_SIGMAS = 1.0  # of the sky, above which a pixel and its neighbours shine in the mean


def cut_out(image: Image, camera: Camera, detector: Detector | None, width: int) -> EdgeImage:
    """Find the target in an image, reduced to ``width``, and its edges in the part round it.

    Parameters
    ----------
    image : (height, width) array, DN
    camera : Camera
    detector : Detector or None
        As calibrated.
    width : int, px

    Returns
    -------
    EdgeImage
        Of the part, with its own camera; of the whole where there is no target.
    """
    pixels, small = reduced(image, camera, width)
    target = find_target(pixels, detector)
    if not target:
        return EdgeImage(target, find_edges(target, detector), small)
    lit = _without_blur(target)
    row, column = np.nonzero(lit)
    margin = int(MARGIN_SHARE * max(np.ptp(row), np.ptp(column))) + MARGIN_PX
    top, left = max(0, int(row.min()) - margin), max(0, int(column.min()) - margin)
    rows = slice(top, int(row.max()) + margin + 1)
    columns = slice(left, int(column.max()) + margin + 1)
    part = TargetRegion(
        np.ascontiguousarray(target.signal[rows, columns]),
        np.ascontiguousarray(target.stretched[rows, columns]),
        np.ascontiguousarray(lit[rows, columns]),
        target.sky_sigma_dn,
        target.knee_dn,
        target.saturated,
    )
    height, width = part.signal.shape
    own = replace(small, width=width, height=height, cx=small.cx - left, cy=small.cy - top)
    return EdgeImage(part, find_edges(part, detector), own)


def _without_blur(target: TargetRegion) -> Mask:
    """Return what is lit without what only lies beside what is bright; all of it if none is left.

    The smoothing that finds faint faces among noise puts a rim of four pixels round bright ones,
    which is most of a small target.
    """
    own = cv2.blur(target.signal, (3, 3)) > OWN_SIGMAS * target.sky_sigma_dn
    nearby = cv2.dilate(target.signal, np.ones((BLUR_PX, BLUR_PX), np.uint8))
    kept = np.asarray(target.lit & own & (target.signal > BLUR_SHARE * nearby))
    return kept if kept.any() else target.lit


def lit_extent_rad(cut: EdgeImage) -> float:
    """Return how wide or high what shines is, whichever is more, rad; something does."""
    row, column = np.nonzero(cut.target.lit)
    return max(float(np.ptp(row)), float(np.ptp(column))) / cut.camera.fx


def phase_rad(cut: EdgeImage, sun_in_cam: Floats) -> float:
    """Return the angle between the Sun and the camera as the target sees them, rad.

    Parameters
    ----------
    cut : EdgeImage
        With something lit on it.
    sun_in_cam : (3,) array
        Unit vector towards the Sun.
    """
    row, column = np.nonzero(cut.target.lit)
    ray = cut.camera.rays(np.array([[column.mean(), row.mean()]]))[0]
    return float(np.arccos(np.clip(-ray @ sun_in_cam, -1.0, 1.0)))
