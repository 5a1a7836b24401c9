"""A comparison's figures: standings with their intervals, errors over conditions, recall."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from bench.compare.comparison import Comparison
from bench.compare.conditions import conditions
from bench.compare.leaderboard import MEASURES, Value, frame_values
from bench.report.plot import INK, colour_of, drawn_svg
from bench.scoring.pose_summary import errors_of
from models.arrays import Floats

MOST_TICKS = 5  # whose numbers do not run into each other
WIDE_SPAN = 30.0  # over which the powers of ten are numbers enough
LEAST_SPAN = 1e-3  # of an axis, over the value at its middle


def standing_figure(comparison: Comparison) -> str:
    """Draw each measure of every method with its interval, as SVG."""
    standings = comparison.board.standings
    labels = [standing.label for standing in standings]
    names = [name for name in MEASURES if name in standings[0].values]

    def draw(figure: Figure) -> None:
        panels = figure.subplots(1, len(names), sharey=True, squeeze=False)[0]
        for panel, name in zip(panels, names, strict=True):
            for place, standing in enumerate(standings):
                own = standing.values[name]
                if own.value is None:
                    continue
                low, high = _drawn(own)
                panel.errorbar(
                    own.value, place, xerr=[[own.value - low], [high - own.value]], fmt="o",
                    ms=5.0, capsize=3.0, color=colour_of(standing.label, sorted(labels)),
                )  # fmt: skip
            panel.set_title(MEASURES[name].title)
            panel.set_xlabel(MEASURES[name].unit)
            panel.set_yticks(range(len(labels)), labels)
            if name != "ar":
                _logarithmic(panel, "x")
        panels[0].invert_yaxis()

    return drawn_svg(draw, (11.0, 1.4 + 0.32 * len(labels)))


def recall_figure(comparison: Comparison) -> str:
    """Draw which share of all frames has less than any error, as SVG."""
    labels = sorted(each.label for each in comparison.measures)

    def draw(figure: Figure) -> None:
        panels = figure.subplots(1, 3, sharey=True)
        titles = ("position over range", "position, m", "attitude, deg")
        for each in comparison.measures:
            errors = errors_of(comparison.view, each)
            columns = (errors.position_m / errors.range_m, errors.position_m, errors.attitude_deg)
            for panel, own in zip(panels, columns, strict=True):
                x, y = _steps(own)
                colour = colour_of(each.label, labels)
                panel.step(x, y, where="post", lw=1.4, color=colour, label=each.label)
        for panel, title in zip(panels, titles, strict=True):
            panel.set_title(title)
            _logarithmic(panel, "x")
            panel.set_ylim(0.0, 1.02)
            panel.set_xlabel("error less than")
        panels[0].set_ylabel("share of all frames")
        handles, names = panels[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=min(6, len(names)))

    return drawn_svg(draw, (11.0, 3.6))


def condition_figure(comparison: Comparison) -> str:
    """Draw each frame's SPEED score against range, phase angle and tumble rate, as SVG."""
    told = conditions(comparison.view)
    axes = [
        (values, title)
        for values, title in (
            (told.range_m, "range, m"),
            (told.phase_deg, "phase angle, deg"),
            (told.tumble_deg_s, "tumble rate, deg/s"),
        )
        if values is not None
    ]
    labels = sorted(each.label for each in comparison.measures)

    def draw(figure: Figure) -> None:
        panels = figure.subplots(1, len(axes), sharey=True, squeeze=False)[0]
        for each in comparison.measures:
            scores = frame_values(comparison.view, each)["speed"]
            lost = np.array([frame.lost for frame in each.frames])
            colour = colour_of(each.label, labels)
            for panel, (values, _) in zip(panels, axes, strict=True):
                panel.plot(
                    values[~lost], scores[~lost], "o", ms=3.5, alpha=0.7, color=colour,
                    label=each.label,
                )  # fmt: skip
                panel.plot(values[lost], scores[lost], "x", ms=5.0, color=colour)
        for panel, (_, title) in zip(panels, axes, strict=True):
            panel.set_xlabel(title, color=INK)
            _not_within_nothing(panel)
            _logarithmic(panel, "y")
        panels[0].set_ylabel("SPEED score of the frame")
        handles, names = panels[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=min(6, len(names)))

    return drawn_svg(draw, (11.0, 3.4))


def _not_within_nothing(panel: Any) -> None:
    """Widen an axis along which nothing changes, and write its numbers whole."""
    panel.ticklabel_format(axis="x", useOffset=False)
    low, high = panel.get_xlim()
    middle = 0.5 * (low + high)
    least = LEAST_SPAN * max(abs(middle), 1e-9)
    if high - low < least:
        panel.set_xlim(middle - 0.5 * least, middle + 0.5 * least)


def _logarithmic(panel: Any, along: str) -> None:
    """Draw an axis by powers of ten, where anything on it is above zero."""
    drawn = [line.get_data()["xy".index(along)] for line in panel.lines]
    if any((np.asarray(values, dtype=np.float64) > 0.0).any() for values in drawn):
        panel.set(**{f"{along}scale": "log"})
        axis = panel.xaxis if along == "x" else panel.yaxis
        low, high = axis.get_view_interval()
        subs = (1.0, 2.0, 5.0) if high < WIDE_SPAN * low else (1.0,)
        axis.set_major_locator(LogLocator(subs=subs, numticks=MOST_TICKS))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def _drawn(value: Value) -> tuple[float, float]:
    """Return the ends of a bar; one that is infinite, or on the wrong side by chance, is cut."""
    assert value.value is not None
    low, high = (value.value if end is None else end for end in value.interval)
    return min(low, value.value), max(high, value.value)


def _steps(errors: Floats) -> tuple[Floats, Floats]:
    there = np.sort(errors[np.isfinite(errors)])
    return there, np.arange(1, len(there) + 1) / len(errors)
