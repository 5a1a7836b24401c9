"""The Sun map: every direction's frame in its place on the sphere, framed by what came of it.

The map is the sinusoidal projection, which keeps areas: across is azimuth times the cosine of
elevation, up is elevation. On it a grid of rings (``models.lights.sun_grid``) stands at nearly
equal distances, so that the frames tile it. A list of Suns too near to each other for that is laid
out in rows instead. Below it, the pose error of the same directions in colours.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from bench.report.plain_text import take_literally
from bench.report.plot import INK, STYLE
from bench.sweep.sun_labels import label_offsets
from bench.sweep.table import VERDICTS, Row, Setting, Verdict, saturated
from models.arrays import Floats
from models.lights.sun import SUN_CASES_DEG

FRAME_COLOURS: dict[Verdict, str] = {
    "all found": "#2f7fd1",
    "some missed": "#f0a817",
    "wrong pose": "#8d4aa8",
    "no pose": "#d0342c",
}
"""Blue, amber, violet, red: lightnesses too, for those who do not see the colours."""

MEANINGS: dict[Verdict, str] = {
    "all found": "every marker found",
    "some missed": "pose found, markers missed",
    "wrong pose": "wrong pose",
    "no pose": "no pose",
}
GROUND, MESH = "#f4f6f8", "#cfd7de"
WIDTH_IN, DPI = 24.0, 110
MAP_SPAN_DEG = (360.0, 180.0)
LARGEST_TILE_DEG = 60.0
SPHERE_DEG2 = 41_253.0
LEAST_COVERED = 0.3  # of the sphere; where frames without overlap would cover less, rows serve
TILE_SHARE = 0.94  # of the distance between neighbours
ROW_OF_TILES = 8
NAME_PT = (15.0, 10.0)  # what the name of a Sun takes
SMALLEST = 1e-4  # mm, deg or %: what a logarithm may meet
_OUTLINE = [withStroke(linewidth=1.8, foreground="black")]


@dataclass(frozen=True, eq=False)
class Tile:
    """One direction's frame on the map: its middle and size in the map's deg."""

    row: Row
    thumbnail: NDArray[np.uint8]
    x_deg: float
    y_deg: float
    size_deg: float


@dataclass(frozen=True)
class SunMap:
    """A map as a PNG, and where each direction's frame lies on it, see ``tile_boxes``."""

    png: bytes
    boxes: list[tuple[float, float, float, float]]


def on_sphere(azimuth_deg: float, elevation_deg: float) -> tuple[float, float]:
    """Return where a direction lies on the sinusoidal map, deg; azimuth 0 is in the middle."""
    around_deg = (azimuth_deg + 180.0) % 360.0 - 180.0
    return around_deg * float(np.cos(np.deg2rad(elevation_deg))), elevation_deg


def tiles(rows: Sequence[Row], thumbnails: Sequence[NDArray[np.uint8]]) -> list[Tile] | None:
    """Lay frames out on the sphere; None where directions are too near to each other for it.

    Parameters
    ----------
    rows : sequence of Row
    thumbnails : sequence of (height, width) uint8 arrays
        One a row.
    """
    places = np.array([on_sphere(row.azimuth_deg, row.elevation_deg) for row in rows])
    size_deg = min(TILE_SHARE * nearest_deg(places), LARGEST_TILE_DEG)
    if len(rows) * size_deg**2 < LEAST_COVERED * SPHERE_DEG2:
        return None
    return [
        Tile(row, thumbnail, float(x), float(y), size_deg)
        for row, thumbnail, (x, y) in zip(rows, thumbnails, places, strict=True)
    ]


def nearest_deg(places: Floats) -> float:
    """Return how large squares at (n, 2) places may be so that none overlap."""
    apart = np.abs(places[:, None, :] - places[None, :, :]).max(axis=2)
    pairs = apart[np.triu_indices(len(places), 1)]
    return float(pairs.min()) if len(pairs) else LARGEST_TILE_DEG


