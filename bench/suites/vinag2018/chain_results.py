"""What the chain came to: errors with a navigated chaser beside those with a true one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from bench.report.numbers import NONE, count, number
from bench.report.plot import COLOURS, FAINT, drawn_svg
from bench.report.table import Table
from bench.suites.units import Outcome
from bench.suites.vinag2018.chain_run import NAVIGATED
from models.arrays import Floats

SETTLED = 0.2  # of a run is left out: the start is drawn, and what it was is no merit
STATE_DOF = 6
PAPER_DEG = 3.0  # VINAG 2018, section 5.2: the attitude error stays below it


@dataclass(frozen=True)
class Chained:
    """One variant with one kind of chaser; errors after the first fifth of each run.

    Attributes
    ----------
    variant, chaser : str
    runs : int
    position_m, attitude_deg : float
        Root mean square of the state.
    raw_position_m, raw_attitude_deg : float
        Of the images alone.
    most_deg : float
        Largest attitude error.
    chaser_m : float
        Root mean square of the chaser's own position error.
    nees_translation, nees_rotation : float
        Over six degrees of freedom.
    lost : int
        Frames without a state.
    """

    variant: str
    chaser: str
    runs: int
    position_m: float
    attitude_deg: float
    raw_position_m: float
    raw_attitude_deg: float
    most_deg: float
    chaser_m: float
    nees_translation: float
    nees_rotation: float
    lost: int


def chained(variant: str, chaser: str, outcomes: Sequence[Outcome]) -> Chained:
    """Summarise the runs of one variant with one kind of chaser.

    Parameters
    ----------
    variant, chaser : str
    outcomes : sequence of Outcome
        See ``chain_run.follow``.
    """
    runs = [
        {name: each[round(SETTLED * len(each)) :] for name, each in own.values.items()}
        for own in outcomes
    ]
    pooled = {name: np.concatenate([run[name] for run in runs]) for name in runs[0]}
    return Chained(
        variant=variant,
        chaser=chaser,
        runs=len(runs),
        position_m=_rms(pooled["position_m"]),
        attitude_deg=_rms(pooled["attitude_deg"]),
        raw_position_m=_rms(pooled["raw_position_m"]),
        raw_attitude_deg=_rms(pooled["raw_attitude_deg"]),
        most_deg=float(np.nanmax(pooled["attitude_deg"], initial=0.0)),
        chaser_m=_rms(pooled["chaser_m"]),
        nees_translation=float(np.nanmean(pooled["nees_translation"])) / STATE_DOF,
        nees_rotation=float(np.nanmean(pooled["nees_rotation"])) / STATE_DOF,
        lost=int(np.isnan(pooled["position_m"]).sum()),
    )


def chain_table(found: Sequence[Chained]) -> Table:
    """Set navigated chasers beside true ones."""
    true = {each.variant: each for each in found if each.chaser != NAVIGATED}
    rows = []
    for own in found:
        other = true.get(own.variant)
        over = NONE
        if other is not None and own.chaser == NAVIGATED:
            over = (
                f"{number(own.position_m / other.position_m)}, "
                f"{number(own.attitude_deg / other.attitude_deg)}"
            )
        rows.append(
            [
                f"{own.variant}, chaser {own.chaser}, {own.runs} runs",
                number(1e3 * own.position_m),
                number(1e3 * own.raw_position_m),
                number(own.attitude_deg, 2),
                number(own.raw_attitude_deg, 2),
                number(own.most_deg, 2),
                over,
                number(own.nees_translation),
                number(own.nees_rotation),
                number(own.chaser_m) if own.chaser == NAVIGATED else NONE,
                count(own.lost),
            ]
        )
    head = ["", "position, mm", "images alone", "attitude, deg", "images alone", "at most, deg",
            "over the true chaser's", "NEES, translation", "NEES, rotation", "chaser off by, m",
            "no state"]  # fmt: skip
    return Table(head, rows, {}, {})


def chain_figure(runs: dict[str, Outcome]) -> str:
    """Draw Figures 11 and 12: errors of the images alone and of the filters, run 0.

    Parameters
    ----------
    runs : dict of str to Outcome
        By variant, of the navigated chaser.
    """

    def draw(figure: Figure) -> None:
        axes = figure.subplots(2, len(runs), sharex=True, sharey="row", squeeze=False)
        for column, (variant, own) in enumerate(runs.items()):
            times_s = own.values["time_s"]
            for row, (name, unit) in enumerate((("position_m", "m"), ("attitude_deg", "deg"))):
                panel = axes[row][column]
                raw: Floats = own.values[f"raw_{name}"]
                panel.plot(times_s, raw, ".", ms=2.0, color=FAINT, label="image alone",
                           rasterized=True)  # fmt: skip
                panel.plot(times_s, own.values[name], color=COLOURS[variant], lw=0.8,
                           label=f"{variant}: filters", rasterized=True)  # fmt: skip
                panel.set_yscale("log")
                panel.set_ylabel(f"{name.split('_')[0]} error, {unit}")
            axes[0][column].set_title(f"{variant}, run 0")
            axes[1][column].set_xlabel("time, s")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))

    return drawn_svg(draw, (11.0, 4.6))


def _rms(values: Floats) -> float:
    there = values[~np.isnan(values)]
    return float(np.sqrt(np.mean(there**2))) if there.size else float("nan")
