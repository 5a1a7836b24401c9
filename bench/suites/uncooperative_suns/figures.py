"""Maps of found, refused and wrong over phase angle, size, light and attitude; and how honest."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bench.report.plot import COLOURS, FAINT, INK, drawn_svg
from bench.suites.uncooperative_suns.results import (
    LIT_EDGES,
    PHASE_EDGES_DEG,
    SHARE_EDGES,
    Counts,
    Starts,
    Summary,
)
from models.arrays import Floats, Mask

FOUND, REFUSED, WRONG = "#2a8f5b", "#9aa7b2", "#b3261e"
MARKS = (("found", FOUND, "o", 16.0), ("refused", REFUSED, "x", 16.0), ("wrong", WRONG, "D", 30.0))
BEYOND = 3.0  # of an axis, so that marks at its ends are whole
LEAST_TOLD = 1e-3  # of a logarithmic axis of probabilities


def outcome_map(starts: Starts) -> str:
    """Draw every start by phase angle and size, by lit share, and by attitude, as SVG."""
    to_camera = -starts.attitude[:, 2]  # the boresight's third row: where the camera stands
    azimuth = np.rad2deg(np.arctan2(to_camera[:, 1], to_camera[:, 0]))
    elevation = np.rad2deg(np.arcsin(np.clip(to_camera[:, 2], -1.0, 1.0)))

    def draw(figure: Figure) -> None:
        left, middle, right = figure.subplots(1, 3)
        _scatter(left, starts, starts.phase_deg, 100.0 * starts.share)
        left.set_xlabel("phase angle, deg")
        left.set_ylabel("width of the field, %")
        left.set_title("phase angle and size")
        _scatter(middle, starts, starts.phase_deg, 100.0 * starts.lit)
        middle.set_xlabel("phase angle, deg")
        middle.set_ylabel("lit share of the silhouette, %")
        middle.set_title("phase angle and light")
        _scatter(right, starts, azimuth, elevation)
        right.set_xlabel("azimuth of the camera, deg")
        right.set_ylabel("elevation, deg")
        right.set_title("attitude: the camera in target axes")
        for panel, across, up in (
            (left, PHASE_EDGES_DEG, 100.0 * np.array(SHARE_EDGES)),
            (middle, PHASE_EDGES_DEG, 100.0 * np.array(LIT_EDGES)),
            (right, (-180.0, 180.0), (-90.0, 90.0)),
        ):
            panel.set_xlim(across[0] - BEYOND, across[-1] + BEYOND)
            panel.set_ylim(up[0] - BEYOND, up[-1] + BEYOND)
        handles, names = left.get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=len(names))

    return drawn_svg(draw, (11.0, 3.6))


def bar_figure(summary: Summary) -> str:
    """Draw how starts ended by bins of phase angle, size and lit share, as SVG."""

    def draw(figure: Figure) -> None:
        panels = figure.subplots(1, 3)
        rows = (
            ("phase angle, deg", PHASE_EDGES_DEG, summary.phase, 1.0),
            ("width of the field, %", SHARE_EDGES, summary.share, 100.0),
            ("lit share of the silhouette, %", LIT_EDGES, summary.lit_share, 100.0),
        )
        for panel, (what, edges, counted, factor) in zip(panels, rows, strict=True):
            _bars(panel, edges, counted, factor)
            panel.set_xlabel(what)
            panel.set_ylabel("starts")
        handles, names = panels[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=len(names))

    return drawn_svg(draw, (11.0, 3.2))


def reliability_figure(summaries: dict[str, Summary]) -> str:
    """Draw the share of claims that were wrong against what was told of them, by target, as SVG."""

    def draw(figure: Figure) -> None:
        panel = figure.subplots()
        for number, (target, summary) in enumerate(summaries.items()):
            colour = (*COLOURS.values(), INK)[number % 3]
            told = np.array([max(claim.told, LEAST_TOLD) for claim in summary.claims])
            wrong = np.array([claim.wrong / claim.claims for claim in summary.claims])
            low = np.array([claim.low for claim in summary.claims])
            high = np.array([claim.high for claim in summary.claims])
            if len(told):
                panel.errorbar(
                    told * 1.04**number, np.maximum(wrong, LEAST_TOLD),
                    yerr=[np.maximum(wrong, LEAST_TOLD) - np.maximum(low, LEAST_TOLD),
                          np.maximum(high, LEAST_TOLD) - np.maximum(wrong, LEAST_TOLD)],
                    fmt="o", color=colour, label=target, capsize=3.0,
                )  # fmt: skip
                none = wrong < LEAST_TOLD
                panel.plot(
                    told[none] * 1.04**number, np.full(none.sum(), LEAST_TOLD),
                    "o", color=colour, markerfacecolor="white", zorder=3,
                )  # fmt: skip
        panel.plot([LEAST_TOLD, 1.0], [LEAST_TOLD, 1.0], color=FAINT, lw=1.0)
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xlabel("probability of being wrong, as told")
        panel.set_ylabel("share that was wrong, 95 % (hollow: none)")
        if any(summary.claims for summary in summaries.values()):
            panel.legend()

    return drawn_svg(draw, (5.5, 4.0))


def _scatter(panel: Axes, starts: Starts, x: Floats, y: Floats) -> None:
    chosen: tuple[Mask, ...] = (starts.right, ~starts.claimed, starts.wrong)
    for (name, colour, marker, size), own in zip(MARKS, chosen, strict=True):
        panel.scatter(x[own], y[own], s=size, c=colour, marker=marker, label=name, lw=1.0)


def _bars(panel: Axes, edges: Sequence[float], counted: Sequence[Counts], factor: float) -> None:
    names = [f"{factor * low:g}-{factor * high:g}" for low, high in pairwise(edges)]
    base = np.zeros(len(counted))
    for (name, colour, _, _), own in zip(
        MARKS,
        ([c.found for c in counted], [c.refused for c in counted], [c.wrong for c in counted]),
        strict=True,
    ):
        panel.bar(names, own, bottom=base, color=colour, label=name)
        base += np.array(own)
    panel.tick_params(axis="x", labelsize=7.5)
