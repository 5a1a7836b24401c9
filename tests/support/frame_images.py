"""What a frame of a pair or of a single image shows, in one word."""

from __future__ import annotations

from pathlib import Path

from models.arrays import Image
from models.dataset.dataset import open_dataset
from models.frame import IMAGE, IMAGE_800, IMAGE_850, Frame, ImageReading


def stored_frames(folder: Path) -> list[Frame]:
    """Return the frames of a dataset."""
    return list(open_dataset(folder).frames())


def at_800(frame: Frame) -> Image:
    """Return the 800 nm image of a pair."""
    return frame.image(IMAGE_800).image


def at_850(frame: Frame) -> Image:
    """Return the 850 nm image of a pair."""
    return frame.image(IMAGE_850).image


def single(frame: Frame) -> Image:
    """Return the single image of a frame."""
    return frame.image(IMAGE).image


def exposed_ms(frame: Frame) -> float:
    """Return how long the images of a frame were exposed, which is one time for all."""
    (exposure_ms,) = {
        reading.exposure_ms
        for reading in frame.readings.values()
        if isinstance(reading, ImageReading)
    }
    return exposure_ms
