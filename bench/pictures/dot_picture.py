"""A colour image with its marks, whole and laid open."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from bench.pictures import marker_overlay
from bench.pictures.frame_record import FrameRecord
from bench.pictures.marker_overlay import markers_of
from bench.pictures.pair_show import Part, draw_signals
from models.arrays import Floats
from models.frame import IMAGE
from models.sensors.bayer_mosaic import BANDS
from pipelines.detection.region_of_interest import region_of_interest
from pipelines.eye_in_hand.options import options_for

WHITE = np.array([1.0 / (band.transmission * band.middle_nm) for band in BANDS])
"""What makes sunlit white grey: roughly as much power in each band, and electrons as its length."""


def colour_signal(record: FrameRecord) -> Floats:
    """Return red, green and blue of a raw image, (height, width, 3), DN above the bias."""
    raw = record.image(IMAGE)
    if record.detector.mosaic == "none":
        return np.repeat(raw.astype(np.float64)[..., None] - record.detector.bias_dn, 3, axis=2)
    colours = cv2.cvtColor(raw, cv2.COLOR_BayerRGGB2RGB).astype(np.float64)
    return np.asarray((colours - record.detector.bias_dn) * (WHITE / WHITE.max()))


def signals(record: FrameRecord) -> dict[str, Floats]:
    """Return a frame's image by its name, (height, width, 3), see ``colour_signal``."""
    return {"colour": colour_signal(record)}


def overlay(record: FrameRecord, width_px: int) -> NDArray[np.uint8]:
    """Return a frame as a picture in colour with its marks, (height, width_px, 3), RGB."""
    return marker_overlay.overlay(record, width_px, colour_signal(record))


def draw(record: FrameRecord) -> NDArray[np.uint8]:
    """Draw an image laid open, (height, width, 3), RGB: as taken, with marks, and dot by dot.

    Beside them the region of interest (equation 15) round the dots, those that are lost named.
    """
    signal = colour_signal(record)
    grey = np.asarray(signal @ np.full(3, 1.0 / 3.0))
    by_outline = record.estimate is not None and record.estimate.mode == "outline"
    return draw_signals(
        record,
        {"as taken": signal, "with marks": signal},
        grey,
        _region(record, signal),
        "; by the board's outline" if by_outline else "",
    )


def _region(record: FrameRecord, signal: Floats) -> Part | None:
    if record.best_known_pose is None:
        return None
    told = options_for("paper")
    places = record.camera.project(record.best_known_pose @ markers_of(record).points_in_target)
    region = region_of_interest(record.camera, places, (told.s_x, told.s_y))
    return None if region is None else Part("region of interest", region, signal)
