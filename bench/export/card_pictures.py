"""The pictures of a dataset's card: some of its frames with their labels, and how it is spread."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import cv2
import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import MaxNLocator

from bench.export.keypoints import HIDDEN, SHADOW, VISIBLE
from bench.export.picture import encoded, picture_of
from bench.export.plan import Shot
from bench.export.record import Record
from bench.export.records import Records
from bench.export.run_lengths import mask_of
from bench.export.tone_curve import tone_curve
from bench.report.plot import INK, STYLE
from models.arrays import AnyArray, Floats

TILES, COLUMNS, TILE_PX = 9, 3, 360
BGR = {VISIBLE: (96, 220, 96), SHADOW: (220, 160, 60), HIDDEN: (70, 70, 235)}
OUTLINE, BOX = (60, 200, 255), (200, 200, 200)
SHOWN_AS = "asinh"
COLOUR, SECOND = "#1763a6", "#d1781d"
DPI = 110


@dataclass
class Spread:
    """Numbers of all images, gathered one by one; a NaN where there is none."""

    range_m: list[float] = field(default_factory=list)
    phase_deg: list[float] = field(default_factory=list)
    exposure_ms: list[float] = field(default_factory=list)
    visible: list[float] = field(default_factory=list)
    camera: list[list[float]] = field(default_factory=list)
    sun: list[list[float]] = field(default_factory=list)

    def add(self, record: Record) -> None:
        """Take an image's numbers."""
        self.exposure_ms.append(record.exposure_ms)
        if record.range_m is not None:
            self.range_m.append(record.range_m)
            self.visible.append(record.visible_fraction)
        if record.phase_angle_deg is not None:
            self.phase_deg.append(record.phase_angle_deg)
        if (towards := record.camera_dir_in_target) is not None:
            self.camera.append(towards.tolist())
        if record.sun_dir_in_target is not None:
            self.sun.append(record.sun_dir_in_target)


def contact_sheet(records: Records) -> bytes | None:
    """Return some frames, spread over the export, each close to its target, as a PNG.

    Drawn are the outline of what is seen of the target, its box, and its keypoints: green where
    seen, blue in shadow, red hidden.

    Returns
    -------
    bytes or None
        None where nothing has an image.
    """
    shots = records.plan.shots
    if not shots:
        return None
    chosen = sorted({int(k) for k in np.linspace(0, len(shots) - 1, TILES).round()})
    tiles = [_tile(records, shots[number]) for number in chosen]
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % min(COLUMNS, len(tiles)))
    columns = min(COLUMNS, len(tiles))
    rows = [np.hstack(tiles[k : k + columns]) for k in range(0, len(tiles), columns)]
    return encoded(np.vstack(rows), ".png")


def histograms(spread: Spread) -> bytes:
    """Return ranges, phase angles, exposures, directions of camera and Sun, as a PNG."""
    panels: list[Callable[..., None]] = [
        lambda axes: _bars(axes, spread.range_m, "range, m"),
        lambda axes: _bars(axes, spread.phase_deg, "phase angle (Sun, target, camera), deg"),
        lambda axes: _bars(axes, spread.exposure_ms, "exposure, ms"),
        lambda axes: sphere(axes, spread.camera, "attitude: camera as the target sees it", COLOUR),
        lambda axes: sphere(axes, spread.sun, "Sun as the target sees it", SECOND),
        lambda axes: _bars(axes, spread.visible, "part of the silhouette that is seen"),
    ]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11.0, 6.0), layout=ConstrainedLayoutEngine(h_pad=0.09, w_pad=0.09))
        for axes, draw in zip(figure.subplots(2, 3).ravel(), panels, strict=True):
            draw(axes)
        stream = io.BytesIO()
        figure.savefig(stream, format="png", dpi=DPI, metadata={"Software": None})
    return stream.getvalue()


