"""What a pipeline may see, and nothing else: the first brick of the truth wall.

A frame is what the sensors have given since the last one: readings by stream. A stream is one
sensor's: images of one band, rows of a table, or what another pipeline has estimated.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias, TypeVar

import numpy as np

from models.arrays import Floats, Image
from models.errors import DatasetError
from models.estimate import Estimate

IMAGE_800, IMAGE_850 = "image_800", "image_850"
IMAGE = "image"
POINTS = "points"
CHASER_ORBIT = "chaser_orbit"
RANGE = "range_finder"
"""The streams of the house. A chain of another package names its own."""
BRACKET = "image_bracket_"
"""How streams of further exposures of the image begin: of the same view, at the same time."""


@dataclass(frozen=True, eq=False)
class ImageReading:
    """One image.

    Attributes
    ----------
    image : (height, width) uint16 array, DN
    time_s : float, s
        Middle of the exposure, by the clock on board.
    exposure_ms : float, ms
    """

    image: Image
    time_s: float
    exposure_ms: float

    def __post_init__(self) -> None:
        if self.image.ndim != 2 or self.image.dtype != np.uint16:
            raise DatasetError(
                "expected an image as a (height, width) uint16 array, "
                f"got shape {self.image.shape} of {self.image.dtype}"
            )


@dataclass(frozen=True, eq=False)
class TableReading:
    """Rows that a sensor gave since the last frame, each with its time.

    Attributes
    ----------
    columns : tuple of str
        Names of the numbers, unit at the end: ``range_m``.
    time_s : (n,) array, s
        By the clock on board.
    rows : (n, len(columns)) array
    """

    columns: tuple[str, ...]
    time_s: Floats
    rows: Floats

    def __post_init__(self) -> None:
        expected = (len(self.time_s), len(self.columns))
        if self.rows.shape != expected or self.time_s.ndim != 1:
            raise DatasetError(
                f"expected rows of shape {expected}, one for each time and with the columns "
                f"{', '.join(self.columns)}, got {self.rows.shape}"
            )

    def column(self, name: str) -> Floats:
        """Return the numbers of one column, (n,).

        Raises
        ------
        DatasetError
            If there is none of that name.
        """
        if name not in self.columns:
            raise DatasetError(
                f"expected a column {name!r}, got a table of {', '.join(self.columns)}"
            )
        return self.rows[:, self.columns.index(name)]


Reading: TypeAlias = ImageReading | TableReading | Estimate
Kind = TypeVar("Kind", ImageReading, TableReading, Estimate)
NAMES = {ImageReading: "an image", TableReading: "a table", Estimate: "an estimate"}


@dataclass(frozen=True, eq=False)
class Frame:
    """The readings of all streams since the last frame, as a flight computer gets them.

    Attributes
    ----------
    index : int
        Number of the frame in its dataset.
    time_s : float, s
        To which an estimate is stamped, by the clock on board.
    readings : mapping of str to ImageReading, TableReading or Estimate
        By stream; a stream that gave nothing is absent.
    """

    index: int
    time_s: float
    readings: Mapping[str, Reading]

    def image(self, stream: str) -> ImageReading:
        """Return the image of a stream.

        Raises
        ------
        DatasetError
            If the frame has none of that name.
        """
        return self._reading(stream, ImageReading)

    def table(self, stream: str) -> TableReading:
        """Return the rows of a stream.

        Raises
        ------
        DatasetError
            If the frame has none of that name.
        """
        return self._reading(stream, TableReading)

    def estimate(self, stream: str) -> Estimate:
        """Return what another pipeline last estimated.

        Raises
        ------
        DatasetError
            If the frame has none of that name.
        """
        return self._reading(stream, Estimate)

    def _reading(self, stream: str, kind: type[Kind]) -> Kind:
        reading = self.readings.get(stream)
        if not isinstance(reading, kind):
            there = ", ".join(
                f"{name} ({NAMES.get(type(each), 'something else')})"
                for name, each in self.readings.items()
            )
            raise DatasetError(
                f"frame {self.index}: expected {NAMES[kind]} of the stream {stream!r}, "
                f"got {there or 'no reading at all'}"
            )
        return reading
