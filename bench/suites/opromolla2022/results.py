"""What the suite came to, sequence by sequence, from the outcomes of its units."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from bench.suites.opromolla2022.asked import AskedLine, asked_of_study, asked_of_table
from bench.suites.opromolla2022.cases import Sequence, studies
from bench.suites.opromolla2022.plan import VARIANTS, Plan
from bench.suites.opromolla2022.summaries import (
    OverPaper,
    PerFrame,
    Runs,
    Statistics,
    SunVerdict,
    exact,
    lost_alone,
    over_paper,
    per_frame,
    statistics,
    sun_verdict,
)
from bench.suites.units import Outcome, done_outcome


@dataclass(frozen=True)
class FlownSequence:
    """One sequence.

    Attributes
    ----------
    sequence : Sequence
    statistics : dict
        By variant, and of exact centroids.
    per_frame : dict
        By variant.
    over_paper : OverPaper or None
    asked : list of AskedLine
    """

    sequence: Sequence
    statistics: dict[str, Statistics | None]
    per_frame: dict[str, PerFrame]
    over_paper: OverPaper | None
    asked: list[AskedLine]


@dataclass(frozen=True)
class MappedSun:
    """One Sun of the map."""

    sun: str
    verdicts: dict[str, SunVerdict]
    per_frame: dict[str, PerFrame]


@dataclass(frozen=True)
class Results:
    """Everything the report says; parts that were not asked for are empty."""

    sequences: tuple[FlownSequence, ...]
    suns: tuple[MappedSun, ...]
    studies: dict[str, tuple[FlownSequence, ...]]


class Outcomes:
    """Reads the outcomes of a plan's units.

    Parameters
    ----------
    plan : Plan
    folder : Path
        Of the units.
    """

    def __init__(self, plan: Plan, folder: Path) -> None:
        self.plan = plan
        self._folder = folder
        self._last: tuple[list[str], list[Outcome]] = ([], [])

    def of(self, own: Sequence) -> list[Outcome]:
        """Return the outcomes that hold a sequence's runs; the last ones read are kept."""
        units = self.plan.units_of(own)
        names = [unit.name for unit in units]
        if names != self._last[0]:
            self._last = (names, [done_outcome(self._folder, unit) for unit in units])
        return self._last[1]

    def runs(self, own: Sequence, variant: str) -> Runs:
        """Return the runs of a sequence by a variant."""
        return Runs(self.of(own), own.errors, variant)

    def results(self) -> Results:
        """Summarise all sequences.

        Raises
        ------
        DatasetError
            If a unit is not done.
        """
        flown = self.plan.sequences
        return Results(
            tuple(self._flown(own, by_runs=False) for own in flown if not own.once),
            tuple(self._mapped(own) for own in flown if own.once),
            {
                name: tuple(self._flown(own, by_runs=True) for own in studies(name))
                for name in self.plan.studied
            },
        )

    def _flown(self, own: Sequence, by_runs: bool) -> FlownSequence:
        outcomes = self.of(own)
        runs = {variant: Runs(outcomes, own.errors, variant) for variant in VARIANTS}
        told = {variant: statistics(each) for variant, each in runs.items()}
        peer = statistics(exact(outcomes, own.errors))
        met = {variant: per_frame(each) for variant, each in runs.items()}
        over = over_paper(runs["best"], runs["paper"], by_runs)
        if by_runs:
            alone = lost_alone(runs["best"], runs["paper"])
            asked = asked_of_study(own.name, own.errors, over, met["best"], alone)
        else:
            asked = asked_of_table(own.name, told["best"], peer, over, met["best"])
        return FlownSequence(own, {**told, "exact": peer}, met, over, asked)

    def _mapped(self, own: Sequence) -> MappedSun:
        runs = {variant: self.runs(own, variant) for variant in VARIANTS}
        return MappedSun(
            own.sun,
            {variant: sun_verdict(each) for variant, each in runs.items()},
            {variant: per_frame(each) for variant, each in runs.items()},
        )