def tiles_in_rows(rows: Sequence[Row], thumbnails: Sequence[NDArray[np.uint8]]) -> list[Tile]:
    """Lay frames out in rows, in the order given, over the map's width.

    Parameters
    ----------
    rows : sequence of Row
    thumbnails : sequence of (height, width) uint8 arrays
        One a row.
    """
    columns = min(ROW_OF_TILES, len(rows))
    step = min(MAP_SPAN_DEG[0] / columns, 90.0)
    return [
        Tile(
            row,
            thumbnail,
            (number % columns - 0.5 * (columns - 1)) * step,
            -(number // columns) * step * 1.12,
            TILE_SHARE * step,
        )
        for number, (row, thumbnail) in enumerate(zip(rows, thumbnails, strict=True))
    ]


def sun_map(
    title: str, setting: Setting, rows: Sequence[Row], thumbnails: Sequence[NDArray[np.uint8]]
) -> SunMap:
    """Draw the map of one setting.

    Parameters
    ----------
    title : str
        What was swept.
    setting : Setting
    rows : sequence of Row
        One for each direction, of one pipeline.
    thumbnails : sequence of (n, n) uint8 arrays
        Their last images.

    Returns
    -------
    SunMap
    """
    figure = sun_map_figure(title, setting, rows, thumbnails)
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=DPI, metadata={"Software": "rvbench"})
    return SunMap(stream.getvalue(), tile_boxes(figure))


def tile_boxes(figure: Figure) -> list[tuple[float, float, float, float]]:
    """Return where each direction's frame lies on a drawn map: left, top, width, height in percent.

    Parameters
    ----------
    figure : Figure
        See ``sun_map_figure``.
    """
    panel, boxes = figure.axes[0], []
    to_figure = panel.transData + figure.transFigure.inverted()
    for image in panel.images:
        left, right, low, high = image.get_extent()
        (x0, y0), (x1, y1) = to_figure.transform([(left, low), (right, high)])
        box = np.round([100.0 * x0, 100.0 * (1.0 - y1), 100.0 * (x1 - x0), 100.0 * (y1 - y0)], 3)
        boxes.append((float(box[0]), float(box[1]), float(box[2]), float(box[3])))
    return boxes


def sun_map_figure(
    title: str, setting: Setting, rows: Sequence[Row], thumbnails: Sequence[NDArray[np.uint8]]
) -> Figure:
    """Return the map as a figure; its first axes hold one image for each direction.

    Parameters
    ----------
    title : str
    setting : Setting
    rows : sequence of Row
        One for each direction, of one pipeline.
    thumbnails : sequence of (height, width) uint8 arrays
        One a row.
    """
    placed = tiles(rows, thumbnails)
    laid = placed if placed is not None else tiles_in_rows(rows, thumbnails)
    half = 0.5 * laid[0].size_deg
    low = min([tile.y_deg for tile in laid]) - half - 3.0
    high = max([tile.y_deg for tile in laid]) + half + 3.0
    if placed is not None:
        low, high = min(low, -93.0 - half), max(high, 93.0 + half)
    left = min(-186.0, min(tile.x_deg for tile in laid) - half - 3.0)
    right = max(186.0, max(tile.x_deg for tile in laid) + half + 3.0)
    if placed is not None:
        left, right = min(left, -183.0 - half), max(right, 183.0 + half)
    main_in = WIDTH_IN * (high - low) / (right - left)
    head_in, foot_in = 1.0, 4.3
    tall_in = main_in + head_in + foot_in
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH_IN, tall_in), facecolor="white")
        panel = figure.add_axes((0.0, foot_in / tall_in, 1.0, main_in / tall_in))
        _frames(panel, laid, (left, right), (low, high), on_a_sphere=placed is not None)
        _heading(figure, title, setting, rows, tall_in)
        panels: list[tuple[str, list[float | None]]] = [
            ("position error, mm", [row.position_error_mm for row in rows]),
            ("attitude error, deg", [row.attitude_error_deg for row in rows]),
            ("saturated pixels, %", [saturated(row) for row in rows]),
        ]
        for column, (name, values) in enumerate(panels):
            left_in = 0.5 + 7.9 * column
            place = (left_in / WIDTH_IN, 0.3 / tall_in, 6.6 / WIDTH_IN, 3.3 / tall_in)
            _small_map(figure, place, rows, values, name)
        take_literally(figure)
    return figure


