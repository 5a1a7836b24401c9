"""The two images of a retroreflector pair, taken out of a frame."""

from __future__ import annotations

from dataclasses import dataclass

from models.arrays import Image
from models.errors import DatasetError
from models.frame import IMAGE_800, IMAGE_850, Frame


@dataclass(frozen=True, eq=False)
class ImagePair:
    """One pair, 800 nm lamps first.

    Attributes
    ----------
    image_800, image_850 : (height, width) uint16 arrays, DN

    Raises
    ------
    DatasetError
        If the two are not of one size.
    """

    image_800: Image
    image_850: Image

    def __post_init__(self) -> None:
        if self.image_800.shape != self.image_850.shape:
            raise DatasetError(
                "expected two images of one size, "
                f"got {self.image_800.shape} at 800 nm and {self.image_850.shape} at 850 nm"
            )


def image_pair(frame: Frame) -> ImagePair:
    """Return a frame's pair.

    Raises
    ------
    DatasetError
        If it lacks one of the two streams, or they are not of one size.
    """
    try:
        return ImagePair(frame.image(IMAGE_800).image, frame.image(IMAGE_850).image)
    except DatasetError as error:
        place = "" if str(error).startswith("frame ") else f"frame {frame.index}: "
        raise DatasetError(f"{place}{error}") from error
