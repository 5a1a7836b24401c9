"""A frame with the tracks seen in it: those that are points of the shape, those that are not.

Behind each point lies where it was in the images before, as far as they are given.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.pictures.frame_record import FrameRecord
from bench.pictures.marks import Layer
from bench.pictures.wireframe_overlay import ESTIMATE_GREEN, MARGIN, Canvas, Window
from bench.report.numbers import number
from bench.scoring.judgement import NO_REASON
from models.arrays import Floats
from models.frame import IMAGE

UNUSED_RED = (255, 77, 64)
TRAIL_BLUE = (96, 165, 250)
LEAST_SIDE = 0.25  # of the image's width, that a close view shows


def overlay(record: FrameRecord, width_px: int) -> NDArray[np.uint8]:
    """Return the part of a frame that holds the tracks, marked; all of it without any.

    Parameters
    ----------
    record : FrameRecord
    width_px : int, px

    Returns
    -------
    (height, width_px, 3) uint8 array
        RGB.
    """
    return with_trails(record, [], width_px)


def with_trails(
    record: FrameRecord, before: Sequence[FrameRecord], width_px: int
) -> NDArray[np.uint8]:
    """Return the same with where the points came from.

    Parameters
    ----------
    record : FrameRecord
    before : sequence of FrameRecord
        Frames before it, the last one last.
    width_px : int, px

    Returns
    -------
    (height, width_px, 3) uint8 array
        RGB.
    """
    found = None if record.estimate is None else record.estimate.detections
    window = None if found is None else _window(found.points_px, record.camera.width)
    canvas = Canvas.of(record.image(IMAGE), record.detector, width_px, window)
    if found is None:
        return canvas.picture
    last = dict(zip(found.marker, found.points_px, strict=True))
    for each in reversed(before):
        if each.estimate is None:
            continue
        earlier = each.estimate.detected
        there = dict(zip(earlier.marker, earlier.points_px, strict=True))
        for name in last.keys() & there.keys():
            canvas.line(last[name], there[name], TRAIL_BLUE)
        last = {name: there.get(name, point) for name, point in last.items()}
    for pixel, used in zip(found.points_px, found.used, strict=True):
        canvas.circle(pixel, ESTIMATE_GREEN if used else UNUSED_RED)
    return canvas.picture


def layers(record: FrameRecord) -> list[Layer]:
    """Return the tracks of a frame: those that go by no point of the shape are dim."""
    if record.estimate is None or record.estimate.detections is None:
        return []
    found = record.estimate.detections
    dim = tuple(not used for used in found.used)
    return [Layer("tracks", False, "circle", tuple(found.points_px), dim=dim)]


def verdict(record: FrameRecord) -> str:
    """Say in one line what the pipeline did, and how far off its distance is."""
    said = record.estimate
    if said is None:
        return "not estimated"
    if said.pose is None:
        return f"{said.mode or 'no pose'}: {said.reason or NO_REASON}"
    told = (
        f"{said.mode}: {len(said.detected.marker)} tracks, {sum(said.detected.used)} of the shape"
    )
    if record.true_range_m is None:
        return told
    own_m = float(np.linalg.norm(said.pose.cam_from_target.translation))
    off = 100.0 * (own_m / record.true_range_m - 1.0)
    return f"{told}; distance {number(off, 2, signed=True)} %"


def _window(points_px: Floats, width: int) -> Window | None:
    if len(points_px) < 2:
        return None
    low, high = points_px.min(axis=0), points_px.max(axis=0)
    side = max(float((high - low).max()) * (1.0 + 2.0 * MARGIN), LEAST_SIDE * width)
    left, top = (0.5 * (low + high) - 0.5 * side).tolist()
    return left, top, side
