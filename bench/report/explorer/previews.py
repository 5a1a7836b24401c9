"""Frames as small JPEGs from which a page can still choose its greys, within a budget of bytes.

The grey levels are those of ``bench.pictures.stretch``, which can be undone: about a hundred of
the 256 levels lie below 2 % of full well, where structure is.
"""

from __future__ import annotations

import cv2
import numpy as np

from bench.pictures.stretch import stretch
from bench.report.filmstrip import jpeg
from models.arrays import Floats
from models.sensors.camera_chip import Detector

WIDTHS_PX = (2048, 1536, 1024, 768, 512, 384, 256)
LEAST_IN_ALL, MOST_IN_ALL, FOR_A_FRAME = 3_000_000, 16_000_000, 80_000  # bytes, as text
MOST_PREVIEWS = 400


class Previews:
    """Pictures of a dataset's frames.

    Parameters
    ----------
    frames : int
        How many there will be.
    detector : Detector
    streams : int
        Pictures of each.
    """

    def __init__(self, frames: int, detector: Detector, streams: int = 1) -> None:
        count = max(1, frames * streams)
        self.most_bytes = min(MOST_IN_ALL, max(LEAST_IN_ALL, FOR_A_FRAME * count)) // count
        self.detector = detector
        self._start: dict[str, int] = {}

    def preview(self, stream: str, signal_dn: Floats) -> str:
        """Return a picture as JPEG in base64, as wide as its share of the budget allows.

        Parameters
        ----------
        stream : str
            Whose pictures are alike.
        signal_dn : (height, width) or (height, width, 3) array, DN
            Above the bias.
        """
        height, width = signal_dn.shape[:2]
        single = signal_dn.astype(np.float32)
        widths = [width, *(each for each in WIDTHS_PX if each < width)]
        text = ""
        start = min(self._start.get(stream, 0), len(widths) - 1)
        for place in range(start, len(widths)):
            shape = (widths[place], max(1, round(height * widths[place] / width)))
            small = single
            if place > 0:
                small = cv2.resize(single, shape, interpolation=cv2.INTER_AREA)
            levels = np.rint(255.0 * stretch(small, self.detector)).astype(np.uint8)
            colours = levels if levels.ndim == 3 else np.repeat(levels[:, :, None], 3, axis=2)
            text = jpeg(colours).partition(",")[2]
            if len(text) <= self.most_bytes:
                break
        self._start[stream] = max(0, place - 1)  # the next is like this one: try one step wider
        return text


def shown_places(frames: int) -> set[int]:
    """Return which frames of so many get a picture: all, or evenly spread ones.

    Parameters
    ----------
    frames : int
    """
    if frames <= MOST_PREVIEWS:
        return set(range(frames))
    return set(np.linspace(0, frames - 1, MOST_PREVIEWS).round().astype(int).tolist())
