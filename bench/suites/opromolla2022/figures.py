"""The paper's figures in its form: mean and 3-sigma band over time, centroids, the map of Suns."""

from __future__ import annotations

from collections.abc import Sequence as Many

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bench.report.plot import COLOURS, INK, drawn_svg
from bench.report.table import TITLES
from bench.suites.opromolla2022.cases import Sequence, published
from bench.suites.opromolla2022.results import FlownSequence, MappedSun, Outcomes
from bench.suites.opromolla2022.summaries import PARAMETERS, Runs
from models.arrays import Floats
from models.lights.sun import EYE_IN_HAND_SUNS_DEG

SHOWN = ("paper", "best")
IN_PANELS = np.array([1e3, 1e3, 1e3, 1.0, 1.0, 1.0])
FIGURE_22 = {"green": "#2a8f5b", "yellow": "#f0a817", "red": "#d0342c"}
MARKS = {"green": "o", "yellow": "s", "red": "X"}
BEST_SHARE = 4.0  # no variant makes a panel so wide that best is a line in it


def band_figure(outcomes: Outcomes, own: Sequence) -> str:
    """Draw the mean over the runs and three sigmas of them, each pose parameter against time.

    Parameters
    ----------
    outcomes : Outcomes
    own : Sequence
    """
    runs = {variant: outcomes.runs(own, variant) for variant in SHOWN}

    def draw(figure: Figure) -> None:
        axes = figure.subplots(2, 3, sharex=True)
        for place, panel in enumerate(axes.ravel()):
            reach = {}
            for variant, each in runs.items():
                mean, spread = _over_runs(each, place)
                colour = COLOURS[variant]
                panel.fill_between(
                    each.time_s, mean - 3.0 * spread, mean + 3.0 * spread, color=colour, alpha=0.18,
                    lw=0,
                )  # fmt: skip
                panel.plot(each.time_s, mean, "-", color=colour, lw=1.2, label=TITLES[variant])
                sizes = np.abs(mean) + 3.0 * np.nan_to_num(spread)
                there = sizes[np.isfinite(sizes)]
                reach[variant] = float(np.percentile(there, 97.0)) if there.size else 0.0
            most = max(reach["best"], min(reach["paper"], BEST_SHARE * reach["best"]))
            if most > 0.0:
                panel.set_ylim(-1.2 * most, 1.2 * most)
            panel.axhline(0.0, color=INK, lw=0.6)
            panel.set_title(f"error of {PARAMETERS[place]}")
            panel.set_ylabel("mm" if place < 3 else "deg")
        for panel in axes[-1]:
            panel.set_xlabel("time, s")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2)

    return drawn_svg(draw, (11.0, 5.2))


def _over_runs(runs: Runs, place: int) -> tuple[Floats, Floats]:
    """Return mean and standard deviation over the runs of a parameter, mm or deg, by frame."""
    errors = runs.errors[..., place] * IN_PANELS[place]
    there = np.isfinite(errors)
    many = there.sum(axis=0)
    filled = np.where(there, errors, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = filled.sum(axis=0) / np.where(many > 0, many, np.nan)
        around = np.where(there, errors - mean, 0.0)
        spread = np.sqrt((around**2).sum(axis=0) / np.where(many > 1, many - 1, np.nan))
    return np.asarray(mean), np.asarray(spread)


def centroid_figure(outcomes: Outcomes, own: Sequence) -> str:
    """Draw the centroid error of each marker against time, run 0.

    Parameters
    ----------
    outcomes : Outcomes
    own : Sequence
    """
    printed = published()["centroids"].get(own.name)

    def draw(figure: Figure) -> None:
        axes = figure.subplots(len(SHOWN), 2, sharex=True, squeeze=False)
        palette = mpl.colormaps["tab10"]
        for row, variant in zip(axes, SHOWN, strict=True):
            runs = outcomes.runs(own, variant)
            errors = runs.of("centroids")[0].astype(np.float64)
            for axis, panel in enumerate(row):
                for marker in range(errors.shape[1]):
                    panel.plot(
                        runs.time_s, errors[:, marker, axis], ".-", color=palette(marker % 10),
                        ms=3.5, lw=0.7, label=f"#{marker + 1}",
                    )  # fmt: skip
                if printed is not None:
                    for side in (-1.0, 1.0):
                        panel.axhline(side * printed["std"][axis], color=INK, ls=":", lw=0.9)
                panel.set_title(f"{TITLES[variant]}: {'uv'[axis]}")
                panel.set_ylabel("px")
        for panel in axes[-1]:
            panel.set_xlabel("time, s")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 5.4))


