"""A frame with the target's wireframe drawn over it: as estimated, and as it truly was.

Edges that the target hides are left out. Truth is drawn first, so that where the estimate sits on
it only the estimate shows. The stroke lies on the edge, not beside it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from bench.pictures.frame_record import FrameRecord
from bench.pictures.marks import Layer
from bench.pictures.stretch import stretch
from bench.report.numbers import number, numbers
from bench.scoring.judgement import NO_REASON
from models.arrays import AnyArray, Floats, Image, Mask
from models.camera import Camera
from models.frame import IMAGE
from models.onboard import OnboardKnowledge, needed
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.wireframe.visibility import visible_edge_pieces
from models.wireframe.wireframe import Wireframe

ESTIMATE_GREEN = (74, 222, 96)
TRUTH_CYAN = (70, 214, 255)
CORNER_RED = (255, 77, 64)
LEFT_OUT_RED = (150, 62, 56)
PIECES = 33  # of an edge, each seen or not
SUBPIXEL_BITS = 4
MARGIN = 0.12  # around the target in a close view, as a share of its picture

Window = tuple[float, float, float]  # left, top and side of a square of the image, px
Colour = tuple[int, int, int]


def wireframe_overlay(
    record: FrameRecord, width_px: int, *, truth: bool = True, window: Window | None = None
) -> NDArray[np.uint8]:
    """Return a frame as a picture with what was estimated and what was true.

    Parameters
    ----------
    record : FrameRecord
        The wireframe is drawn at the filtered pose, or at the image's own where there is none.
    width_px : int, px
        Of the picture.
    truth : bool
        Whether to draw the true pose, where it is known.
    window : (left, top, side), px, optional
        The square of the image to draw; all of it unless given. See ``window_around``.

    Returns
    -------
    (height, width_px, 3) uint8 array
        RGB.
    """
    camera, target = record.camera, record.onboard.wireframe
    canvas = Canvas.of(record.image(IMAGE), record.detector, width_px, window)
    if truth and record.truth is not None and target is not None:
        canvas.draw_edges(camera, target, record.truth.cam_from_target, TRUTH_CYAN)
    if record.estimate is not None:
        if record.estimated_pose is not None and target is not None:
            canvas.draw_edges(camera, target, record.estimated_pose, ESTIMATE_GREEN)
        found = record.estimate.detected
        for pixel, landmark in zip(found.points_px, found.marker, strict=True):
            canvas.circle(pixel, CORNER_RED if landmark >= 0 else LEFT_OUT_RED)
    return canvas.picture


def close_view(record: FrameRecord, width_px: int) -> NDArray[np.uint8]:
    """Return the part of a frame that holds the target, marked; all of it where nobody knows.

    Returns
    -------
    (height, width_px, 3) uint8 array
        RGB.
    """
    pose = record.best_known_pose
    window = None if pose is None else window_around(record.onboard, pose)
    return wireframe_overlay(record, width_px, window=window)


def layers(record: FrameRecord) -> list[Layer]:
    """Return the marks of a frame: edges at the true and the estimated pose, and corners found."""
    camera, target = record.camera, record.onboard.wireframe
    found = []
    for name, of_truth, pose in (
        ("truth", True, record.true_pose),
        ("reprojections", False, record.estimated_pose),
    ):
        if pose is not None and target is not None:
            lines = tuple(edge_lines_px(camera, target, pose))
            found.append(Layer(name, of_truth, "lines", lines))
    if record.estimate is not None:
        said = record.estimate.detected
        dim = tuple(landmark < 0 for landmark in said.marker)
        found.append(Layer("detections", False, "circle", tuple(said.points_px), dim=dim))
    return found


def edge_lines_px(
    camera: Camera, target: Wireframe, cam_from_target: RigidTransform
) -> Iterator[Floats]:
    """Walk what is seen of the target's edges, as polylines of few points, (k, 2), px.

    Parameters
    ----------
    camera : Camera
    target : Wireframe
    cam_from_target : RigidTransform
    """
    step = PIECES // 4 if camera.distorted else PIECES  # a straight edge is two points
    for line, seen in _seen_pieces(camera, target, cam_from_target):
        there = np.flatnonzero(seen)
        for run in np.split(there, np.flatnonzero(np.diff(there) > 1) + 1):
            if len(run) > 1:
                yield line[[*run[:-1:step], run[-1]]]


def signals(record: FrameRecord) -> dict[str, Floats]:
    """Return the image of a frame less its bias, (height, width), DN, by its name."""
    image = record.image(IMAGE).astype(np.float64)
    return {"image": np.asarray(image - record.detector.bias_dn)}


def _seen_pieces(
    camera: Camera, target: Wireframe, cam_from_target: RigidTransform
) -> Iterator[tuple[Floats, Mask]]:
    """Walk the edges: points along each, (n, 2), px, and which of them are seen."""
    pieces = visible_edge_pieces(target, cam_from_target, PIECES)
    flat = pieces.points_in_target.reshape(-1, 3)
    pixels = camera.project(cam_from_target @ flat).reshape(*pieces.visible.shape, 2)
    yield from zip(pixels, pieces.visible & np.isfinite(pixels).all(axis=2), strict=True)


def wireframe_of(onboard: OnboardKnowledge) -> Wireframe:
    """Return the target as drawn."""
    return needed(onboard.wireframe, "wireframe.json", "pictures of single images")


def verdict(record: FrameRecord) -> str:
    """Say in one line what the pipeline did, and the pose error or why there is no pose."""
    if record.estimate is None:
        return "not estimated"
    said = record.estimate.mode or "estimated"
    if record.estimate.pose is None:
        said += f" (no pose from this image: {record.estimate.reason or NO_REASON})"
    pose = record.estimated_pose
    if pose is None or record.truth is None:
        return said
    was = record.truth.cam_from_target
    x, y, z = numbers((1e3 * (pose.translation - was.translation)).tolist(), signed=True)
    # No 3-2-1 angles: a tumble passes through their singularity.
    turn_deg = np.rad2deg(Rotation.from_matrix(pose.rotation @ was.rotation.T).magnitude())
    return f"{said}: position error {x}, {y}, {z} mm; attitude {number(float(turn_deg))} deg"


def window_around(onboard: OnboardKnowledge, cam_from_target: RigidTransform) -> Window | None:
    """Return the square that holds the target at a pose; None if it is not in front, or not known.

    Parameters
    ----------
    onboard : OnboardKnowledge
    cam_from_target : RigidTransform
    """
    if onboard.wireframe is None:
        return None
    camera = needed(onboard.camera, "camera.toml", "pictures of a wireframe")
    pixels = camera.project(cam_from_target @ wireframe_of(onboard).points_in_target)
    if not np.isfinite(pixels).all():
        return None
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    side = float((high - low).max() * (1.0 + 2.0 * MARGIN))
    left, top = (0.5 * (low + high) - 0.5 * side).tolist()
    return left, top, side


@dataclass(eq=False)
class Canvas:
    """A picture of a part of an image, and where in it a pixel of the image lies."""

    picture: NDArray[np.uint8]
    scale: float
    left: float
    top: float

    @classmethod
    def of(cls, image: Image, detector: Detector, width_px: int, window: Window | None) -> Canvas:
        """Return an image, or a square of it, as a picture of a width.

        Parameters
        ----------
        image : (height, width) uint16 array, DN
        detector : Detector
        width_px : int, px
        window : (left, top, side) or None, px
        """
        grey = stretch(image.astype(np.float64) - detector.bias_dn, detector)
        height, width = grey.shape
        left, top, side = window or (-0.5, -0.5, float(width))
        scale = width_px / side
        height_px = width_px if window else round(height * scale)
        shape = (width_px, height_px)
        if scale < 1.0 and window is None:
            grey = cv2.resize(grey, shape, interpolation=cv2.INTER_AREA)
        else:
            step = 1.0 / scale
            warp = np.array([[step, 0.0, left + 0.5 * step], [0.0, step, top + 0.5 * step]])
            flags = cv2.WARP_INVERSE_MAP | (cv2.INTER_LINEAR if scale < 1.0 else cv2.INTER_NEAREST)
            grey = cv2.warpAffine(grey, warp, shape, flags=flags)
        levels = np.rint(255.0 * np.clip(grey, 0.0, 1.0)).astype(np.uint8)
        return cls(np.repeat(levels[:, :, None], 3, axis=2), scale, left, top)

    def draw_edges(
        self, camera: Camera, target: Wireframe, cam_from_target: RigidTransform, colour: Colour
    ) -> None:
        """Draw what is seen of a wireframe at a pose.

        Parameters
        ----------
        camera : Camera
        target : Wireframe
        cam_from_target : RigidTransform
        colour : Colour
        """
        for line, shown in _seen_pieces(camera, target, cam_from_target):
            for place in np.flatnonzero(shown[:-1] & shown[1:]):
                self.line(line[place], line[place + 1], colour)

    def circle(self, pixel: Floats, colour: Colour) -> None:
        """Draw a small circle about a pixel of the image.

        Parameters
        ----------
        pixel : (2,) array, px
        colour : Colour
        """
        radius = max(3.0, 0.006 * self.picture.shape[1])
        size = round(radius * 2**SUBPIXEL_BITS)
        cv2.circle(
            self.picture, self._at(pixel), size, colour, self._stroke, cv2.LINE_AA, SUBPIXEL_BITS
        )

    @property
    def _stroke(self) -> int:
        return max(1, round(self.picture.shape[1] / 1200))

    def line(self, start: AnyArray, end: AnyArray, colour: Colour) -> None:
        """Draw a line between two pixels of the image.

        Parameters
        ----------
        start, end : (2,) array, px
        colour : Colour
        """
        ends = self._at(start), self._at(end)
        cv2.line(self.picture, *ends, colour, self._stroke, cv2.LINE_AA, SUBPIXEL_BITS)

    def _at(self, pixel: AnyArray) -> tuple[int, int]:
        """Return where a pixel of the image lies, in OpenCV's fixed point."""
        place = (np.asarray(pixel) - [self.left, self.top]) * self.scale - 0.5
        x, y = np.rint(place * 2**SUBPIXEL_BITS).astype(int)
        return int(x), int(y)
