"""Figures 5 and 6 of the paper, acquisitions, and the filters' consistency, as SVG."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bench.report.plot import COLOURS, INK, OTHER, drawn_svg
from bench.suites.consistency import CONFIDENCE, consistency
from bench.suites.pesce2019.cases import case
from bench.suites.pesce2019.plan import ACQUIRED_CASES, RATE_HZ, VARIANTS
from bench.suites.pesce2019.results import Outcomes
from bench.suites.pesce2019.summaries import STATE_DOF, stacked
from models.arrays import Floats

CASE_COLOURS = {"1": "#1763a6", "2": "#b3261e", "3": "#3a8f4d"}
QUANTITIES = (
    ("position_m", "raw_position_m", "position error, m"),
    ("attitude_deg", "raw_attitude_deg", "attitude error, deg"),
)
MOST_DECADES = 3.5  # a panel shows no more below its largest value


def filter_figure(outcomes: Outcomes) -> str:
    """Draw Figure 5: case 1, one run, with and without the filter, and the bound of both."""
    cell = outcomes.plan.table6()[0]
    bound = outcomes.bound(cell)

    def draw(figure: Figure) -> None:
        axes = figure.subplots(2, 2, sharex=True, sharey="row")
        for column, variant in enumerate(VARIANTS):
            run = outcomes.tracking(cell, variant)[0]
            for row, (filtered, raw, what) in enumerate(QUANTITIES):
                panel = axes[row][column]
                time_s = _time_s(run.values[filtered])
                panel.plot(
                    time_s,
                    run.values[raw],
                    color=OTHER,
                    lw=0.6,
                    alpha=0.7,
                    label="pose alone",
                    rasterized=True,
                )
                panel.plot(
                    time_s,
                    run.values[filtered],
                    color=COLOURS[variant],
                    lw=1.1,
                    label=f"filtered, {variant}",
                )
                panel.plot(
                    time_s, bound.values[raw], color=INK, lw=0.9, ls=":", label="bound of one image"
                )
                panel.plot(
                    time_s,
                    bound.values[filtered],
                    color=INK,
                    lw=0.9,
                    ls="--",
                    label="bound of any filter",
                )
                panel.set_yscale("log")
                panel.set_ylabel(what)
                panel.set_title(f"{variant}: {what.split(',')[0]}")
                _limit(panel, [run.values[raw], run.values[filtered], bound.values[filtered]])
                panel.legend(loc="upper right", fontsize=7.5, ncols=2)
        for panel in axes[-1]:
            panel.set_xlabel("time, s")

    return drawn_svg(draw, (11.0, 6.4))  # fmt: skip


def mean_error_figure(outcomes: Outcomes) -> str:
    """Draw Figure 6: mean error over the runs of the three LEO cases."""
    cells = [cell for cell in outcomes.plan.table6() if cell.case.key in CASE_COLOURS]

    def draw(figure: Figure) -> None:
        axes = figure.subplots(2, 2, sharex=True, sharey="row")
        for column, variant in enumerate(VARIANTS):
            for row, (filtered, _, what) in enumerate(QUANTITIES):
                panel, shown = axes[row][column], []
                for cell in cells:
                    errors = stacked(outcomes.tracking(cell, variant), filtered)
                    mean = _mean_over_runs(errors)
                    panel.plot(
                        _time_s(mean),
                        mean,
                        lw=1.1,
                        color=CASE_COLOURS[cell.case.key],
                        label=f"case {cell.case.key}, {cell.case.name}",
                    )
                    shown.append(mean)
                panel.set_yscale("log")
                panel.set_ylabel(what)
                runs = outcomes.plan.sizes.of_variant(variant, cells[0].runs)
                panel.set_title(f"{variant}: mean {what.split(',')[0]}, {runs} runs")
                _limit(panel, shown)
        for panel in axes[-1]:
            panel.set_xlabel("time, s")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 6.4))  # fmt: skip


def consistency_figure(outcomes: Outcomes) -> str:
    """Draw the mean NEES over the runs, over time, with the band of an honest filter."""
    cells = [cell for cell in outcomes.plan.table6() if cell.case.key in CASE_COLOURS]

    def draw(figure: Figure) -> None:
        axes = figure.subplots(2, 2, sharex=True, sharey="row")
        for column, variant in enumerate(VARIANTS):
            for row, name in enumerate(("nees_translation", "nees_rotation")):
                panel = axes[row][column]
                for cell in cells:
                    squares = stacked(outcomes.tracking(cell, variant), name)
                    mean = _mean_over_runs(squares) / STATE_DOF
                    panel.plot(
                        _time_s(mean),
                        mean,
                        lw=0.9,
                        color=CASE_COLOURS[cell.case.key],
                        label=f"case {cell.case.key}, {cell.case.name}",
                    )
                low, high = consistency(squares, STATE_DOF).bounds
                panel.axhspan(
                    low, high, color="#e3e9ee", label=f"{100 * CONFIDENCE:g} % of an honest filter"
                )
                panel.axhline(1.0, color=INK, lw=0.7)
                panel.set_yscale("log")
                panel.set_ylabel("NEES / 6")
                panel.set_title(f"{variant}: {name.split('_')[1]}")
        for panel in axes[-1]:
            panel.set_xlabel("time, s")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 5.6))  # fmt: skip


def acquisition_figure(outcomes: Outcomes) -> str:
    """Draw Figure 4 as distributions: the share of acquisitions that are better than an error."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots(1, 2, sharey=True)
        for panel, name, what in zip(
            axes,
            ("position_m", "attitude_deg"),
            ("position error, m", "attitude error, deg"),
            strict=True,
        ):
            for key in ACQUIRED_CASES:
                for variant in VARIANTS:
                    found = outcomes.acquisitions(case(key), variant)
                    errors = np.concatenate([each.values[name] for each in found]).astype(float)
                    there = np.sort(errors[np.isfinite(errors)])
                    share = np.arange(1, len(there) + 1) / len(errors)
                    panel.step(
                        there,
                        share,
                        where="post",
                        color=CASE_COLOURS[key],
                        lw=1.2,
                        ls="-" if variant == "best" else "--",
                        label=f"case {key}, {variant}",
                    )
            panel.set_xscale("log")
            panel.set_xlabel(what)
        axes[0].set_ylabel("share of runs better")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 3.6))  # fmt: skip


def _time_s(values: Sequence[float] | Floats) -> Floats:
    return np.arange(len(values)) / RATE_HZ


def _mean_over_runs(errors: Floats) -> Floats:
    """Return the mean over the runs that have an error at an instant; NaN where none has."""
    there = np.isfinite(errors)
    sums = np.where(there, errors, 0.0).sum(axis=0)
    return np.asarray(np.divide(sums, there.sum(axis=0), out=np.full(len(sums), np.nan),
                                where=there.any(axis=0)))  # fmt: skip


def _limit(panel: Axes, shown: Sequence[Floats]) -> None:
    values = np.concatenate([np.asarray(each, dtype=np.float64) for each in shown])
    values = values[np.isfinite(values) & (values > 0.0)]
    if values.size:
        high = float(values.max())
        panel.set_ylim(max(0.7 * float(values.min()), high / 10**MOST_DECADES), 1.5 * high)
