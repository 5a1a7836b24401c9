"""What ``rvbench suite volpe2017`` does, as units of work."""

from __future__ import annotations

from dataclasses import dataclass

from bench.suites.units import WorkUnit
from bench.suites.volpe2017.cases import (
    Case,
    observability_cases,
    paper_case,
    speed_case,
    track_cases,
)
from bench.suites.volpe2017.shape_bound import BoundTask, bound
from bench.suites.volpe2017.tracking_run import TrackingTask, case_options, track
from models.errors import ScenarioError
from models.reading.options import check_option

PARTS = ("paper", "observability", "tracks", "speed")
VARIANTS = ("paper", "best")
SPEED_POINTS = (12, 50, 100, 200)
MOST_RUNS, MOST_SEED = 100_000, 2**32 - 1
# Seconds on one core of 2025 that a frame takes before any was timed here.
FRAME_S = {"paper": 0.004, "best": 0.005}
BOUND_FRAME_S = 0.001


@dataclass(frozen=True)
class Sizes:
    """How much of everything.

    Attributes
    ----------
    runs : int
        Of the paper's case, where the paper has one.
    paper_runs : int, optional
        Most of them by the paper's own filter.
    seeds : int
        Runs of each other case.
    duration_s : float, optional, s
        Of the paper's case; one orbit unless given.
    study_s, speed_s : float, s
        Of the other cases, and of those that are timed.
    seed : int
    """

    runs: int = 100
    paper_runs: int | None = None
    seeds: int = 10
    duration_s: float | None = None
    study_s: float = 600.0
    speed_s: float = 300.0
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("runs", "seeds", "paper_runs"):
            value = getattr(self, name)
            check_option(f"--{name.replace('_', '-')}", value, 1, MOST_RUNS, whole=True)
        check_option("--seed", self.seed, 0, MOST_SEED, whole=True)
        if self.duration_s is not None and not 60.0 <= self.duration_s <= 1e5:
            raise ScenarioError(
                f"expected --duration-s from 60 (twelve frames) to 100000, got {self.duration_s:g}"
            )

    def of_variant(self, variant: str) -> int:
        """Return how many runs of the paper's case a variant makes."""
        if variant != "paper" or self.paper_runs is None:
            return self.runs
        return min(self.runs, self.paper_runs)


QUICK = Sizes(runs=4, paper_runs=4, seeds=1, duration_s=1500.0, study_s=200.0, speed_s=60.0)


@dataclass(frozen=True, eq=False)
class Plan:
    """The units of a suite.

    Attributes
    ----------
    sizes : Sizes
    parts : tuple of str
    """

    sizes: Sizes
    parts: tuple[str, ...] = PARTS

    def __post_init__(self) -> None:
        strange = [part for part in self.parts if part not in PARTS]
        if strange or not self.parts:
            raise ScenarioError(
                f"expected --parts among {', '.join(PARTS)}, got {', '.join(strange) or 'none'}"
            )

    def units(self) -> list[WorkUnit]:
        """Return every unit, each once."""
        found: list[WorkUnit] = []
        if "paper" in self.parts:
            found.append(self.bound(self.paper_case()))
            for variant in VARIANTS:
                found += self.tracking(self.paper_case(), variant)
        for part in ("observability", "tracks"):
            for case in self.cases(part):
                found += [self.bound(case), *self.tracking(case, "best")]
        for case in self.cases("speed"):
            found += self.tracking(case, "best")
        return found

    def paper_case(self) -> Case:
        """Return the paper's own case."""
        return paper_case(self.sizes.duration_s)

    def cases(self, part: str) -> list[Case]:
        """Return the cases of another part; none if it was not asked for."""
        if part not in self.parts:
            return []
        if part == "observability":
            return observability_cases(self.sizes.study_s)
        if part == "tracks":
            return track_cases(self.sizes.study_s)
        return [speed_case(points, self.sizes.speed_s) for points in SPEED_POINTS]

    def runs(self, case: Case, variant: str) -> int:
        """Return how many runs a case has by a variant."""
        if case.key == "paper":
            return self.sizes.of_variant(variant)
        return 1 if case.key.startswith("points_") else self.sizes.seeds

    def tracking(self, case: Case, variant: str) -> list[WorkUnit]:
        """Return the runs of a case by a variant, a unit each."""
        options = repr(case_options(case, variant))
        return [
            WorkUnit(
                name=f"tracking/{case.key}/{variant}/run_{run:04d}",
                work=track,
                task=TrackingTask(case, variant, options, self.sizes.seed, run),
                kind=f"{case.key}, {variant}",
                expected_s=case.frames * FRAME_S[variant] * max(1.0, case.points / 50.0),
            )
            for run in range(self.runs(case, variant))
        ]

    def bound(self, case: Case) -> WorkUnit:
        """Return the unit of a case's bound."""
        return WorkUnit(
            name=f"bound/{case.key}",
            work=bound,
            task=BoundTask(case, self.sizes.seed),
            kind="bound",
            expected_s=case.frames * BOUND_FRAME_S,
        )
