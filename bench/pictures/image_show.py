"""One single image laid open: whole, and close up, with the wireframe as estimated and as true."""

from __future__ import annotations

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from bench.chains.tumble_images import CHAIN
from bench.pictures.frame_record import FrameRecord
from bench.pictures.stretch import STRETCH
from bench.pictures.wireframe_overlay import verdict, window_around, wireframe_overlay
from bench.report.plain_text import take_literally

PANEL_PX, DPI = 950, 100
INK, PAPER, DIM = "#e8e8e8", "#15181c", "#9aa2ab"


def draw(record: FrameRecord) -> NDArray[np.uint8]:
    """Draw an image laid open, (height, width, 3), RGB."""
    pose = record.best_known_pose
    near = None if pose is None else window_around(record.onboard, pose)
    windows = (None, near) if near is not None else (None,)
    figure = Figure(figsize=(0.3 + 9.7 * len(windows), 10.8), dpi=DPI, facecolor=PAPER)
    canvas = FigureCanvasAgg(figure)
    grid = figure.add_gridspec(
        1, len(windows), left=0.01, right=0.99, bottom=0.03, top=0.91, wspace=0.02
    )
    for place, window in enumerate(windows):
        axes = figure.add_subplot(grid[0, place])
        axes.imshow(wireframe_overlay(record, PANEL_PX, window=window))
        axes.set_axis_off()
    _write_heading(figure, record)
    take_literally(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    return np.ascontiguousarray(pixels[:, :, :3])


def _write_heading(figure: Figure, record: FrameRecord) -> None:
    frame = record.frame
    words = [
        f"frame {frame.index}",
        f"t = {frame.time_s:.1f} s",
        f"exposure {record.exposure_ms:.3g} ms",
    ]
    if record.truth is not None:
        words.insert(2, f"range {np.linalg.norm(record.truth.cam_from_target.translation):.2f} m")
    told = f"{record.variant}: {verdict(record)}" if record.variant else verdict(record)
    figure.text(0.015, 0.965, "   ".join(words), color=INK, fontsize=15, weight="bold", va="center")
    figure.text(0.015, 0.935, told, color=INK, fontsize=12, va="center")
    figure.text(0.015, 0.015, f"{CHAIN.legend}. {STRETCH}.", color=DIM, fontsize=9, va="center")
