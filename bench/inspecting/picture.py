"""A spacecraft from six sides and askew, with its wireframe, in one picture."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bench.pictures.our_picture import marked
from bench.progress import frame_progress
from models.arrays import Floats
from models.camera import Camera
from models.pose import RigidTransform
from models.spacecraft.own.all_around import look_along
from models.spacecraft.part import Spacecraft
from models.wireframe.visibility import visible_edge_pieces, visible_landmarks
from models.wireframe.wireframe import Wireframe
from renders.views.side_view import SideView, SpacecraftViews

SIDE_PX, OVERSAMPLED = 440, 2
FAR = 40.0  # radii: nearly without perspective
FILL = 1.06  # of the outermost corner's radius: what half a panel shows
PAPER, SKY = "#f4f6f8", np.array([0.93, 0.945, 0.96])
INK, EDGE, CORNER = "#22303c", "#d02f2f", "#1763a6"
SIDES: tuple[tuple[str, tuple[float, float, float], tuple[float, float, float]], ...] = (
    ("from +x", (-1, 0, 0), (0, 0, -1)),
    ("from +y", (0, -1, 0), (0, 0, -1)),
    ("from +z", (0, 0, -1), (0, -1, 0)),
    ("from -x", (1, 0, 0), (0, 0, -1)),
    ("from -y", (0, 1, 0), (0, 0, -1)),
    ("from -z", (0, 0, 1), (0, 1, 0)),
)
ASKEW = np.array([-1.0, -0.8, -0.6]) / np.sqrt(2.0)  # of length 1
SCALES_M = tuple(step * 10.0**power for power in range(-4, 4) for step in (1.0, 2.0, 5.0))
MOST_NAMED = 14


def side_picture(craft: Spacecraft, wireframe: Wireframe | None, title: str) -> bytes:
    """Return the picture as PNG; the process's variant must be set.

    Parameters
    ----------
    craft : Spacecraft
    wireframe : Wireframe or None
    title : str
    """
    radius = _radius_m(craft)
    views = SpacecraftViews(craft)
    palette, camera = _palette(len(craft.part_names)), _camera()
    figure = Figure(figsize=(16.4, 9.6), dpi=110, facecolor=PAPER)
    panels = figure.subplots(2, 4)
    figure.subplots_adjust(0.012, 0.055, 0.988, 0.925, 0.03, 0.09)
    with frame_progress("views", len(SIDES) + 1) as advance:
        for k, (name, forward, down) in enumerate(SIDES):
            panel = panels[k // 3, k % 3]
            pose = look_along(np.array(forward, float), FAR * radius, np.array(down, float))
            _draw(panel, views.seen(_fine(camera), pose), palette, name)
            _finish(panel, camera, pose, radius)
            _wires(panel, wireframe, camera, pose, 0.8)
            advance()
        pose = look_along(ASKEW, FAR * radius, np.array([0.0, 0.0, -1.0]))
        _draw(panels[0, 3], views.seen(_fine(camera), pose), palette, "askew")
        _finish(panels[0, 3], camera, pose, radius)
        shape = (0, 0) if wireframe is None else (len(wireframe), len(wireframe.edges))
        _blank(panels[1, 3], f"wireframe: {shape[0]} landmarks, {shape[1]} edges")
        _wires(panels[1, 3], wireframe, camera, pose, 1.2, hidden=True)
        _finish(panels[1, 3], camera, pose, radius)
        advance()
    figure.text(0.012, 0.965, title, color=INK, fontsize=13, fontweight="bold", va="center")
    _legend(figure, craft.part_names, palette)
    out = io.BytesIO()
    figure.savefig(out, format="png", facecolor=PAPER)
    return marked(out.getvalue())


def _radius_m(craft: Spacecraft) -> float:
    return max(float(np.linalg.norm(part.mesh.vertices, axis=1).max()) for part in craft.parts)


def _camera(side_px: int = SIDE_PX) -> Camera:
    """Return a camera that sees the whole from ``FAR`` radii."""
    focal = 0.5 * side_px * FAR / FILL
    middle = 0.5 * (side_px - 1)
    return Camera(side_px, side_px, focal, focal, middle, middle)


def _fine(camera: Camera) -> Camera:
    return camera.resized(OVERSAMPLED * camera.width)


def _palette(count: int) -> Floats:
    """Return a colour for each part, (count, 3): grey where there is but one."""
    if count == 1:
        return np.array([[0.72, 0.74, 0.77]])
    table = np.array(colormaps["tab20"].colors)[:, :3]  # type: ignore[attr-defined]
    return np.asarray(0.45 * table[np.arange(count) % 20] + 0.45)


def _draw(panel: Axes, view: SideView, palette: Floats, name: str) -> None:
    """Draw a view: hue tells the part, brightness how it is turned and what it reflects."""
    label = view.labels.astype(int)
    colours = np.concatenate([SKY[None], palette, np.tile(palette[-1:], (300, 1))])
    bright = (0.30 + 0.70 * view.shade) * (0.35 + 0.65 * np.sqrt(np.clip(view.reflectance, 0, 1)))
    bright = np.where(label > 0, bright, 1.0)
    image = colours[label] * bright[..., None]
    half = (SIDE_PX, OVERSAMPLED, SIDE_PX, OVERSAMPLED, 3)
    _blank(panel, name)
    panel.imshow(np.clip(image.reshape(half).mean(axis=(1, 3)), 0.0, 1.0))


def _blank(panel: Axes, name: str) -> None:
    panel.set_title(name, loc="left", fontsize=10, color=INK, pad=3)
    panel.set_xlim(-0.5, SIDE_PX - 0.5)
    panel.set_ylim(SIDE_PX - 0.5, -0.5)
    panel.set_aspect("equal")
    panel.set_facecolor((float(SKY[0]), float(SKY[1]), float(SKY[2])))
    panel.set_xticks([])
    panel.set_yticks([])
    for spine in panel.spines.values():
        spine.set_color("#c9d1d8")


def _wires(
    panel: Axes,
    wireframe: Wireframe | None,
    camera: Camera,
    pose: RigidTransform,
    width: float,
    *,
    hidden: bool = False,
) -> None:
    """Draw what is seen of edges and landmarks, and faintly what is hidden."""
    if wireframe is None:
        return
    if len(wireframe.edges):
        pieces = visible_edge_pieces(wireframe, pose, 25)
        pixels = camera.project(pose @ pieces.points_in_target.reshape(-1, 3))
        pixels = pixels.reshape(*pieces.visible.shape, 2)
        for line, seen in zip(pixels, pieces.visible, strict=True):
            if hidden:
                panel.plot(*line[[0, -1]].T, color=EDGE, alpha=0.22, lw=0.7, ls=(0, (3, 3)))
            for start in np.flatnonzero(seen[:-1] & seen[1:]):
                panel.plot(*line[start : start + 2].T, color=EDGE, lw=width, solid_capstyle="butt")
    shown = visible_landmarks(wireframe, pose)
    corners = camera.project(pose @ wireframe.points_in_target)
    panel.plot(*corners[shown].T, ".", color=CORNER, ms=3.2 if not hidden else 5.0)


def _finish(panel: Axes, camera: Camera, pose: RigidTransform, radius: float) -> None:
    """Draw the axes that lie in the picture, and a bar that tells the scale."""
    px_per_m = camera.fx / pose.translation[2]
    foot = np.array([30.0, SIDE_PX - 34.0])
    for k, name in enumerate("xyz"):
        way = pose.rotation[:2, k]
        if np.hypot(*way) < 0.25:
            continue
        tip = foot + 24.0 * way
        style: Any = {"arrowstyle": "->", "color": INK, "lw": 1.1}
        panel.annotate("", xy=(tip[0], tip[1]), xytext=(foot[0], foot[1]), arrowprops=style)
        x, y = (foot + 33.0 * way).tolist()
        panel.text(x, y, name, fontsize=8, color=INK, ha="center", va="center")
    bar_m = max(scale for scale in SCALES_M if scale <= 0.6 * radius)
    right = SIDE_PX - 16.0
    panel.plot([right - bar_m * px_per_m, right], [SIDE_PX - 16.0] * 2, color=INK, lw=2.0)
    text = f"{bar_m:g} m" if bar_m >= 0.5 else f"{1e3 * bar_m:g} mm"
    panel.text(right, SIDE_PX - 22.0, text, fontsize=8, color=INK, ha="right", va="bottom")


def _legend(figure: Figure, names: Sequence[str], palette: Floats) -> None:
    if len(names) == 1:
        return
    at = 0.012
    for name, colour in list(zip(names, palette, strict=True))[:MOST_NAMED]:
        short = name if len(name) <= 18 else name[:17] + "…"
        figure.text(at, 0.022, "■", color=tuple(colour), fontsize=13, va="center")
        figure.text(at + 0.012, 0.022, short, color=INK, fontsize=8.5, va="center")
        at += 0.024 + 0.0052 * len(short)
        if at > 0.93:
            break
    if len(names) > MOST_NAMED or at > 0.93:
        style: Any = {"color": INK, "fontsize": 8.5, "ha": "right", "va": "center"}
        figure.text(0.988, 0.022, f"{len(names)} parts", **style)
