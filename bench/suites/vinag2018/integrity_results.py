"""What the filter's diagnostics are worth: false alarms, missed lies, errors beyond their level."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.report.numbers import NONE, number, share
from bench.report.table import TITLES, Table
from bench.suites.units import Outcome
from bench.suites.vinag2018.plan import FAULTS, Cell
from bench.suites.vinag2018.summaries import settled, stacked
from renders.flight.faults import Faults


@dataclass(frozen=True)
class Diagnosed:
    """How often a cell's filter was right about its sensors and about itself.

    Attributes
    ----------
    cell : Cell
    ranges : int
        Of satellites that did not lie, at the instants that are kept.
    edited_healthy : float
        Share of them that was left out all the same.
    named_healthy : int
        Run-seconds, or what is kept of them, in which an honest satellite was called a liar.
    lies : int
        Ranges that were false.
    lies_used : float or None
        Share of them that was used; None without any.
    stars : int
        Star frames of the right field.
    stars_refused : float
        Share of them that was refused.
    instants : int
        At which a protection level was stated, settled.
    beyond : float
        Share of them at which an error of position was beyond it, on any axis.
    most : float
        Largest error over its level.
    """

    cell: Cell
    ranges: int
    edited_healthy: float
    named_healthy: int
    lies: int
    lies_used: float | None
    stars: int
    stars_refused: float
    instants: int
    beyond: float
    most: float


def diagnosed(cell: Cell, outcomes: Sequence[Outcome]) -> Diagnosed:
    """Count over all runs of a cell.

    Parameters
    ----------
    cell : Cell
    outcomes : sequence of Outcome
    """
    time_s = outcomes[0].values["time_s"].astype(np.float64)
    own = settled(len(time_s))
    faults = FAULTS.get(cell.fault, Faults())
    edited, of_liar = (stacked(outcomes, name) for name in ("edited", "edited_liar"))
    lying = (faults.lie_start_s <= time_s) & (time_s < faults.lie_end_s) & bool(faults.lie_m)
    lies = int(lying.sum()) * edited.shape[1]
    used = float(outcomes[0].values["used"].sum()) * edited.shape[1]
    # While it does not lie, the liar is as healthy as any.
    false = float(edited.sum() - of_liar[lying].sum())
    refused = float(sum(each.values["refused"].sum() for each in outcomes))
    wrong_stars = faults.swapped_frames * edited.shape[1]
    stars = round(cell.span_s * cell.star_rate_hz) * edited.shape[1] - wrong_stars
    beyond = stacked(outcomes, "beyond")[own]
    return Diagnosed(
        cell=cell,
        ranges=round(used) - lies,
        edited_healthy=false / max(used - lies, 1.0),
        named_healthy=int(stacked(outcomes, "named_healthy").sum()),
        lies=lies,
        lies_used=1.0 - float(of_liar[lying].sum()) / lies if lies else None,
        stars=stars,
        stars_refused=max(refused - wrong_stars, 0.0) / stars,
        instants=beyond.size,
        beyond=float(np.mean(beyond > 1.0)),
        most=float(beyond.max()),
    )


def diagnosed_table(found: Sequence[Diagnosed]) -> Table:
    """List false alarms and missed detections, a row for each cell.

    Parameters
    ----------
    found : sequence of Diagnosed
    """
    head = ["", "", "honest ranges left out", "honest called liars", "false ranges used",
            "right star frames refused", "beyond protection level",
            "largest over level"]  # fmt: skip
    rows = [
        [
            f"{own.cell.case.name}{f', {own.cell.fault}' if own.cell.fault else ''}",
            TITLES[own.cell.variant],
            f"{share(own.edited_healthy)} of {own.ranges}",
            str(own.named_healthy),
            NONE if own.lies_used is None else f"{share(own.lies_used)} of {own.lies}",
            f"{share(own.stars_refused)} of {own.stars}",
            f"{share(own.beyond)} of {own.instants}",
            number(own.most),
        ]
        for own in found
    ]
    return Table(head, rows, {}, {})
