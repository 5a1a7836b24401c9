"""A dozen frames of a dataset, small, with their marks, as JPEGs that a page can hold."""

from __future__ import annotations

import base64
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from bench.pictures.frame_record import FrameRecords

MOST_FRAMES = 12
FRAME_WIDTH_PX = 760
HERO_WIDTH_PX = 1200
QUALITY = 82
LARGEST_EXCESS = 1.3


@dataclass(frozen=True)
class Picture:
    """One frame of the page.

    Attributes
    ----------
    source : str
        A ``data:`` address; empty where the frame has no picture.
    title, verdict : str
    lost : bool
    """

    source: str
    title: str
    verdict: str
    lost: bool


def filmstrip(records: FrameRecords, wanted: list[int]) -> list[Picture]:
    """Choose frames evenly in time, the first of those wanted among them, and draw them."""
    return [picture(records, index) for index in chosen(records.dataset.indices, wanted)]


def chosen(indices: list[int], wanted: list[int]) -> list[int]:
    """Return at most twelve frames: up to four of those wanted, the others evenly spread."""
    asked = [index for index in wanted if index in set(indices)][: MOST_FRAMES // 3]
    room = min(MOST_FRAMES, len(indices)) - len(asked)
    others = [index for index in indices if index not in asked]
    spread = np.linspace(0, len(others) - 1, room).round().astype(int).tolist()
    return sorted([*asked, *(others[place] for place in dict.fromkeys(spread))])


def picture(records: FrameRecords, index: int, width_px: int = FRAME_WIDTH_PX) -> Picture:
    """Draw one frame, as its chain does.

    Parameters
    ----------
    records : FrameRecords
    index : int
    width_px : int, px
        Wanted; a small image is drawn with whole pixels.
    """
    record = records.record(index)
    words = [f"frame {record.frame.index}", f"{record.frame.time_s:z.1f} s"]
    if record.true_range_m is not None:
        words.append(f"{record.true_range_m:.2f} m")
    camera = records.onboard.camera
    width = width_px if camera is None else _fitting_width(camera.width, width_px)
    drawn = records.chain.picture(record, width)
    return Picture(
        source="" if drawn is None else jpeg(drawn),
        title=" · ".join(words),
        verdict=records.chain.verdict(record),
        lost=not record.estimate,
    )


def _fitting_width(image_px: int, wanted_px: int) -> int:
    """Return the width wanted, or for a smaller image a whole multiple of its own near it."""
    if image_px >= wanted_px:
        return wanted_px
    return image_px * max(1, int(LARGEST_EXCESS * wanted_px / image_px))


def jpeg(image: NDArray[np.uint8]) -> str:
    """Return an RGB image, (height, width, 3), as a ``data:`` address.

    Raises
    ------
    ValueError
        If OpenCV refuses it.
    """
    ok, data = cv2.imencode(".jpg", image[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    if not ok:
        raise ValueError(f"expected OpenCV to encode an image of shape {image.shape}, it refused")
    return "data:image/jpeg;base64," + base64.b64encode(data.tobytes()).decode()
