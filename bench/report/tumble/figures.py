"""Figures of a run on rendered frames: errors, and what the images showed, against time."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from bench.report.plot import OTHER, colour_of, drawn_svg
from bench.scoring.score import shown_labels
from models.arrays import Floats

Score = dict[str, Any]


def error_figure(score: Score) -> str:
    """Draw the errors of the filtered state and of the image's own pose, with what is stated."""

    def draw(figure: Figure) -> None:
        variants = list(shown_labels(score))
        axes = figure.subplots(2, len(variants), sharex=True, sharey="row", squeeze=False)
        rows = (
            ("position_m", "raw_position_m", "sigma_position_m", "position error, m"),
            ("attitude_deg", "raw_attitude_deg", "sigma_attitude_deg", "attitude error, deg"),
        )
        for column, variant in enumerate(variants):
            frames = score["pipelines"][variant]["per_frame"]
            time_s = np.array([frame["time_s"] for frame in frames])
            for row, (filtered, raw, stated, what) in enumerate(rows):
                panel = axes[row][column]
                colour = colour_of(variant, list(shown_labels(score)))
                panel.plot(
                    time_s, _errors(frames, raw), ".", color=OTHER, ms=3.0, label="pose alone"
                )
                panel.plot(
                    time_s, _errors(frames, filtered), color=colour, lw=1.3, label="filtered"
                )
                panel.plot(
                    time_s,
                    _errors(frames, stated),
                    color=colour,
                    lw=0.9,
                    ls="--",
                    label="1 sigma stated",
                )
                lost = np.array([frame["reason"] is not None for frame in frames])
                if lost.any():
                    low = panel.get_ylim()[0]
                    panel.plot(
                        time_s[lost],
                        np.full(int(lost.sum()), max(low, 1e-3)),
                        "x",
                        color="#b3261e",
                        ms=4.0,
                        label="no pose from this image",
                    )
                if (_errors(frames, filtered) > 0.0).any():
                    panel.set_yscale("log")
                panel.set_ylabel(what)
                panel.set_title(f"{variant}: {what.split(',')[0]}")
        for panel in axes[-1]:
            panel.set_xlabel("time, s")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 5.8))  # fmt: skip


def corner_figure(score: Score, variant: str) -> str:
    """Draw how many landmarks each image showed, how many the Sun reached, how many were found."""

    def draw(figure: Figure) -> None:
        panel = figure.subplots()
        frames = score["pipelines"][variant]["per_frame"]
        time_s = [frame["time_s"] for frame in frames]
        counted = {
            name: [frame["corners"][name] for frame in frames]
            for name in ("visible", "lit", "found")
        }
        panel.fill_between(
            time_s, counted["visible"], step="mid", color="#e3e9ee", label="visible landmarks"
        )
        panel.fill_between(
            time_s, counted["lit"], step="mid", color="#f3e3b0", label="sunlit, of those"
        )
        panel.step(
            time_s,
            counted["found"],
            where="mid",
            color=colour_of(variant, list(shown_labels(score))),
            lw=1.4,
            label="found within 3 px",
        )
        panel.set_ylim(0, None)
        panel.set_xlabel("time, s")
        panel.set_ylabel("landmarks")
        figure.legend(loc="outside lower center", ncols=3)

    return drawn_svg(draw, (11.0, 2.8))  # fmt: skip


def _errors(frames: list[dict[str, Any]], name: str) -> Floats:
    values = [frame["error"][name] for frame in frames]
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)
