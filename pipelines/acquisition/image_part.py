"""The part of an image that holds the target, with a camera of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from models.arrays import Floats, Image
from models.camera import Camera
from models.sensors.camera_chip import Detector
from pipelines.acquisition.from_image import reduced
from pipelines.detection.edge_map import find_edges
from pipelines.detection.target_region import TargetRegion, find_target
from pipelines.tracking.edge_fit import EdgeImage

MARGIN_SHARE, MARGIN_PX = 0.8, 24  # of the lit part's size, that is kept round it


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
    row, column = np.nonzero(target.lit)
    margin = int(MARGIN_SHARE * max(np.ptp(row), np.ptp(column))) + MARGIN_PX
    top, left = max(0, int(row.min()) - margin), max(0, int(column.min()) - margin)
    rows = slice(top, int(row.max()) + margin + 1)
    columns = slice(left, int(column.max()) + margin + 1)
    part = TargetRegion(
        np.ascontiguousarray(target.signal[rows, columns]),
        np.ascontiguousarray(target.stretched[rows, columns]),
        np.ascontiguousarray(target.lit[rows, columns]),
        target.sky_sigma_dn,
        target.knee_dn,
        target.saturated,
    )
    height, width = part.signal.shape
    own = replace(small, width=width, height=height, cx=small.cx - left, cy=small.cy - top)
    return EdgeImage(part, find_edges(part, detector), own)


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
