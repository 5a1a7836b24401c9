"""The figures of an unknown target: errors over time with what is stated, and the cloud."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from bench.report.plot import FAINT, OTHER, colour_of, drawn_svg
from bench.scoring.score import shown_labels
from models.arrays import Floats

Score = dict[str, Any]
PANELS = (
    ("range", "distance error, %"),
    ("attitude", "attitude error, deg"),
    ("rate", "rate error, deg/s"),
    ("axis", "spin axis error, deg"),
)
VIEWS = ((0, 1, "x, m", "y, m"), (0, 2, "x, m", "z, m"), (1, 2, "y, m", "z, m"))


def error_figure(score: Score) -> str:
    """Draw the errors of every pipeline against time, with 1 sigma as stated, as SVG."""

    def draw(figure: Figure) -> None:
        labels = list(shown_labels(score))
        axes = figure.subplots(2, 2, sharex=True).ravel()
        for panel, (name, title) in zip(axes, PANELS, strict=True):
            for label in labels:
                frames, colour = score["pipelines"][label]["per_frame"], colour_of(label, labels)
                time_s = [frame["time_s"] for frame in frames]
                error, sigma = _series(frames, name)
                panel.plot(time_s, error, color=colour, lw=1.2, label=label)
                if np.isfinite(sigma).any():
                    panel.plot(time_s, sigma, color=colour, lw=0.9, ls="--", label="1 sigma stated")
                if (error > 0.0).any():
                    panel.set_yscale("log")
            panel.set_title(title.split(",")[0])
            panel.set_ylabel(title)
        for panel in axes[-2:]:
            panel.set_xlabel("time, s")
        handles, names = axes[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=max(1, len(names)))

    return drawn_svg(draw, (11.0, 5.8))


def track_figure(score: Score, label: str) -> str:
    """Draw how many tracks each image had, and how many were points of the shape, as SVG."""

    def draw(figure: Figure) -> None:
        panel, frames = figure.subplots(), score["pipelines"][label]["per_frame"]
        time_s = [frame["time_s"] for frame in frames]
        colour = colour_of(label, list(shown_labels(score)))
        panel.plot(time_s, [frame["tracks"] for frame in frames], color=OTHER, label="tracks")
        panel.plot(
            time_s, [frame["used"] for frame in frames], color=colour, label="points of the shape"
        )
        panel.set_ylim(0, None)
        panel.set_xlabel("time, s")
        panel.set_ylabel("tracks in an image")
        figure.legend(loc="outside lower center", ncols=2)

    return drawn_svg(draw, (11.0, 2.8))


def cloud_figure(points: Floats, away_m: Floats, surface: Floats) -> str:
    """Draw a cloud over the true surface, in three views along its axes, as SVG.

    Parameters
    ----------
    points : (n, 3) array, m
        True axes.
    away_m : (n,) array, m
        Their distances to the surface.
    surface : (k, 3) array, m
        Places of it.
    """

    def draw(figure: Figure) -> None:
        axes = figure.subplots(1, 3)
        shown = None
        for panel, (across, up, right, top) in zip(axes, VIEWS, strict=True):
            panel.plot(
                surface[:, across], surface[:, up], ",", color=FAINT, rasterized=True, zorder=1
            )
            shown = panel.scatter(
                points[:, across], points[:, up], c=100.0 * away_m, s=9.0, cmap="viridis_r",
                vmin=0.0, vmax=20.0, zorder=2, linewidths=0.0,
            )  # fmt: skip
            low, high = surface.min(axis=0) - 1.0, surface.max(axis=0) + 1.0
            panel.set_xlim(low[across], high[across])
            panel.set_ylim(low[up], high[up])
            panel.set_aspect("equal")
            panel.set_xlabel(right)
            panel.set_ylabel(top)
        if shown is not None:
            figure.colorbar(shown, ax=axes, label="from the surface, cm", shrink=0.8)

    return drawn_svg(draw, (11.0, 4.2))


def _series(frames: list[dict[str, Any]], name: str) -> tuple[Floats, Floats]:
    """Return the errors and stated sigmas of one quantity, NaN where there is none."""
    error, sigma = np.full(len(frames), np.nan), np.full(len(frames), np.nan)
    for place, frame in enumerate(frames):
        motion = frame["motion"]
        if motion is None:
            continue
        if name == "range":
            error[place] = 100.0 * abs(motion["range_share"])
            if motion["sigma_range_m"] is not None:
                sigma[place] = 100.0 * motion["sigma_range_m"] / frame["range_m"]
        elif name == "attitude":
            error[place], sigma[place] = _pair(
                frame["attitude_error_deg"], motion["sigma_attitude_deg"]
            )
        elif name == "rate":
            error[place], sigma[place] = _pair(motion["rate_deg_s"], motion["sigma_rate_deg_s"])
        else:
            error[place] = motion["axis_deg"]
    return error, sigma


def _pair(error: float | None, sigma: float | None) -> tuple[float, float]:
    return tuple(float("nan") if each is None else each for each in (error, sigma))  # type: ignore[return-value]
