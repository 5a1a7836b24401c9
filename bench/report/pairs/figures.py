"""Figures of a score, as SVG: pose error, centroid error and number of markers against time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bench.report.plot import INK, OTHER, colour_of, column, drawn_svg
from models.arrays import Floats

FEW = 80  # up to so many frames each is a dot of its own
ROBUST_PERCENT = 97.0
MOST_TIMES_BEST = 5.0  # no variant's errors may make a panel so wide that best is a line in it
Score = dict[str, Any]


def pose_error_figure(score: Score) -> str:
    """Draw the error of position and attitude along the camera's axes, with 3-sigma bounds."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots(2, 3, sharex=True)
        rows = (
            ("position_mm", "sigma_position_mm", "bound_position_mm", "mm", "position"),
            ("rotation_vector_deg", "sigma_rotation_deg", "bound_rotation_deg", "deg", "attitude"),
        )
        for row, (key, sigma, bound, unit, what) in zip(axes, rows, strict=True):
            for axis, panel in enumerate(row):
                _error_panel(panel, score, (key, sigma, bound), axis)
                about = "along" if what == "position" else "about"
                panel.set_title(f"{what} {about} {'xyz'[axis]}")
                panel.set_ylabel(unit)
        for panel in axes[-1]:
            panel.set_xlabel("time, s")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 5.6))


def centroid_figure(score: Score, published_std_px: Sequence[float] | None) -> str:
    """Draw each marker's centroid error against time, a row for each variant."""

    def draw(figure: Figure) -> None:
        variants = _ordered(score)
        axes = figure.subplots(len(variants), 2, sharex=True, squeeze=False)
        names = _marker_names(score)
        palette = mpl.colormaps["tab10"]
        for row, variant in zip(axes, variants, strict=True):
            frames = score["pipelines"][variant]["per_frame"]
            for axis, panel in enumerate(row):
                for place, name in enumerate(names):
                    errors = [f["centroid_error_px"].get(name) for f in frames]
                    error_px = [np.nan if e is None else e[axis] for e in errors]
                    time_s = column(frames, "time_s")
                    many = len(frames) > FEW
                    panel.plot(
                        time_s, error_px, "." if many else "o-", color=palette(place % 10),
                        ms=1.6 if many else 2.6, lw=0.8, label=f"#{name}", rasterized=many,
                    )  # fmt: skip
                panel.set_title(f"{variant}: {'uv'[axis]}")
                panel.set_ylabel("px")
                if published_std_px is not None:
                    for side in (-1.0, 1.0):
                        panel.axhline(side * published_std_px[axis], color=OTHER, ls=":", lw=1.1)
                sizes = [abs(error_px[axis]) for f in frames for error_px in _errors_px(f)]
                _limit(panel, float(np.percentile(sizes, ROBUST_PERCENT)) if sizes else 0.0)
        for panel in axes[-1]:
            panel.set_xlabel("time, s")
        handles, labels = axes[0][0].get_legend_handles_labels()
        legend = figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
        for handle in legend.legend_handles:
            if isinstance(handle, Line2D):
                handle.set_markersize(5.0)

    return drawn_svg(draw, (11.0, 2.6 * len(score["pipelines"]) + 0.5))


def markers_figure(score: Score) -> str:
    """Draw how many markers were whole, and how many each variant solved with."""

    def draw(figure: Figure) -> None:
        panel = figure.subplots()
        variants = _ordered(score)
        frames = score["pipelines"][variants[0]]["per_frame"]
        time_s = [f["time_s"] for f in frames]
        whole = [f["whole"] for f in frames]
        panel.fill_between(time_s, whole, step="mid", color="#e3e9ee", label="lit and in view")
        for variant in variants:
            frames = score["pipelines"][variant]["per_frame"]
            panel.step(
                [f["time_s"] for f in frames], [f["used"] for f in frames], where="mid",
                color=colour_of(variant, _ordered(score)), lw=1.5, label=f"used by {variant}",
                ls="-" if variant == "best" else "--",
            )  # fmt: skip
        if max(whole, default=0) >= 4:
            told = "four, the least that can be checked"
            panel.axhline(4, color=OTHER, lw=0.9, ls=":", label=told)
        panel.set_ylim(0, max([*whole, 4]) + 1)
        panel.set_xlabel("time, s")
        panel.set_ylabel("markers")
        figure.legend(loc="outside lower center", ncols=4)

    return drawn_svg(draw, (11.0, 2.6))


