"""What the suite came to, part by part, from the outcomes of its units."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.suites.units import Outcome, done_outcome
from bench.suites.vinag2018.availability import STATES
from bench.suites.vinag2018.cases import CASES, Case
from bench.suites.vinag2018.chain_results import Chained, chained
from bench.suites.vinag2018.chain_run import CHASERS
from bench.suites.vinag2018.integrity_results import Diagnosed, diagnosed
from bench.suites.vinag2018.plan import Cell, Plan
from bench.suites.vinag2018.star_results import Surveyed, surveyed
from bench.suites.vinag2018.star_survey import SKIES
from bench.suites.vinag2018.summaries import (
    BoundSummary,
    FlightSummary,
    bound_summary,
    flight_summary,
    stacked,
)
from pipelines.absolute.options import VARIANTS

LAST_S = 100.0  # of a flight with a fault: well after it
UNBOUNDED = ("mask", "stars")  # parts whose flights have no bound of their own
DIAGNOSED = (*CASES, "faults")
STARTED_S = 60  # seconds of a sampled flight that are left out


@dataclass(frozen=True)
class Flown:
    """A cell beside its bound; None where it has none."""

    cell: Cell
    flight: FlightSummary
    bound: BoundSummary | None


@dataclass(frozen=True)
class Counted:
    """Satellites of a case over an orbit.

    Attributes
    ----------
    case : Case
    visible, tracked, used : float
        In the mean.
    enough : float
        Share of the time with four or more to use.
    """

    case: Case
    visible: float
    tracked: float
    used: float
    enough: float


@dataclass(frozen=True)
class FaultOutcome:
    """How a fault was met.

    Attributes
    ----------
    name : str
    noticed : float
        Share of the runs in which it was told of: the satellite named, the gap known by its
        missing epochs, the star frame refused.
    delay_s : float or None, s
        From its start until all runs that tell of it do, in the mean.
    worst_m, worst_deg : float
        Largest errors from its start on, of all runs.
    after_m, after_deg : float
        Root mean square over the last 100 s.
    """

    name: str
    noticed: float
    delay_s: float | None
    worst_m: float
    worst_deg: float
    after_m: float
    after_deg: float


@dataclass(frozen=True)
class Sampled:
    """The same run by 100 Hz steps and by gyroscope samples summed between star frames.

    Attributes
    ----------
    position, attitude : float
        Root mean square of 100 Hz over that of sums.
    apart : float
        Largest difference of the two errors of position over the stated sigma.
    """

    position: float
    attitude: float
    apart: float


@dataclass(frozen=True)
class Results:
    """Everything the report says; parts that were not asked for are empty."""

    flights: dict[str, tuple[Flown, ...]]
    counted: tuple[Counted, ...]
    faults: tuple[FaultOutcome, ...]
    sampled: Sampled | None
    surveyed: tuple[Surveyed, ...]
    chained: tuple[Chained, ...] = ()
    diagnosed: tuple[Diagnosed, ...] = ()


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
        self.folder = folder

    def flights(self, cell: Cell) -> list[Outcome]:
        """Return the runs of a cell."""
        return [done_outcome(self.folder, unit) for unit in self.plan.flown(cell)]

    def bound(self, cell: Cell) -> Outcome:
        """Return the bound of a cell."""
        return done_outcome(self.folder, self.plan.bound(cell))

    def count(self, case: Case) -> Outcome:
        """Return the satellites of a case."""
        return done_outcome(self.folder, self.plan.count(case))

    def results(self) -> Results:
        """Summarise all parts of the plan.

        Raises
        ------
        DatasetError
            If a unit is not done.
        """
        parts = self.plan.parts
        flown = [part for part in parts if part in (*CASES, "model", "lasting", "mask", "stars")]
        return Results(
            flights={
                part: tuple(
                    self._flown(cell, bounded=part not in UNBOUNDED)
                    for cell in self.plan.flights(part)
                )
                for part in flown
            },
            counted=(
                tuple(map(self._counted, self.plan.counted())) if "availability" in parts else ()
            ),
            faults=tuple(map(self._fault, self.plan.flights("faults")))
            if "faults" in parts
            else (),
            sampled=self._sampled() if "sampling" in parts else None,
            surveyed=tuple(map(self._surveyed, SKIES)) if "stars" in parts else (),
            chained=self._chained() if "chain" in parts else (),
            diagnosed=tuple(
                diagnosed(cell, self.flights(cell))
                for part in DIAGNOSED
                if part in parts
                for cell in self.plan.flights(part)
            ),
        )

    def chain(self, variant: str, chaser: str) -> list[Outcome]:
        """Return the runs of a variant with one kind of chaser."""
        return [done_outcome(self.folder, each) for each in self.plan.chained(variant, chaser)]

    def _chained(self) -> tuple[Chained, ...]:
        return tuple(
            chained(variant, chaser, self.chain(variant, chaser))
            for variant in VARIANTS
            for chaser in CHASERS
        )

    def _surveyed(self, sky: str) -> Surveyed:
        return surveyed(sky, [done_outcome(self.folder, unit) for unit in self.plan.surveyed(sky)])

    def _flown(self, cell: Cell, bounded: bool) -> Flown:
        return Flown(
            cell,
            flight_summary(self.flights(cell), cell.modelled),
            bound_summary(self.bound(cell)) if bounded else None,
        )

    def _counted(self, case: Case) -> Counted:
        values = self.count(case).values
        return Counted(
            case,
            float(values["visible"].mean()),
            float(values["tracked"].mean()),
            float(values["used"].mean()),
            float((values["used"] >= STATES).mean()),
        )

    def _fault(self, cell: Cell) -> FaultOutcome:
        outcomes = self.flights(cell)
        time_s = outcomes[0].values["time_s"].astype(np.float64)
        fault = self.plan.flown(cell)[0].task.faults
        size_m = np.linalg.norm(stacked(outcomes, "position_m"), axis=-1)
        size_deg = np.rad2deg(np.linalg.norm(stacked(outcomes, "attitude_rad"), axis=-1))
        start_s = fault.start_s
        since, last = time_s >= start_s, time_s > time_s[-1] - LAST_S
        if fault.lie_m:
            told = stacked(outcomes, "named") > 0.0
        elif fault.swapped_frames:
            told = np.zeros_like(size_m, dtype=np.bool_)
            refused = np.concatenate([each.values["refused"] for each in outcomes])
            told[since] = refused > 0
        else:
            told = np.broadcast_to((outcomes[0].values["used"] == 0)[:, None], size_m.shape)
        first_s = [
            float(time_s[own][0]) - start_s for own in (told & since[:, None]).T if own.any()
        ]
        return FaultOutcome(
            cell.fault,
            len(first_s) / told.shape[1],
            float(np.mean(first_s)) if first_s else None,
            float(size_m[since].max()),
            float(size_deg[since].max()),
            float(np.sqrt(np.mean(size_m[last] ** 2))),
            float(np.sqrt(np.mean(size_deg[last] ** 2))),
        )

    def _sampled(self) -> Sampled:
        sums, steps = (self.flights(cell) for cell in self.plan.flights("sampling"))
        rms = [
            [
                float(np.sqrt(np.mean(stacked(own, name)[STARTED_S:] ** 2)))
                for name in ("position_m", "attitude_rad")
            ]
            for own in (sums, steps)
        ]
        apart = np.abs(stacked(sums, "position_m") - stacked(steps, "position_m"))[STARTED_S:, 0]
        sigma = sums[0].values["sigma"][STARTED_S:, :3]
        return Sampled(rms[1][0] / rms[0][0], rms[1][1] / rms[0][1], float((apart / sigma).max()))
