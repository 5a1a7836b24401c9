"""Figures 6 to 10 of the paper, and errors over time beside their bounds, as SVG."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bench.report.plot import COLOURS, INK, OTHER, drawn_svg
from bench.report.table import TITLES
from bench.suites.consistency import CONFIDENCE, honest_band
from bench.suites.volpe2017 import shape_bound
from bench.suites.volpe2017.cases import states_of
from bench.suites.volpe2017.motion_errors import MOTION_DOF
from bench.suites.volpe2017.plan import VARIANTS
from bench.suites.volpe2017.results import Outcomes
from models.arrays import Floats
from models.motion.boresight_pointing import HILL_FROM_LVLH

AXIS_COLOURS = ("#1763a6", "#b3261e", "#3a8f4d", "#d1781d", "#8d4aa8", "#5b7083")
SHOWN = tuple(reversed(VARIANTS))
LOWEST_SHARE = 0.1  # of the bound: an attitude is exact in the first frame, by choice of axes
LINEAR_SHARE = 3.0  # of the late errors' median: within it a panel's axis is linear
BOUNDED = (
    ("position_m", "relative position, m"), ("velocity_m_s", "relative velocity, m/s"),
    ("attitude_deg", "attitude, deg"), ("rate_deg_s", "angular velocity, deg/s"),
    ("shape_m", "points, m"), ("inertia_percent", "inertia, % of the trace"),
)  # fmt: skip


def component_figure(
    outcomes: Outcomes, rows: Sequence[tuple[str, str]], entries: Sequence[str] = ("1", "2", "3")
) -> str:
    """Draw errors in components against time, run 0: a row a quantity, a column a variant.

    Parameters
    ----------
    outcomes : Outcomes
    rows : sequence of (str, str)
        Name of the quantity, and what is written beside it.
    entries : sequence of str
        What its components are called.
    """
    case = outcomes.plan.paper_case()

    def draw(figure: Figure) -> None:
        axes = figure.subplots(len(rows), len(SHOWN), sharex=True, squeeze=False)
        for column, variant in enumerate(SHOWN):
            runs = outcomes.runs(case, variant)
            for row, (name, what) in enumerate(rows):
                panel = axes[row][column]
                errors = runs.vector(name, len(entries))[0]
                for entry, title in enumerate(entries):
                    panel.plot(case.times_s, errors[:, entry], color=AXIS_COLOURS[entry], lw=1.0,
                               label=title)  # fmt: skip
                _stretch(panel, errors)
                panel.set_ylabel(what)
                panel.set_title(f"{TITLES[variant]}: {what.split(',')[0]}")
                if row == len(rows) - 1:
                    panel.set_xlabel("time, s")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 0.6 + 2.5 * len(rows)))


def inertia_figure(outcomes: Outcomes) -> str:
    """Draw Figure 10: errors of the inertia; best has no scale, and its is over the trace."""
    case = outcomes.plan.paper_case()
    entries = ("11", "22", "33", "12", "13", "23")

    def draw(figure: Figure) -> None:
        axes = figure.subplots(1, 2, sharex=True)
        for panel, variant, name, what in zip(
            axes,
            SHOWN,
            ("inertia_percent", "inertia_kg_m2"),
            ("inertia, % of the trace", "inertia, kg m²"),
            strict=True,
        ):
            errors = outcomes.runs(case, variant).vector(name, 6)[0]
            for entry, title in enumerate(entries):
                panel.plot(case.times_s, errors[:, entry], color=AXIS_COLOURS[entry], lw=1.0,
                           label=title)  # fmt: skip
            _stretch(panel, errors)
            panel.set_ylabel(what)
            panel.set_xlabel("time, s")
            panel.set_title(f"{TITLES[variant]}: {what.split(',')[0]}")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 3.2))


def points_figure(outcomes: Outcomes) -> str:
    """Draw Figure 7: the points at the end of run 0, true and estimated, from three sides."""
    case = outcomes.plan.paper_case()
    true = case.points_in_target

    def draw(figure: Figure) -> None:
        axes = figure.subplots(2, 3)
        for row, variant in zip(axes, SHOWN, strict=True):
            own = outcomes.runs(case, variant).points[0]
            for panel, (across, up) in zip(row, ((1, 0), (1, 2), (0, 2)), strict=True):
                panel.plot(true[:, across], true[:, up], "o", ms=7, mfc="none", color=INK,
                           label="true")  # fmt: skip
                panel.plot(own[:, across], own[:, up], "x", ms=5, color=COLOURS[variant],
                           label=TITLES[variant])  # fmt: skip
                panel.set_aspect("equal", adjustable="datalim")
                panel.set_xlabel(f"body axis {across + 1}, m")
                panel.set_ylabel(f"body axis {up + 1}, m")
            row[0].set_title(TITLES[variant])
            row[0].legend(loc="upper right", fontsize=7.5)

    return drawn_svg(draw, (11.0, 6.0))


def trajectory_figure(outcomes: Outcomes) -> str:
    """Draw Figure 9c: the chaser's way about the target in the paper's Hill frame, run 0."""
    case = outcomes.plan.paper_case()
    true = np.array([HILL_FROM_LVLH @ state.rho_in_lvlh for state in states_of(case)])

    def draw(figure: Figure) -> None:
        axes = figure.subplots(1, 3)
        for panel, (across, up) in zip(axes, ((2, 0), (2, 1), (0, 1)), strict=True):
            panel.plot(true[:, across], true[:, up], color=INK, lw=2.2, label="true")
            for variant in VARIANTS:
                own = true + outcomes.runs(case, variant).vector("position_m")[0]
                panel.plot(own[:, across], own[:, up], color=COLOURS[variant], lw=0.9, ls="--",
                           label=TITLES[variant])  # fmt: skip
            panel.set_aspect("equal", adjustable="datalim")
            panel.set_xlabel(f"Hill axis {across + 1}, m")
            panel.set_ylabel(f"Hill axis {up + 1}, m")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 3.8))


def bound_figure(outcomes: Outcomes) -> str:
    """Draw errors of all runs over time, best's as rms and the variant's as median, and the bound.

    A variant of which runs go astray has no rms worth drawing.
    """
    case = outcomes.plan.paper_case()
    bound = outcomes.bound(case)
    ways: dict[str, tuple[str, Callable[[Floats], Floats]]] = {
        "best": ("rms", lambda sizes: np.sqrt(np.mean(sizes**2, axis=0))),
        "paper": ("median", lambda sizes: np.median(sizes, axis=0)),
    }

    def draw(figure: Figure) -> None:
        axes = figure.subplots(2, 3, sharex=True)
        for panel, (name, what) in zip(axes.ravel(), BOUNDED, strict=True):
            for variant in SHOWN:
                word, way = ways[variant]
                sizes = outcomes.runs(case, variant).size(name)
                panel.plot(case.times_s, way(sizes), color=COLOURS[variant], lw=1.1,
                           label=f"{TITLES[variant]}, {word} of {len(sizes)}")  # fmt: skip
            least = bound[:, shape_bound.COLUMNS.index(name)]
            panel.plot(case.times_s, least, color=INK, lw=0.9, ls="--", label="bound")
            panel.set_yscale("log")
            panel.set_ylim(bottom=LOWEST_SHARE * float(least[len(least) // 10 :].min()))
            panel.set_ylabel(what)
            panel.set_title(what.split(",")[0])
        for panel in axes[-1]:
            panel.set_xlabel("time, s")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 5.6))


def consistency_figure(outcomes: Outcomes) -> str:
    """Draw the mean NEES of the motion over time, with the band of an honest filter."""
    case = outcomes.plan.paper_case()

    def draw(figure: Figure) -> None:
        axes = figure.subplots(1, 2, sharex=True)
        for panel, variant in zip(axes, SHOWN, strict=True):
            squares = outcomes.runs(case, variant).scalar("nees_motion")
            way = np.mean if variant == "best" else np.median
            mean = way(squares, axis=0) / MOTION_DOF
            panel.plot(case.times_s, mean, color=COLOURS[variant], lw=0.9)
            low, high = honest_band(len(squares), MOTION_DOF)
            panel.axhspan(low, high, color="#e3e9ee", label=f"{100 * CONFIDENCE:g} % of honest")
            panel.axhline(1.0, color=INK, lw=0.7)
            panel.set_yscale("log")
            panel.set_ylabel(f"NEES / {MOTION_DOF}")
            panel.set_xlabel("time, s")
            told = "mean" if variant == "best" else "median"
            panel.set_title(f"{TITLES[variant]}: {told} of {len(squares)} runs")

    return drawn_svg(draw, (11.0, 3.0))


def study_figure(outcomes: Outcomes, part: str, name: str, what: str) -> str:
    """Draw a quantity of a study's cases over time: rms over the runs, and the bounds dashed.

    Parameters
    ----------
    outcomes : Outcomes
    part : str
    name : str
        Of the quantity.
    what : str
        What is written beside it.
    """
    cases = outcomes.plan.cases(part)
    groups = [cases]
    if part == "observability":
        groups = [[case for case in cases if (case.range_to == "none") == lost]
                  for lost in (False, True)]  # fmt: skip

    def draw(figure: Figure) -> None:
        axes = figure.subplots(1, len(groups), sharey=True, squeeze=False)[0]
        for panel, group in zip(axes, groups, strict=True):
            for place, case in enumerate(group):
                colour = (*AXIS_COLOURS, OTHER, INK)[place % 8]
                sizes = outcomes.runs(case, "best").size(name)
                mean = np.sqrt(np.nanmean(_from_first(sizes) ** 2, axis=0))
                panel.plot(case.times_s[-len(mean) :], mean, color=colour, lw=1.0, label=case.name)
                least = outcomes.bound(case)[:, shape_bound.COLUMNS.index(name)]
                panel.plot(case.times_s, least, color=colour, lw=0.8, ls="--")
            panel.set_yscale("log")
            panel.set_xlabel("time, s")
            if part == "observability":
                lost = group[0].range_to == "none"
                panel.set_title("without range" if lost else "with range")
        axes[0].set_ylabel(what)
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)

    return drawn_svg(draw, (11.0, 3.8))


def _from_first(sizes: Floats) -> Floats:
    """Return the frames from the first on in which there is a size at all."""
    there = np.flatnonzero(np.isfinite(sizes).any(axis=0))
    return sizes[:, there[0] :] if there.size else sizes[:, :0]


def _stretch(panel: Axes, errors: Floats) -> None:
    """Let a panel show metres at the beginning and millimetres at the end, with their signs."""
    late = np.abs(errors[len(errors) // 2 :])
    linear = LINEAR_SHARE * float(np.nanmedian(late)) if np.isfinite(late).any() else 1.0
    panel.set_yscale("symlog", linthresh=max(linear, 1e-9))
    panel.axhline(0.0, color=INK, lw=0.6)
    ticks = panel.get_yticks()
    if len(ticks) > 9:  # a decade each on both sides is too many to read
        panel.set_yticks([one for one, _ in pairwise(ticks[::2])])
