"""What a suite came to, part by part, from the outcomes of its units."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.suites.units import done_outcome
from bench.suites.volpe2017.cases import Case
from bench.suites.volpe2017.plan import VARIANTS, Plan
from bench.suites.volpe2017.summaries import (
    CaseSummary,
    Improvement,
    Runs,
    case_summary,
    improvements,
    went_astray,
)
from models.arrays import Floats

AXES = 3


@dataclass(frozen=True)
class PaperResults:
    """The paper's own case.

    Attributes
    ----------
    summary : CaseSummary
        Of ``best``.
    table1 : dict
        By variant and quantity: errors in components at the end of run 0.
    table2 : dict
        By variant: norms at the beginning and at the end.
    runs, astray : dict
        By variant: how many, and how many of them end worse than they began.
    """

    summary: CaseSummary
    table1: dict[str, dict[str, list[float]]]
    table2: dict[str, list[Improvement]]
    runs: dict[str, int]
    astray: dict[str, int]


@dataclass(frozen=True)
class StudiedCase:
    """One case of a study."""

    case: Case
    summary: CaseSummary


@dataclass(frozen=True)
class StepTime:
    """How long a frame takes, by points; never the same twice.

    Attributes
    ----------
    points, frames : int
    median_ms, p95_ms, largest_ms, mean_ms : float, ms
        Of one core.
    """

    points: int
    frames: int
    median_ms: float
    p95_ms: float
    largest_ms: float
    mean_ms: float


@dataclass(frozen=True)
class Results:
    """Everything the report says; parts that were not asked for are empty."""

    paper: PaperResults | None
    observability: tuple[StudiedCase, ...]
    tracks: tuple[StudiedCase, ...]
    frame_ms: tuple[StepTime, ...]


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

    def runs(self, case: Case, variant: str) -> Runs:
        """Return the runs of a case by a variant."""
        units = self.plan.tracking(case, variant)
        return Runs([done_outcome(self._folder, unit) for unit in units])

    def bound(self, case: Case) -> Floats:
        """Return a case's bound, (frames, columns)."""
        found = done_outcome(self._folder, self.plan.bound(case)).values["bound"]
        return np.asarray(found, dtype=np.float64)

    def results(self) -> Results:
        """Summarise all parts of the plan.

        Raises
        ------
        DatasetError
            If a unit is not done.
        """
        return Results(
            self._paper() if "paper" in self.plan.parts else None,
            self._studied("observability"),
            self._studied("tracks"),
            tuple(self._timed(case) for case in self.plan.cases("speed")),
        )

    def _paper(self) -> PaperResults:
        case = self.plan.paper_case()
        runs = {variant: self.runs(case, variant) for variant in VARIANTS}
        return PaperResults(
            case_summary(runs["best"], self.bound(case)),
            {variant: _components(own) for variant, own in runs.items()},
            {variant: improvements(own) for variant, own in runs.items()},
            {variant: len(own) for variant, own in runs.items()},
            {variant: went_astray(own) for variant, own in runs.items()},
        )

    def _studied(self, part: str) -> tuple[StudiedCase, ...]:
        return tuple(
            StudiedCase(case, case_summary(self.runs(case, "best"), self.bound(case)))
            for case in self.plan.cases(part)
        )

    def _timed(self, case: Case) -> StepTime:
        taken_ms = 1e3 * self.runs(case, "best").seconds.ravel()
        middle, most = np.percentile(taken_ms, [50.0, 95.0])
        return StepTime(
            case.points,
            len(taken_ms),
            float(middle),
            float(most),
            float(taken_ms.max()),
            float(taken_ms.mean()),
        )


TABLE_1 = (
    ("first_from_chaser_m", AXES), ("first_from_centre_m", AXES), ("attitude_deg", AXES),
    ("rate_deg_s", AXES), ("position_m", AXES), ("velocity_m_s", AXES),
    ("inertia_kg_m2", 2 * AXES), ("inertia_percent", 2 * AXES),
)  # fmt: skip


def _components(runs: Runs) -> dict[str, list[float]]:
    """Return the errors in components at the end of run 0."""
    return {
        name: runs.vector(name, size)[0, -1].tolist()
        for name, size in TABLE_1
        if np.isfinite(runs.vector(name, size)[0, -1]).all()
    }