def sun_figure(suns: Many[MappedSun]) -> str:
    """Draw Figure 22: where each Sun stands in the orbital frame, and what came of it.

    A heavy rim: truth has less than 90 % of some dot lit and seen. Beneath, where frames are lost
    or the outline helped: poses of how many frames, and in brackets those by the outline.

    Parameters
    ----------
    suns : sequence of MappedSun
    """

    def draw(figure: Figure) -> None:
        axes = figure.subplots(1, 2, sharey=True)
        for panel, variant in zip(axes, SHOWN, strict=True):
            for own in suns:
                azimuth_deg, elevation_deg = EYE_IN_HAND_SUNS_DEG[own.sun]
                told = own.verdicts[variant]
                colour = told.colour
                panel.plot(
                    azimuth_deg, elevation_deg, MARKS[colour], color=FIGURE_22[colour], ms=9.0,
                    mec=INK, mew=1.8 if told.few else 0.5,
                )  # fmt: skip
                if told.poses < told.frames or told.outline_of_few:
                    outline = f" ({told.outline_of_few})" if told.outline_of_few else ""
                    panel.annotate(
                        f"{told.poses}/{told.frames}{outline}", (azimuth_deg, elevation_deg),
                        xytext=(0, -13), textcoords="offset points", ha="center", fontsize=6.0,
                    )  # fmt: skip
                panel.annotate(
                    own.sun.removeprefix("E-S"), (azimuth_deg, elevation_deg), xytext=(0, 7),
                    textcoords="offset points", ha="center", fontsize=7.0,
                )  # fmt: skip
            panel.set_title(TITLES[variant])
            panel.set_xlabel("azimuth in the orbital plane, deg")
            panel.margins(0.08, 0.12)
            panel.invert_xaxis()
        axes[0].set_ylabel("elevation, deg")
        legend = {
            "green": "all dots in every frame",
            "yellow": "some lost from a frame on",
            "red": "all lost from a frame on",
        }
        handles = [
            Line2D(
                [], [], ls="none", marker=MARKS[name], color=FIGURE_22[name], mec=INK, label=text
            )
            for name, text in legend.items()
        ]
        handles.append(
            Line2D(
                [], [], ls="none", marker="o", color="none", mec=INK, mew=1.8,
                label="some dot in shadow",
            )
        )  # fmt: skip
        figure.legend(handles=handles, loc="outside lower center", ncols=4)

    return drawn_svg(draw, (11.0, 4.6))


def sensitivity_figure(studies: Many[FlownSequence]) -> str:
    """Draw the rms of position and attitude under each error, both variants.

    Parameters
    ----------
    studies : sequence of FlownSequence
        Of one light, a set of errors each.
    """

    def draw(figure: Figure) -> None:
        axes = figure.subplots(1, 2, sharey=True)
        names = [own.sequence.errors.replace("_", " ") for own in studies]
        for panel, key, what in zip(
            axes, ("position_mm", "attitude_deg"), ("position, mm rms", "attitude, deg rms"),
            strict=True,
        ):  # fmt: skip
            for variant, shift in zip(SHOWN, (0.17, -0.17), strict=True):
                told = [getattr(own.per_frame[variant], key) for own in studies]
                sizes = [each[2] if each else np.nan for each in told]
                places = np.arange(len(names)) + shift
                panel.plot(
                    sizes, places, "o", color=COLOURS[variant], ms=5.0, label=TITLES[variant]
                )
            panel.set_xscale("log")
            panel.set_xlabel(what)
            panel.set_yticks(range(len(names)), names)
            panel.invert_yaxis()
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2)

    return drawn_svg(draw, (11.0, 0.8 + 0.33 * len(studies)))