def _error_panel(panel: Axes, score: Score, keys: tuple[str, str, str], axis: int) -> None:
    error_key, sigma_key, bound_key = keys
    own, others = 0.0, 0.0
    for variant in _ordered(score):
        frames = score["pipelines"][variant]["per_frame"]
        time_s, error = column(frames, "time_s"), column(frames, error_key, axis)
        colour = colour_of(variant, _ordered(score))
        sizes = np.abs(error[np.isfinite(error)])
        if len(sizes):
            others = max(others, float(np.percentile(sizes, ROBUST_PERCENT)))
        if variant == "best" or len(score["pipelines"]) == 1:
            stated = 3.0 * column(frames, sigma_key, axis)
            bound = 3.0 * column(frames, bound_key, axis)
            panel.fill_between(
                time_s, -stated, stated, color=colour, alpha=0.14, lw=0,
                label=f"3 sigma stated by {variant}",
            )  # fmt: skip
            panel.plot(time_s, bound, "--", color=INK, lw=0.9, label="3 sigma of the bound")
            panel.plot(time_s, -bound, "--", color=INK, lw=0.9)
            own = float(np.max([*sizes, *bound[np.isfinite(bound)]], initial=0.0))
        many = len(frames) > FEW
        panel.plot(
            time_s, error, "-" if many else "o-", color=colour, ms=3.2, lw=0.6 if many else 1.1,
            alpha=0.75 if many else 1.0, label=f"error, {variant}",
        )  # fmt: skip
    panel.axhline(0.0, color="#8a97a3", lw=0.7)
    _limit(panel, max(own, min(others, MOST_TIMES_BEST * own)))
    for variant in _ordered(score):
        _mark_beyond(panel, score, variant, (error_key, axis))


def _mark_beyond(panel: Axes, score: Score, variant: str, key: tuple[str, int]) -> None:
    """Put a triangle at the edge for what lies beyond the panel, and a cross for no pose."""
    frames = score["pipelines"][variant]["per_frame"]
    time_s, error = column(frames, "time_s"), column(frames, *key)
    edge = panel.get_ylim()[1]
    colour = colour_of(variant, _ordered(score))
    marks = (
        (error > edge, 0.96 * edge, "^"),
        (error < -edge, -0.96 * edge, "v"),
        (np.isnan(error), -0.9 * edge, "x"),
    )
    for there, height, sign in marks:
        at = np.full(int(there.sum()), height)
        panel.plot(time_s[there], at, sign, color=colour, ms=4.5, ls="none")


def _limit(panel: Axes, reach: float) -> None:
    """Centre the panel on zero, as wide as nearly everything in it needs."""
    if reach > 0.0:
        panel.set_ylim(-1.35 * reach, 1.35 * reach)


def _errors_px(frame: dict[str, Any]) -> list[Floats]:
    return list(frame["centroid_error_px"].values())


def _marker_names(score: Score) -> list[str]:
    names = {
        name
        for variant in score["pipelines"].values()
        for frame in variant["per_frame"]
        for name in frame["centroid_error_px"]
    }
    return sorted(names, key=lambda name: (len(name), name))


def _ordered(score: Score) -> list[str]:
    """Return the variants with ``best`` last, so that it is drawn on top."""
    return sorted(score["pipelines"], key=lambda variant: (variant == "best", variant))