def _frames(
    panel: Axes,
    laid: Sequence[Tile],
    across: tuple[float, float],
    up: tuple[float, float],
    on_a_sphere: bool,
) -> None:
    panel.set_xlim(*across)
    panel.set_ylim(*up)
    panel.set_aspect("equal")
    panel.axis("off")
    if on_a_sphere:
        _graticule(panel, 0.5 * laid[0].size_deg)
        _directions(panel)
    per_deg = WIDTH_IN * 72.0 / (across[1] - across[0])
    for tile in laid:
        half = 0.5 * tile.size_deg
        edges = (tile.x_deg - half, tile.x_deg + half, tile.y_deg - half, tile.y_deg + half)
        panel.imshow(
            tile.thumbnail, cmap="gray", vmin=0, vmax=255, extent=edges, zorder=2, aspect="equal"
        )
        width_pt = float(np.clip(0.055 * tile.size_deg * per_deg, 1.5, 6.0))
        panel.add_patch(
            Rectangle(
                (edges[0], edges[2]), tile.size_deg, tile.size_deg, fill=False, zorder=3,
                ec=FRAME_COLOURS[tile.row.verdict], lw=width_pt, joinstyle="miter",
            )
        )  # fmt: skip
        _caption(panel, tile, per_deg)
    panel.set_xlim(*across)
    panel.set_ylim(*up)


def _caption(panel: Axes, tile: Tile, per_deg: float) -> None:
    """Write found of expected, and the Sun, into a frame where there is room for it."""
    size_pt = tile.size_deg * per_deg
    if size_pt < 45.0:
        return
    half = 0.5 * tile.size_deg
    text: dict[str, Any] = {
        "color": "white", "fontsize": float(np.clip(0.11 * size_pt, 5.5, 13.0)), "zorder": 4,
        "path_effects": _OUTLINE,
    }  # fmt: skip
    margin = 0.07 * tile.size_deg
    place = (tile.x_deg - half + margin, tile.y_deg - half + margin)
    panel.text(*place, tile.row.sun, va="bottom", ha="left", **text)
    counted = f"{tile.row.found}/{tile.row.expected}"
    place = (tile.x_deg + half - margin, tile.y_deg + half - margin)
    panel.text(*place, counted, va="top", ha="right", **text)


def _heading(
    figure: Figure, title: str, setting: Setting, rows: Sequence[Row], tall_in: float
) -> None:
    top = 1.0 - 0.42 / tall_in
    figure.text(0.02, top, title, fontsize=24, fontweight="bold", color=INK, va="center")
    figure.text(0.02, 1.0 - 0.80 / tall_in, setting.title, fontsize=15, color=INK, va="center")
    counts = {verdict: sum(row.verdict == verdict for row in rows) for verdict in VERDICTS}
    handles = [
        Patch(fc="white", ec=FRAME_COLOURS[verdict], lw=4, label=f"{MEANINGS[verdict]}: {count}")
        for verdict, count in counts.items()
    ]
    figure.legend(
        handles=handles, loc="upper right", bbox_to_anchor=(0.985, 1.0 - 0.18 / tall_in),
        ncols=3, fontsize=14, handlelength=1.3, handleheight=1.3,
    )  # fmt: skip


def _graticule(panel: Axes, half_deg: float) -> None:
    """Draw the sphere's lines, on a ground that holds every frame of half a size in full.

    A frame at azimuth 180 or at a pole stands with its middle on the sphere's edge.
    """
    heights, edge = ground(half_deg)
    panel.fill_betweenx(heights, -edge, edge, color=GROUND, lw=0, zorder=0)
    elevations = np.linspace(-90.0, 90.0, 181)
    for azimuth in range(-180, 181, 30):
        across = azimuth * np.cos(np.deg2rad(elevations))
        panel.plot(across, elevations, color=MESH, lw=0.8, zorder=1)
    for elevation in range(-60, 61, 30):
        reach = 180.0 * np.cos(np.deg2rad(elevation))
        panel.plot([-reach, reach], [elevation] * 2, color=MESH, lw=0.8, zorder=1)


def ground(half_deg: float) -> tuple[Floats, Floats]:
    """Return (361,) heights and half widths, deg, of the sphere's map grown by half a frame."""
    heights = np.linspace(-90.0 - half_deg, 90.0 + half_deg, 361)
    nearest = np.clip(np.abs(heights) - half_deg, 0.0, 90.0)
    return heights, 180.0 * np.cos(np.deg2rad(nearest)) + half_deg


