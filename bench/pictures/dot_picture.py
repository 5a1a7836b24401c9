"""A colour image with its marks, whole and laid open."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from bench.pictures import marker_overlay
from bench.pictures.frame_record import FrameRecord
from bench.pictures.pair_show import draw_signals
from models.arrays import Floats
from models.frame import IMAGE
from models.sensors.bayer_mosaic import BANDS

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
    """Draw an image laid open, (height, width, 3), RGB: as taken, with marks, and dot by dot."""
    signal = colour_signal(record)
    grey = np.asarray(signal @ np.full(3, 1.0 / 3.0))
    return draw_signals(record, {"as taken": signal, "with marks": signal}, grey)
