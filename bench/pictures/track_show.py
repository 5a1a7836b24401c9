"""One image of an unknown target laid open: its tracks, as large as a screen takes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.pictures.frame_record import FrameRecord
from bench.pictures.track_picture import overlay

PICTURE_PX = 1200


def draw(record: FrameRecord) -> NDArray[np.uint8]:
    """Draw an image laid open, (height, width, 3), RGB."""
    return overlay(record, PICTURE_PX)