def _directions(panel: Axes) -> None:
    """Say in the empty corners where the Sun stands there."""
    words = {
        (-183.0, 86.0, "left", "top"): "Above: the Sun stands behind the chaser\n"
        "and lights the face that it sees.",
        (-183.0, -86.0, "left", "bottom"): "Below: the Sun stands behind the target.",
        (
            183.0,
            86.0,
            "right",
            "top",
        ): "Across: azimuth from 180 over 270 (\N{MINUS SIGN}x), "
        "0 (+y, in the middle)\nand 90 (+x) to 180 deg (\N{MINUS SIGN}y). Up: elevation.",
        (183.0, -86.0, "right", "bottom"): "In a frame: azimuth/elevation of the Sun in deg,\n"
        "and markers found of those whole, lit and in view.",
    }
    for (x, y, beside, at), text in words.items():
        panel.text(x, y, text, ha=beside, va=at, fontsize=13, color="#5c6b78")


def _small_map(
    figure: Figure,
    place: tuple[float, float, float, float],
    rows: Sequence[Row],
    values: Sequence[float | None],
    name: str,
) -> None:
    """Colour the directions by a number, on a logarithmic scale."""
    panel = figure.add_axes(place)
    places = np.array([on_sphere(row.azimuth_deg, row.elevation_deg) for row in rows])
    size = float(np.clip(0.98 * nearest_deg(places), 6.0, 30.0))
    reach = 183.0 + 0.5 * size
    panel.set_xlim(-reach, reach)
    panel.set_ylim(-93.0 - 0.5 * size, 93.0 + 0.5 * size)
    panel.set_aspect("equal")
    panel.axis("off")
    panel.set_title(name, fontsize=14)
    _graticule(panel, 0.5 * size)
    there = [max(value, SMALLEST) for value in values if value is not None]
    norm = _decades(there)
    colours = mpl.colormaps["viridis"]
    for (x, y), value in zip(places, values, strict=True):
        colour = "white" if value is None else colours(norm(max(value, SMALLEST)))
        panel.add_patch(
            Rectangle(
                (x - 0.5 * size, y - 0.5 * size), size, size, fc=colour, lw=0.6, zorder=2,
                ec="white" if value is not None else FRAME_COLOURS["no pose"],
            )
        )  # fmt: skip
        if value is None:
            panel.plot(x, y, "x", color=FRAME_COLOURS["no pose"], ms=6, mew=1.6, zorder=3)
    per_deg = place[2] * WIDTH_IN * 72.0 / (2.0 * reach)
    _name_suns(panel, per_deg)
    if there:
        scale = mpl.cm.ScalarMappable(norm=norm, cmap=colours)
        bar = figure.add_axes((place[0] + place[2] + 0.005, place[1], 0.008, place[3]))
        figure.colorbar(scale, cax=bar).ax.tick_params(labelsize=10)


def _name_suns(panel: Axes, per_deg: float) -> None:
    """Mark the Suns that have names; ``per_deg`` is how many points a degree takes."""
    marks = np.array([on_sphere(*place) for place in SUN_CASES_DEG.values()])
    offsets = label_offsets(marks * per_deg, NAME_PT)
    for sun, (x, y), offset in zip(SUN_CASES_DEG, marks, offsets, strict=True):
        panel.plot(x, y, "o", mfc="none", mec="white", mew=1.2, ms=4, zorder=4, clip_on=False,
                   path_effects=_OUTLINE)  # fmt: skip
        panel.annotate(
            sun, (x, y), offset, textcoords="offset points", fontsize=10, color="white",
            ha="center", va="center", path_effects=_OUTLINE, zorder=4,
        )  # fmt: skip


def _decades(values: Sequence[float]) -> LogNorm:
    """Return a logarithmic scale about the values, at least a factor of ten wide."""
    if not values:
        return LogNorm(SMALLEST, 1.0)
    low, high = min(values), max(values)
    if high < 10.0 * low:
        middle = float(np.sqrt(low * high))
        low, high = middle / np.sqrt(10.0), middle * np.sqrt(10.0)
    return LogNorm(low, high)
