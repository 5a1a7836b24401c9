"""One frame laid open: both images, their difference, and every marker's own pixels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from bench.pictures.frame_record import FrameRecord
from bench.pictures.marker_overlay import (
    DETECTION_RED,
    REPROJECTION_GREEN,
    TRUTH_CYAN,
    markers_of,
    overlay,
    reprojections_px,
    verdict,
)
from bench.pictures.stretch import STRETCH, stretch
from bench.report.numbers import number
from bench.report.plain_text import take_literally
from models.arrays import Floats
from models.frame import IMAGE_800, IMAGE_850
from pipelines.detection.image_difference import Region

Colour = tuple[float, float, float]
DPI = 100
WINDOW_RADII = 2.2  # half a zoomed window, in radii of the marker's image
SMALLEST_WINDOW_PX = 6.0
COLUMNS = 5
PANEL_PX = 610
IMAGES_INCHES = 6.6  # high, where they are square
DIFFERENCE = "850 nm minus 800 nm"
OUTSIDE_PX = -1e9  # where a marker behind the camera is drawn: nowhere
INK, PAPER = "#e8e8e8", "#15181c"


def draw(record: FrameRecord) -> NDArray[np.uint8]:
    """Draw a pair laid open, (height, width, 3), RGB."""
    signals = _signals(record)
    return draw_signals(record, signals, signals[DIFFERENCE])


@dataclass(frozen=True, eq=False)
class Part:
    """A part of a frame that is drawn large, with every marker that is lost named in it.

    Attributes
    ----------
    title : str
    region : Region
    signal_dn : (height, width) or (height, width, 3) array, DN
        Of the whole frame.
    """

    title: str
    region: Region
    signal_dn: Floats


def draw_signals(
    record: FrameRecord,
    signals: dict[str, Floats],
    in_windows: Floats,
    part: Part | None = None,
    remark: str = "",
) -> NDArray[np.uint8]:
    """Draw a frame laid open, (height, width, 3), RGB.

    Parameters
    ----------
    record : FrameRecord
    signals : dict of str to (height, width) or (height, width, 3) arrays, DN
        Pictures by their titles; all but the first with marks.
    in_windows : (height, width) array, DN
        What is shown of each marker.
    part : Part, optional
        What is drawn beside them.
    remark : str
        Said after how wrong the pose is.
    """
    shown = _shown_markers(record)
    rows = max(1, -(-len(shown) // COLUMNS))
    images = IMAGES_INCHES * record.camera.height / record.camera.width
    figure = Figure(figsize=(20.0, images + 1.6 + 4.0 * rows), dpi=DPI, facecolor=PAPER)
    canvas = FigureCanvasAgg(figure)
    grid = figure.add_gridspec(
        2, 1, height_ratios=[images, 3.9 * rows], left=0.03, right=0.985, top=0.9, bottom=0.02,
        hspace=0.1,
    )  # fmt: skip
    count = len(signals) + (part is not None)
    columns = grid[0].subgridspec(1, count, wspace=0.08)
    _draw_images(figure, columns, record, signals)
    if part is not None:
        _draw_part(figure.add_subplot(columns[0, count - 1]), record, part)
    windows = grid[1].subgridspec(rows, COLUMNS, wspace=0.12, hspace=0.22)
    for place, marker in enumerate(shown):
        axes = figure.add_subplot(windows[place // COLUMNS, place % COLUMNS])
        _draw_window(axes, record, marker, in_windows)
    _write_heading(figure, record, remark)
    take_literally(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    return np.ascontiguousarray(pixels[:, :, :3])


def _rgb(colour: tuple[int, int, int]) -> Colour:
    red, green, blue = colour
    return red / 255.0, green / 255.0, blue / 255.0


def _signals(record: FrameRecord) -> dict[str, Floats]:
    bias_dn = record.detector.bias_dn
    image_800 = record.image(IMAGE_800).astype(np.float64)
    image_850 = record.image(IMAGE_850).astype(np.float64)
    return {
        "800 nm": image_800 - bias_dn,
        "850 nm": image_850 - bias_dn,
        DIFFERENCE: image_850 - image_800,
    }


def _shown_markers(record: FrameRecord) -> list[int]:
    """Return the markers worth a window: those in the image, by truth or else by estimate."""
    if record.best_known_pose is None:
        return []
    camera, points = record.camera, markers_of(record).points_in_target
    pixels = camera.project(record.best_known_pose @ points)
    inside = camera.contains(np.nan_to_num(pixels, nan=OUTSIDE_PX))
    return [int(marker) for marker in np.flatnonzero(inside)]


def _draw_images(
    figure: Figure, grid: object, record: FrameRecord, signals: dict[str, Floats]
) -> None:
    for column, (title, signal_dn) in enumerate(signals.items()):
        axes = figure.add_subplot(grid[0, column])  # type: ignore[index]
        picture = (
            overlay(record, PANEL_PX, signal_dn)
            if column > 0
            else stretch(signal_dn, record.detector)
        )
        axes.imshow(picture, cmap="gray", vmin=0, vmax=1)
        axes.set_title(title, color=INK, fontsize=12)
        _frame(axes)


def _draw_part(axes: Axes, record: FrameRecord, part: Part) -> None:
    region = part.region
    signal_dn = part.signal_dn[region.part]
    axes.imshow(
        stretch(signal_dn, record.detector), cmap="gray", vmin=0, vmax=1,
        extent=(region.left - 0.5, region.right - 0.5, region.bottom - 0.5, region.top - 0.5),
    )  # fmt: skip
    _draw_marks(axes, record)
    axes.set_xlim(region.left - 0.5, region.right - 0.5)
    axes.set_ylim(region.bottom - 0.5, region.top - 0.5)
    for marker in _shown_markers(record):
        if not _is_used(record, marker):
            u, v = _window_centre(record, marker)[0].tolist()
            axes.annotate(
                f"{markers_of(record).names[marker]} lost", (u, v), xytext=(0, 22),
                textcoords="offset points", ha="center", color=_rgb(DETECTION_RED), fontsize=11,
                weight="bold",
            )  # fmt: skip
    axes.set_title(part.title, color=INK, fontsize=12)
    _frame(axes)


def _is_used(record: FrameRecord, marker: int) -> bool:
    said = None if record.estimate is None else record.estimate.detections
    if said is None:
        return False
    return any(own == marker and used for own, used in zip(said.marker, said.used, strict=True))


def _draw_window(axes: Axes, record: FrameRecord, marker: int, signal_dn: Floats) -> None:
    centre, radius_px = _window_centre(record, marker)
    half = max(SMALLEST_WINDOW_PX, WINDOW_RADII * radius_px)
    height, width = signal_dn.shape
    first = np.maximum(np.floor(centre - half).astype(int), 0)  # all that shows, and no more
    last = np.minimum(np.ceil(centre + half).astype(int) + 1, (width, height))
    window_dn = signal_dn[first[1] : last[1], first[0] : last[0]]
    (left, top), (right, bottom) = (first - 0.5).tolist(), (last - 0.5).tolist()
    axes.imshow(
        stretch(window_dn, record.detector), cmap="gray", vmin=0, vmax=1,
        extent=(left, right, bottom, top),
    )  # fmt: skip
    _draw_marks(axes, record)
    axes.set_xlim(centre[0] - half, centre[0] + half)
    axes.set_ylim(centre[1] + half, centre[1] - half)
    axes.set_title(_window_title(record, marker), color=INK, fontsize=10)
    _frame(axes)


def _window_centre(record: FrameRecord, marker: int) -> tuple[Floats, float]:
    """Return where a marker is, by the truth where there is one, and its radius, px."""
    pose = record.best_known_pose
    camera, markers = record.camera, markers_of(record)
    if pose is None:
        raise ValueError(f"expected a pose to find marker {marker} by, got none")
    point_in_cam = pose @ markers.points_in_target[marker]
    radius_px = camera.fx * markers.radius_m / float(point_in_cam[2])
    return np.round(camera.project(point_in_cam)), radius_px


def _window_title(record: FrameRecord, marker: int) -> str:
    name = f"#{markers_of(record).names[marker]}"
    detections = None if record.estimate is None else record.estimate.detections
    if detections is None or marker not in detections.marker:
        return f"{name}  not found"
    place = detections.marker.index(marker)
    kept = "" if detections.used[place] else "  (rejected)"
    if record.truth is None:
        return f"{name}{kept}"
    du, dv = detections.points_px[place] - record.truth.markers_px[marker]
    return f"{name}  {number(du, signed=True)}, {number(dv, signed=True)} px{kept}"


def _draw_marks(axes: Axes, record: FrameRecord) -> None:
    def marks(pixels: Floats, sign: str, colour: tuple[int, int, int], size: float) -> None:
        axes.plot(
            pixels[:, 0], pixels[:, 1], sign, color=_rgb(colour), markersize=size,
            markerfacecolor="none", markeredgewidth=1.6, linestyle="none",
        )  # fmt: skip

    if record.truth is not None:
        marks(record.truth.markers_px[record.truth.visible > 0.0], "+", TRUTH_CYAN, 26.0)
    reprojected_px = reprojections_px(record)
    if reprojected_px is not None:
        marks(reprojected_px, "D", REPROJECTION_GREEN, 19.0)
    if record.estimate is not None:
        marks(record.estimate.detected.points_px, "o", DETECTION_RED, 16.0)


def _frame(axes: Axes) -> None:
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_color("#444a52")


def _write_heading(figure: Figure, record: FrameRecord, remark: str) -> None:
    frame = record.frame
    words = [
        f"frame {frame.index}",
        f"t = {frame.time_s:.2f} s",
        f"exposure {record.exposure_ms:.3g} ms",
    ]
    if record.truth is not None:
        words.insert(2, f"range {np.linalg.norm(record.truth.cam_from_target.translation):.2f} m")
    figure.text(0.03, 0.965, "   ".join(words), color=INK, fontsize=15, weight="bold", va="center")
    told = f"{record.variant}: {verdict(record)}" if record.variant else verdict(record)
    told += remark
    figure.text(0.03, 0.938, told, color=INK, fontsize=12, va="center")
    figure.text(0.985, 0.938, STRETCH, color="#9aa2ab", fontsize=9, va="center", ha="right")
    marks = (
        ("o", DETECTION_RED, "detected"),
        ("D", REPROJECTION_GREEN, "reprojected"),
        ("+", TRUTH_CYAN, "truth"),
    )
    handles = [
        Line2D([], [], color=_rgb(colour), marker=sign, markerfacecolor="none", linestyle="none")
        for sign, colour, _ in marks
    ]
    figure.legend(
        handles, [label for _, _, label in marks], loc="upper right", ncols=3, frameon=False,
        labelcolor=INK, bbox_to_anchor=(0.99, 0.985), fontsize=11,
    )  # fmt: skip
