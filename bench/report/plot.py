"""How figures look, and how they become text."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from bench.report.plain_text import take_literally
from bench.report.time_plot import position_unit
from models.arrays import Floats

COLOURS = {"best": "#1763a6", "paper": "#d1781d"}
OTHERS = ("#5b7083", "#2a8f5b", "#8d4aa8", "#a8324a")
OTHER = OTHERS[0]
INK, FAINT = "#22303c", "#c9d1d8"
STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "figure.facecolor": "none",  # a page is dark where its reader wants it so
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
    "axes.edgecolor": "#8a97a3",
    "axes.labelcolor": INK,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e6eaee",
    "grid.linewidth": 0.7,
    "xtick.color": INK,
    "ytick.color": INK,
    "text.color": INK,
    "legend.frameon": False,
    "svg.hashsalt": "rvbench",
}
RASTER_DPI = 130  # of what is too many points for lines


def colour_of(label: str, labels: list[str]) -> str:
    """Return the colour of a pipeline among those of a figure."""
    if label in COLOURS:
        return COLOURS[label]
    others = [each for each in labels if each not in COLOURS]
    return OTHERS[others.index(label) % len(OTHERS)]


def column(frames: list[dict[str, Any]], key: str, axis: int | None = None) -> Floats:
    """Return one number of every frame, (n,); NaN where there is none.

    Parameters
    ----------
    frames : list of dict
        ``per_frame`` of a score.
    key : str
    axis : int, optional
        Of numbers that come in threes.
    """
    values = [frame[key] for frame in frames]
    if axis is not None:
        values = [None if value is None else value[axis] for value in values]
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


def errors_over_time(score: dict[str, Any]) -> str:
    """Draw position and attitude errors of every pipeline against time, as SVG."""

    def draw(figure: Figure) -> None:
        labels = list(score["pipelines"])
        axes = figure.subplots(1, 2, sharex=True)
        length, of_a_millimetre = position_unit(score)
        for panel, key, what, factor in (
            (axes[0], "position_error_mm", f"position error, {length}", of_a_millimetre),
            (axes[1], "attitude_error_deg", "attitude error, deg", 1.0),
        ):
            for label in labels:
                frames = score["pipelines"][label]["per_frame"]
                panel.plot(
                    column(frames, "time_s"),
                    factor * column(frames, key),
                    "o-",
                    ms=3.0,
                    lw=1.0,
                    color=colour_of(label, labels),
                    label=label,
                )
            panel.set_title(what.split(",")[0])
            panel.set_ylabel(what)
            panel.set_xlabel("time, s")
        handles, names = axes[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=len(names))

    return drawn_svg(draw, (11.0, 3.2))


def drawn_svg(draw: Callable[[Figure], None], size: tuple[float, float]) -> str:
    """Return as SVG text, the same for the same drawing, what ``draw`` puts on a figure.

    Parameters
    ----------
    draw : callable
    size : (float, float)
        Width and height, inches.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=size)
        FigureCanvasSVG(figure)
        draw(figure)
        take_literally(figure)
        layout = ConstrainedLayoutEngine(h_pad=0.09, hspace=0.05)
        layout.execute(figure)  # by hand: as the figure's own it has everything drawn twice
        stream = io.StringIO()
        figure.savefig(
            stream, format="svg", dpi=RASTER_DPI, metadata={"Date": None, "Creator": None}
        )
    return stream.getvalue()


def svg_address(svg: str) -> str:
    """Return an SVG as a ``data:`` address."""
    return "data:image/svg+xml;base64," + base64.b64encode(svg.encode()).decode()
