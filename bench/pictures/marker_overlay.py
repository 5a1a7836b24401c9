"""Marks on a small picture of a frame: where markers were found, reprojected, and truly are.

Seen whole, the three lie within a pixel of each other, so they are drawn round one another: a red
circle for a detection, a green diamond for the reprojection with the estimated pose, four cyan
ticks for the truth. ``bench.pictures.pair_show`` draws the pixels themselves.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from bench.pictures.frame_record import FrameRecord
from bench.pictures.marks import Layer
from bench.pictures.stretch import stretch
from bench.report.numbers import number, numbers
from bench.scoring.judgement import NO_REASON
from models.arrays import AnyArray, Floats
from models.frame import IMAGE, IMAGE_800, IMAGE_850
from models.markers import MarkerPattern
from models.onboard import needed
from models.pose import pose_error

DETECTION_RED = (255, 77, 64)
LEFT_OUT_RED = (150, 62, 56)
REPROJECTION_GREEN = (74, 222, 96)
TRUTH_CYAN = (70, 214, 255)
SUBPIXEL_BITS = 4


def overlay(
    record: FrameRecord, width_px: int, signal_dn: Floats | None = None
) -> NDArray[np.uint8]:
    """Return a frame as a picture with its marks.

    Parameters
    ----------
    record : FrameRecord
    width_px : int, px
        Width of the picture; the image is averaged down to it.
    signal_dn : (height, width) or (height, width, 3) array, optional, DN
        What to draw the marks on; the last image less its bias unless given.

    Returns
    -------
    (height, width_px, 3) uint8 array
        RGB.
    """
    detector = record.detector
    if signal_dn is None:
        signal_dn = signal(record)
    scale = width_px / signal_dn.shape[1]
    grey = stretch(signal_dn, detector)
    height_px = round(signal_dn.shape[0] * scale)
    method = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_NEAREST
    small = cv2.resize(grey, (width_px, height_px), interpolation=method)
    picture = np.rint(255.0 * small).astype(np.uint8)
    if picture.ndim == 2:
        picture = np.repeat(picture[:, :, None], 3, axis=2)
    _draw_marks(picture, record, scale)
    return picture


def markers_of(record: FrameRecord) -> MarkerPattern:
    """Return the target's markers as surveyed."""
    return needed(record.onboard.markers, "markers.toml", "pictures of pairs")


def reprojections_px(record: FrameRecord) -> Floats | None:
    """Return the markers' centres by the estimated pose, (n, 2), px; None without one."""
    if record.estimate is None or record.estimate.pose is None:
        return None
    pose = record.estimate.pose.cam_from_target
    return record.camera.project(pose @ markers_of(record).points_in_target)


def verdict(record: FrameRecord) -> str:
    """Say in one line the pose error, or why there is no pose."""
    said = record.estimate
    if said is None:
        return "not estimated"
    if said.pose is None:
        return f"no pose: {said.reason or NO_REASON}"
    if record.truth is None:
        told = "a pose"
        if said.detections is not None:
            told = f"pose from {sum(said.detections.used)} markers"
        residual = said.pose.residual_rms_px
        return told if residual is None else f"{told}, residual {number(residual)} px rms"
    error = pose_error(said.pose.cam_from_target, record.truth.cam_from_target)
    x, y, z = numbers((1e3 * error.position_m).tolist(), signed=True)
    return f"position error {x}, {y}, {z} mm; attitude {number(error.attitude_deg)} deg"


def layers(record: FrameRecord) -> list[Layer]:
    """Return the marks of a frame: truth, reprojections and detections, those that there are."""
    found = []
    if record.truth is not None:
        seen = [
            pixel
            for pixel, visible in zip(record.truth.markers_px, record.truth.visible, strict=True)
            if visible > 0.0 and np.isfinite(pixel).all()
        ]
        found.append(Layer("truth", True, "ticks", tuple(seen)))
    reprojections = reprojections_px(record)
    if reprojections is not None:
        inside = record.camera.contains(np.nan_to_num(reprojections, nan=-1e9))
        names = np.array(markers_of(record).names)[inside]
        labels = tuple(str(name) for name in names)
        found.append(Layer("reprojections", False, "diamond", tuple(reprojections[inside]), labels))
    if record.estimate is not None:
        said = record.estimate.detected
        dim = tuple(marker < 0 for marker in said.marker)
        found.append(Layer("detections", False, "circle", tuple(said.points_px), dim=dim))
    return found


