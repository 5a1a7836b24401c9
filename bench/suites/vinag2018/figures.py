"""Figures 5 to 10 of the paper, in its form, with bounds; and the filters' consistency."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bench.report.plot import COLOURS, FAINT, INK, drawn_svg
from bench.suites.consistency import CONFIDENCE, consistency
from bench.suites.vinag2018.cases import GEO, LEO, Case
from bench.suites.vinag2018.plan import Cell
from bench.suites.vinag2018.results import Outcomes
from bench.suites.vinag2018.summaries import ORBIT_DOF, TURN_DOF, stacked
from models.arrays import Floats

SHOWN_RUNS = 5
HOUR_S = 3600.0
BAND_SIGMAS = 3.0
AXES = ("x", "y", "z")
SHARE = 0.998  # of the values after the start that a panel must show


def position_figure(outcomes: Outcomes, cells: list[Cell]) -> str:
    """Draw Figure 5 or 7: position errors on inertial axes of some runs, in the bound's band."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots(3, len(cells), sharex=True, sharey="row", squeeze=False)
        for column, cell in enumerate(cells):
            bound = outcomes.bound(cell).values
            flown = outcomes.flights(cell)
            hours = flown[0].values["time_s"] / HOUR_S
            errors = stacked(flown, "position_m")
            for row, axis in enumerate(AXES):
                panel = axes[row][column]
                sigma = np.sqrt(bound["position_m2"][:, row, row])
                _band(panel, bound["time_s"] / HOUR_S, sigma)
                panel.plot(
                    hours,
                    errors[:, :SHOWN_RUNS, row],
                    color=COLOURS[cell.variant],
                    lw=0.6,
                    alpha=0.8,
                    rasterized=True,
                )
                panel.set_ylabel(f"{axis}, m")
                panel.set_title(f"{cell.variant}: {cell.case.name}, position error, {axis}")
                _limit(panel, errors[..., row], widen=column > 0)
        for panel in axes[-1]:
            panel.set_xlabel("time, h")

    return drawn_svg(draw, (11.0, 6.4))


def attitude_figure(outcomes: Outcomes, cells: list[Cell]) -> str:
    """Draw Figure 6 or 8: attitude errors about body axes of some runs, in the bound's band."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots(1, len(cells), sharex=True, sharey=True, squeeze=False)
        for column, cell in enumerate(cells):
            panel = axes[0][column]
            bound = outcomes.bound(cell).values
            flown = outcomes.flights(cell)
            hours = flown[0].values["time_s"] / HOUR_S
            errors = np.rad2deg(stacked(flown, "attitude_rad"))[:, 0]
            _band(panel, bound["time_s"] / HOUR_S, np.rad2deg(bound["attitude_rad"].max(axis=1)))
            for axis, shade in zip(range(3), ("-", "--", ":"), strict=True):
                panel.plot(
                    hours,
                    errors[:, axis],
                    shade,
                    color=COLOURS[cell.variant],
                    lw=0.5,
                    label=f"about {AXES[axis]}",
                    rasterized=True,
                )
            panel.set_title(f"{cell.variant}: {cell.case.name}, attitude error, run 0")
            panel.set_xlabel("time, h")
            _limit(panel, errors, widen=column > 0)
        axes[0][0].set_ylabel("deg")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 3.1))


def availability_figure(outcomes: Outcomes) -> str:
    """Draw Figures 9 and 10: satellites in sight, tracked and used."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots(1, 2)
        for panel, case in zip(axes, (LEO, GEO), strict=True):
            values = outcomes.count(case).values
            hours = values["time_s"] / HOUR_S
            panel.step(hours, values["visible"], color=FAINT, lw=1.0, label="in sight")
            panel.step(hours, values["tracked"], color=COLOURS["paper"], lw=1.0, label="tracked")
            panel.step(hours, values["used"], color=COLOURS["best"], lw=1.0, label="used")
            panel.set_title(f"{case.name}: satellites, {case.gain_dbi:g} dBi")
            panel.set_xlabel("time, h")
            panel.set_ylim(bottom=0)
        axes[0].set_ylabel("satellites")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 3.0))


def consistency_figure(outcomes: Outcomes, cells: list[Cell]) -> str:
    """Draw the mean NEES over the runs, over time, with the band of an honest filter."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots(1, 2, sharex=True, sharey=True)
        for panel, name, dof, what in zip(
            axes,
            ("nees_orbit", "nees_attitude"),
            (ORBIT_DOF, TURN_DOF),
            ("position, velocity, clock", "attitude, gyro bias"),
            strict=True,
        ):
            for cell in cells:
                flown = outcomes.flights(cell)
                squares = stacked(flown, name)
                panel.plot(
                    flown[0].values["time_s"] / HOUR_S,
                    squares.mean(axis=1) / dof,
                    color=COLOURS[cell.variant],
                    lw=0.6,
                    label=cell.variant,
                    rasterized=True,
                )
                low, high = consistency(squares.T, dof).bounds
            panel.axhspan(low, high, color="#e3e9ee", label=f"{100 * CONFIDENCE:g} % if honest")
            panel.axhline(1.0, color=INK, lw=0.7)
            panel.set_yscale("log")
            panel.set_title(f"{cells[0].case.name}: NEES over {dof}: {what}")
            panel.set_xlabel("time, h")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 3.0))


def fault_figure(outcomes: Outcomes, cells: list[Cell]) -> str:
    """Draw how position and attitude of all runs went through each fault."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots(2, len(cells), sharex=True, sharey="row", squeeze=False)
        for column, cell in enumerate(cells):
            flown = outcomes.flights(cell)
            time_s = flown[0].values["time_s"]
            sizes = (
                np.linalg.norm(stacked(flown, "position_m"), axis=-1),
                np.rad2deg(np.linalg.norm(stacked(flown, "attitude_rad"), axis=-1)),
            )
            start_s = outcomes.plan.flown(cell)[0].task.faults.start_s
            for panel, size, what in zip(
                axes[:, column], sizes, ("position error, m", "attitude error, deg"), strict=True
            ):
                panel.plot(time_s, size, color=COLOURS["best"], lw=0.5, alpha=0.8, rasterized=True)
                panel.axvline(start_s, color=INK, lw=0.7, ls=":")
                panel.set_yscale("log")
                panel.set_ylabel(what)
            axes[0][column].set_title(cell.fault)
            axes[1][column].set_xlabel("time, s")

    return drawn_svg(draw, (11.0, 4.6))


def names_of(case: Case) -> tuple[str, str]:
    """Return which of the paper's figures are a case's: position and attitude."""
    return ("Figure 5", "Figure 6") if case.key == LEO.key else ("Figure 7", "Figure 8")


def _band(panel: Axes, hours: Floats, sigma: Floats) -> None:
    panel.fill_between(
        hours,
        -BAND_SIGMAS * sigma,
        BAND_SIGMAS * sigma,
        color="#e3e9ee",
        lw=0.0,
        label=f"bound, {BAND_SIGMAS:g} sigma",
    )


def _limit(panel: Axes, errors: Floats, widen: bool) -> None:
    """Show what comes after the start, which is a thousand times as wide, and what was shown."""
    size = np.abs(errors[len(errors) // 10 :])
    most = 1.3 * float(np.quantile(size, SHARE))
    if widen:  # the row shares its scale
        most = max(most, panel.get_ylim()[1])
    panel.set_ylim(-most, most)