def _bars(axes: mpl.axes.Axes, values: Sequence[float], title: str) -> None:
    axes.set_title(title)
    axes.set_ylabel("images")
    if not values:
        _nothing(axes)
        return
    low, high = min(values), max(values)
    if high - low <= 1e-9 * max(abs(high), 1.0):  # all the same: one bar, with room about it
        low, high = low - 0.05 * max(abs(low), 1.0), high + 0.05 * max(abs(high), 1.0)
    axes.set_axisbelow(True)
    axes.hist(values, bins=min(40, max(5, len(values) // 4)), range=(low, high), color=COLOUR)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))


def sphere(
    axes: mpl.axes.Axes, directions: Sequence[Sequence[float]], title: str, colour: str
) -> None:
    """Draw directions by azimuth and elevation.

    Parameters
    ----------
    axes : Axes
    directions : (n, 3) array
        Unit vectors, target axes.
    title : str
    colour : str
    """
    axes.set_title(title)
    axes.set_xlim(-180.0, 180.0)
    axes.set_ylim(-90.0, 90.0)
    axes.set_xticks(range(-180, 181, 90))
    axes.set_yticks(range(-90, 91, 45))
    axes.set_xlabel("azimuth from +x towards +y, deg")
    axes.set_ylabel("elevation towards +z, deg")
    if not directions:
        _nothing(axes)
        return
    x, y, z = np.array(directions, dtype=np.float64).T
    azimuth, elevation = np.arctan2(y, x), np.arcsin(np.clip(z, -1.0, 1.0))
    size = float(np.clip(4000.0 / len(x), 2.0, 24.0))
    axes.scatter(np.rad2deg(azimuth), np.rad2deg(elevation), s=size, color=colour, alpha=0.6, lw=0)


def _nothing(axes: mpl.axes.Axes) -> None:
    axes.text(0.5, 0.5, "not told", ha="center", transform=axes.transAxes, color=INK)


def _tile(records: Records, shot: Shot) -> AnyArray:
    """Return a square picture of one frame around its target, (TILE_PX, TILE_PX, 3)."""
    record = records.get(shot)
    if record is None:
        return np.zeros((TILE_PX, TILE_PX, 3), dtype=np.uint8)
    detector = records.plan.source(shot).dataset.onboard.detector
    curve = tone_curve(SHOWN_AS, detector)
    image = picture_of(records.plan.image_path(shot), curve, None).image
    colours = image if image.ndim == 3 else cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
    left, top, side = _frame_around(record)
    scale = TILE_PX / side
    to_tile = np.array([[scale, 0.0, -scale * left], [0.0, scale, -scale * top]])
    half = 0.5 * scale - 0.5  # pixel centres are integers, here and there
    to_tile[:, 2] += half
    tile = cv2.warpAffine(colours, to_tile, (TILE_PX, TILE_PX), flags=cv2.INTER_NEAREST)
    _draw_labels(tile, record, to_tile)
    told = f"{record.key} {record.split}"
    for colour, width in (((0, 0, 0), 3), ((255, 255, 255), 1)):
        place = (6, TILE_PX - 8)
        cv2.putText(tile, told, place, cv2.FONT_HERSHEY_SIMPLEX, 0.4, colour, width, cv2.LINE_AA)
    return np.asarray(tile)


def _frame_around(record: Record) -> tuple[float, float, float]:
    """Return left, top and side of the square that is shown, px."""
    box = record.visible.box if record.visible is not None else None
    if box is None:
        side = float(max(record.width, record.height))
        return 0.5 * (record.width - side), 0.5 * (record.height - side), side
    x0, y0, x1, y1 = box
    side = 1.3 * max(x1 - x0 + 1, y1 - y0 + 1, 16)
    return 0.5 * (x0 + x1 - side), 0.5 * (y0 + y1 - side), side


def _draw_labels(tile: AnyArray, record: Record, to_tile: Floats) -> None:
    def placed(points: AnyArray) -> AnyArray:
        return np.asarray(points, dtype=np.float64) @ to_tile[:, :2].T + to_tile[:, 2]

    if record.visible is not None and record.visible.box is not None:
        mask = mask_of(record.visible.lengths, record.height, record.width).astype(np.uint8)
        large = cv2.warpAffine(mask, to_tile, (TILE_PX, TILE_PX), flags=cv2.INTER_NEAREST)
        outline, _ = cv2.findContours(large, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
        cv2.drawContours(tile, outline, -1, OUTLINE, 1)
        x0, y0, x1, y1 = record.visible.box
        corners = np.rint(placed(np.array([[x0 - 0.5, y0 - 0.5], [x1 + 0.5, y1 + 0.5]])))
        low, high = corners.astype(int).tolist()
        cv2.rectangle(tile, low, high, BOX, 1)
    for point, state in zip(record.keypoints_px, record.keypoint_states, strict=True):
        if point is not None and state in BGR:
            u, v = np.rint(placed(np.array(point))).astype(int).tolist()
            cv2.circle(tile, (u, v), 4, BGR[state], 1, cv2.LINE_AA)
