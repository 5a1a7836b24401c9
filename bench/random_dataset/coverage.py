"""Pictures of a random dataset: how what was drawn is spread, and some of its frames."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import cv2
import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import LogFormatter, MaxNLocator

from bench.export.card_pictures import sphere
from bench.export.picture import encoded, picture_of
from bench.export.tone_curve import tone_curve
from bench.random_dataset.draws import BACKGROUNDS
from bench.random_dataset.plan import SPLITS, Plan, Shot
from bench.report.plot import STYLE
from models.arrays import AnyArray
from renders.batches.dataset_writer import image_path
from renders.world.exposure import FILTERED

COLOURS = dict(zip(SPLITS, ("#1763a6", "#d1781d", "#2a8f5b"), strict=True))
DPI, TILES, COLUMNS, TILE_PX = 110, 30, 6, 220
SHOWN_AS = "asinh"
LIT_NM = 850


def coverage(plan: Plan) -> bytes:
    """Return ranges, phase angles, exposures, directions and places in the image, as a PNG."""
    firsts = {shot.pose_number: shot for shot in plan.shots}.values()
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(13.0, 9.0), layout=ConstrainedLayoutEngine(h_pad=0.09, w_pad=0.09))
        panels = figure.subplots(3, 3).ravel()
        spec, poses = plan.spec, len(firsts)
        _bars(panels[0], plan, [(s.pose.range_m, s) for s in firsts], "range, m", log=True)
        _bars(panels[1], plan, [(s.phase_deg, s) for s in plan.shots], "phase angle, deg")
        _bars(panels[2], plan, [(s.exposure_ms, s) for s in plan.shots], "exposure, ms", log=True)
        views = [shot.pose.to_camera.tolist() for shot in firsts]
        sphere(panels[3], views, f"camera as the target sees it, {poses} poses", COLOURS["train"])
        suns = [shot.sun_dir_in_target.tolist() for shot in plan.shots]
        sphere(panels[4], suns, "Sun as the target sees it", COLOURS["val"])
        _roll(panels[5], plan, list(firsts))
        _places(panels[6], plan, list(firsts))
        _counts(panels[7], [s.pose.background for s in firsts], BACKGROUNDS, "background, poses")
        names = [plan.parts[shot.part].name for shot in firsts]
        _counts(panels[8], names, list(dict.fromkeys(sorted(names))), "poses by folder")
        figure.suptitle(
            f"{spec.name}: {spec.frames} frames, seed {spec.seed}; "
            + ", ".join(f"{split}: {_count(plan, split)}" for split in SPLITS),
            ha="left",
            x=0.01,
        )
        figure.legend(*panels[0].get_legend_handles_labels(), loc="upper right", ncols=len(SPLITS))
        stream = io.BytesIO()
        figure.savefig(stream, format="png", dpi=DPI, metadata={"Software": None})
    return stream.getvalue()


def contact_sheet(plan: Plan, out: Path) -> bytes:
    """Return frames spread over the whole dataset, stretched to be seen, as a PNG.

    Parameters
    ----------
    plan : Plan
    out : Path
        The dataset's folder.

    Raises
    ------
    DatasetError
        If an image cannot be read.
    """
    chosen = sorted({int(k) for k in np.linspace(0, len(plan.shots) - 1, TILES).round()})
    tiles = [_tile(plan, plan.shots[number], out) for number in chosen]
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % min(COLUMNS, len(tiles)))
    columns = min(COLUMNS, len(tiles))
    rows = [np.hstack(tiles[k : k + columns]) for k in range(0, len(tiles), columns)]
    return encoded(np.vstack(rows), ".png")


def _count(plan: Plan, split: str) -> int:
    return sum(shot.split == split for shot in plan.shots)


def _bars(
    axes: Axes, plan: Plan, values: Sequence[tuple[float, Shot]], title: str, log: bool = False
) -> None:
    """Draw a histogram, one split on the other; of a log-uniform draw its bars are level."""
    numbers = np.array([value for value, _ in values])
    low, high = float(numbers.min()), float(numbers.max())
    if high <= low:
        low, high = 0.95 * low - 1e-6, 1.05 * high + 1e-6
    count = min(30, max(5, len(numbers) // 8)) + 1
    edges = np.geomspace(low, high, count) if log else np.linspace(low, high, count)
    own = [[value for value, shot in values if shot.split == split] for split in SPLITS]
    axes.set_title(title)
    axes.set_axisbelow(True)
    axes.hist(
        own, bins=edges.tolist(), stacked=True, color=list(COLOURS.values()), label=list(SPLITS)
    )
    if log:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(LogFormatter())
        axes.xaxis.set_minor_formatter(LogFormatter(minor_thresholds=(2, 0.5)))
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))


def _roll(axes: Axes, plan: Plan, shots: Sequence[Shot]) -> None:
    """Draw the size of the turn: of rotations uniform on SO(3) it has the density of the curve."""
    angles = np.deg2rad(np.linspace(0.0, 180.0, 13))
    turns = [
        float(np.linalg.norm(cv2.Rodrigues(shot.pose.cam_from_target.rotation)[0]))
        for shot in shots
    ]
    axes.set_title("size of the turn cam_from_target, deg")
    axes.set_axisbelow(True)
    axes.hist(np.rad2deg(turns), bins=np.rad2deg(angles).tolist(), color=COLOURS["train"])
    if plan.spec.pose.attitude == "uniform":
        expected = len(turns) * np.diff(angles - np.sin(angles)) / np.pi
        middles = np.rad2deg(0.5 * (angles[1:] + angles[:-1]))
        axes.plot(middles, expected, color=COLOURS["val"], marker="o", ms=3, label="uniform")
        axes.legend()
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))


def _places(axes: Axes, plan: Plan, shots: Sequence[Shot]) -> None:
    """Draw where the aim lies in the image, as a share of it."""
    shares = []
    for shot in shots:
        part = plan.parts[shot.part]
        camera = part.camera
        pixel = camera.project(shot.pose.cam_from_target @ part.aim.point)
        shares.append((pixel + 0.5) / [camera.width, camera.height])
    u, v = np.array(shares, dtype=np.float64).T
    axes.set_title("where it is aimed at, shares of the image")
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(1.0, 0.0)
    size = float(np.clip(4000.0 / len(u), 2.0, 24.0))
    axes.scatter(u, v, s=size, color=COLOURS["test"], alpha=0.6, lw=0)


def _counts(axes: Axes, came: Sequence[str], names: Sequence[str], title: str) -> None:
    axes.set_title(title)
    axes.set_axisbelow(True)
    shown = list(names)[:24]
    axes.barh(shown, [came.count(name) for name in shown], color=COLOURS["train"])
    axes.invert_yaxis()
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))


def _tile(plan: Plan, shot: Shot, out: Path) -> AnyArray:
    """Return one frame in a square, with its number, (TILE_PX, TILE_PX)."""
    part = plan.parts[shot.part]
    detector = part.detector
    band = FILTERED if plan.spec.images == "single" else LIT_NM
    path = image_path(out / part.name, shot.frame, band)
    image = picture_of(path, tone_curve(SHOWN_AS, detector), None).image
    scale = TILE_PX / max(image.shape)
    size = (max(1, round(scale * image.shape[1])), max(1, round(scale * image.shape[0])))
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    tile = np.zeros((TILE_PX, TILE_PX), dtype=np.uint8)
    top, left = (TILE_PX - size[1]) // 2, (TILE_PX - size[0]) // 2
    tile[top : top + size[1], left : left + size[0]] = small
    told = f"{shot.number} {shot.split}"
    cv2.putText(tile, told, (5, TILE_PX - 6), cv2.FONT_HERSHEY_SIMPLEX, 0.4, 255, 1, cv2.LINE_AA)
    cv2.rectangle(tile, (0, 0), (TILE_PX - 1, TILE_PX - 1), 60, 1)
    return tile