def signal(record: FrameRecord) -> Floats:
    """Return the last image of a frame less its bias, (height, width), DN."""
    stream = IMAGE_850 if IMAGE_850 in record.frame.readings else IMAGE
    return np.asarray(record.image(stream).astype(np.float64) - record.detector.bias_dn)


def signals(record: FrameRecord) -> dict[str, Floats]:
    """Return the images of a pair less their bias, (height, width), DN; that of the marks first."""
    bias_dn = record.detector.bias_dn
    return {
        name: np.asarray(record.image(stream).astype(np.float64) - bias_dn)
        for name, stream in (("850 nm", IMAGE_850), ("800 nm", IMAGE_800))
    }


def _draw_marks(picture: NDArray[np.uint8], record: FrameRecord, scale: float) -> None:
    reach = max(5.0, 0.011 * picture.shape[1])

    def at(pixel: Floats) -> Floats:
        return np.asarray((pixel + 0.5) * scale - 0.5)

    for layer in layers(record):
        for place, pixel in enumerate(layer.places_px):
            if layer.sign == "ticks":
                _ticks(picture, at(pixel), 1.7 * reach, 2.3 * reach, TRUTH_CYAN)
            elif layer.sign == "diamond":
                _diamond(picture, at(pixel), 1.55 * reach, REPROJECTION_GREEN)
                corner = at(pixel) + np.array([1.6, -1.3]) * reach
                _label(picture, layer.labels[place], corner)
            else:
                dim = layer.dim[place]
                colour = LEFT_OUT_RED if dim else DETECTION_RED
                _circle(picture, at(pixel), (0.6 if dim else 0.9) * reach, colour)


def _fixed(point: AnyArray) -> tuple[int, int]:
    x, y = np.rint(np.asarray(point) * 2**SUBPIXEL_BITS).astype(int)
    return int(x), int(y)


def _stroke(picture: Any) -> int:
    return max(1, round(picture.shape[1] / 800))


def _line(picture: Any, start: AnyArray, end: AnyArray, colour: tuple[int, int, int]) -> None:
    width = _stroke(picture)
    cv2.line(picture, _fixed(start), _fixed(end), colour, width, cv2.LINE_AA, SUBPIXEL_BITS)


def _circle(picture: Any, centre: Floats, radius: float, colour: tuple[int, int, int]) -> None:
    size = round(radius * 2**SUBPIXEL_BITS)
    width = _stroke(picture)
    cv2.circle(picture, _fixed(centre), size, colour, width, cv2.LINE_AA, SUBPIXEL_BITS)


def _diamond(picture: Any, centre: Floats, radius: float, colour: tuple[int, int, int]) -> None:
    corners = centre + radius * np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        _line(picture, start, end, colour)


def _ticks(
    picture: Any, centre: Floats, near: float, far: float, colour: tuple[int, int, int]
) -> None:
    for direction in np.array([[1, 0], [0, 1], [-1, 0], [0, -1]]):
        _line(picture, centre + near * direction, centre + far * direction, colour)


def _label(picture: Any, text: str, corner: Floats) -> None:
    place = (round(corner[0]), round(corner[1]))
    size = max(0.35, 0.00042 * picture.shape[1])
    for colour, width in (
        ((0, 0, 0), 3 * _stroke(picture)),
        (REPROJECTION_GREEN, _stroke(picture)),
    ):
        cv2.putText(
            picture, text, place, cv2.FONT_HERSHEY_SIMPLEX, size, colour, width, cv2.LINE_AA
        )
