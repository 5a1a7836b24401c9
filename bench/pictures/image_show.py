"""One single image laid open: whole, and close up, with the wireframe as estimated and as true."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from bench.pictures.frame_records import PREFERRED
from bench.pictures.image_records import ImageRecord, ImageRecords
from bench.pictures.stretch import STRETCH
from bench.pictures.wireframe_overlay import LEGEND, window_around, wireframe_overlay
from bench.report.plain_text import take_literally

PANEL_PX, DPI = 950, 100
INK, PAPER, DIM = "#e8e8e8", "#15181c", "#9aa2ab"


def show_image(folder: Path, index: int, variant: str = PREFERRED) -> NDArray[np.uint8]:
    """Draw one frame of a dataset of single images with its wireframe.

    Parameters
    ----------
    folder : Path
        A dataset; estimates and truth are drawn where it has them.
    index : int
        The frame's number.
    variant : str
        Whose estimates.

    Returns
    -------
    (height, width, 3) uint8 array
        RGB.

    Raises
    ------
    DatasetError
        If there is no such frame or it cannot be read.
    """
    return draw(ImageRecords(folder, variant).record(index))


def draw(record: ImageRecord) -> NDArray[np.uint8]:
    """Draw a frame; see ``show_image``."""
    pose = record.best_known_pose
    near = None if pose is None else window_around(record.knowledge, pose)
    windows = (None, near) if near is not None else (None,)
    figure = Figure(figsize=(0.3 + 9.7 * len(windows), 10.8), dpi=DPI, facecolor=PAPER)
    canvas = FigureCanvasAgg(figure)
    grid = figure.add_gridspec(
        1, len(windows), left=0.01, right=0.99, bottom=0.03, top=0.91, wspace=0.02
    )
    for place, window in enumerate(windows):
        axes = figure.add_subplot(grid[0, place])
        axes.imshow(
            wireframe_overlay(
                record.frame,
                record.knowledge,
                PANEL_PX,
                estimate=record.estimate,
                truth=record.truth,
                window=window,
            )
        )
        axes.set_axis_off()
    _write_heading(figure, record)
    take_literally(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    return np.ascontiguousarray(pixels[:, :, :3])


def _write_heading(figure: Figure, record: ImageRecord) -> None:
    frame = record.frame
    words = [
        f"frame {frame.index}",
        f"t = {frame.time_s:.1f} s",
        f"exposure {frame.exposure_ms:.3g} ms",
    ]
    if record.truth is not None:
        words.insert(2, f"range {np.linalg.norm(record.truth.cam_from_target.translation):.2f} m")
    verdict = f"{record.variant}: {record.verdict}" if record.variant else record.verdict
    figure.text(0.015, 0.965, "   ".join(words), color=INK, fontsize=15, weight="bold", va="center")
    figure.text(0.015, 0.935, verdict, color=INK, fontsize=12, va="center")
    figure.text(0.015, 0.015, f"{LEGEND}. {STRETCH}.", color=DIM, fontsize=9, va="center")
