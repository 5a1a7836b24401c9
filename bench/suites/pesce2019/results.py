"""What a suite came to, part by part, from the outcomes of its units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.suites.pesce2019.cases import Case, case, published, tumble_of
from bench.suites.pesce2019.filter_bound import pose_information
from bench.suites.pesce2019.plan import (
    ACQUIRED_CASES,
    CAMERA,
    RATE_HZ,
    TABLE_RUNS,
    VARIANTS,
    Cell,
    Plan,
)
from bench.suites.pesce2019.summaries import (
    AcquisitionSummary,
    BoundSummary,
    TrackingSummary,
    acquisition_summary,
    bound_summary,
    settled,
    steady,
    tracking_summary,
)
from bench.suites.units import Outcome, WorkUnit, done_outcome
from models.camera import camera_preset
from models.spacecraft.wireframes import wireframe_by_name

BOUND_MOMENTS = 60


@dataclass(frozen=True)
class AcquiredCase:
    """One case of Table 5.

    Attributes
    ----------
    case : Case
    table : dict
        By variant: the first 100 runs, as the paper's table.
    whole : dict
        By variant: all runs.
    seconds : dict
        By variant: mean, standard deviation and largest time of a run, s. Never the same twice.
    single_bound : dict
        Root mean square over the tumble of the bound of one image, m and deg, by unit.
    """

    case: Case
    table: dict[str, AcquisitionSummary]
    whole: dict[str, AcquisitionSummary]
    seconds: dict[str, tuple[float, float, float]]
    single_bound: dict[str, float]


@dataclass(frozen=True)
class TrackedCell:
    """One tracking cell, in both windows.

    Attributes
    ----------
    cell : Cell
    steady, settled : dict
        By variant: the last 1000 s, and from 50 s on.
    bound_steady, bound_settled : BoundSummary
    frame_ms : dict
        By variant: median time of a frame, ms. Never the same twice.
    """

    cell: Cell
    steady: dict[str, TrackingSummary]
    settled: dict[str, TrackingSummary]
    bound_steady: BoundSummary
    bound_settled: BoundSummary
    frame_ms: dict[str, float]


@dataclass(frozen=True)
class Results:
    """Everything the report says; parts that were not asked for are empty."""

    table5: tuple[AcquiredCase, ...]
    table6: tuple[TrackedCell, ...]
    table7: tuple[TrackedCell, ...]
    table8: tuple[TrackedCell, ...]
    vinag: TrackedCell | None


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

    def tracking(self, cell: Cell, variant: str) -> list[Outcome]:
        """Return the runs of a cell by a variant."""
        return self._all(self.plan.tracking(cell, variant))

    def bound(self, cell: Cell) -> Outcome:
        """Return a cell's bound."""
        return done_outcome(self.folder, self.plan.bound(cell))

    def acquisitions(self, own: Case, variant: str) -> list[Outcome]:
        """Return a case's acquisitions by a variant."""
        return self._all(self.plan.acquisitions(own, variant))

    def results(self) -> Results:
        """Summarise all parts of the plan.

        Raises
        ------
        DatasetError
            If a unit is not done.
        """
        parts = self.plan.parts
        return Results(
            table5=tuple(map(self._acquired, ACQUIRED_CASES)) if "table5" in parts else (),
            table6=tuple(map(self._tracked, self.plan.table6())) if "table6" in parts else (),
            table7=tuple(map(self._tracked, self.plan.table7())) if "table7" in parts else (),
            table8=tuple(map(self._tracked, self.plan.table8())) if "table8" in parts else (),
            vinag=self._tracked(self.plan.vinag()) if "vinag" in parts else None,
        )

    def _all(self, units: Sequence[WorkUnit]) -> list[Outcome]:
        return [done_outcome(self.folder, unit) for unit in units]

    def _acquired(self, key: str) -> AcquiredCase:
        own = case(key)
        outcomes = {variant: self.acquisitions(own, variant) for variant in VARIANTS}
        seconds = {
            variant: np.concatenate([each.seconds for each in found])
            for variant, found in outcomes.items()
        }
        return AcquiredCase(
            case=own,
            table={v: acquisition_summary(found, TABLE_RUNS) for v, found in outcomes.items()},
            whole={v: acquisition_summary(found) for v, found in outcomes.items()},
            seconds={
                v: (float(each.mean()), float(each.std()), float(each.max()))
                for v, each in seconds.items()
            },
            single_bound=self._single_bound(own),
        )

    def _single_bound(self, own: Case) -> dict[str, float]:
        """Return the bound of one image with the noise of Table 5, over moments of the tumble."""
        sigma_px = published()["noise"]["acquisition"]["sigma_pix"]
        span_s = self.plan.sizes.duration_s
        tumble = tumble_of(own, span_s)
        target, camera = wireframe_by_name(own.target), camera_preset(CAMERA)
        bounds = [
            np.linalg.inv(pose_information(tumble, target, camera, sigma_px, time_s))
            for time_s in np.linspace(0.0, span_s, BOUND_MOMENTS)
        ]
        squares = np.array([[np.trace(b[:3, :3]), np.trace(b[3:, 3:])] for b in bounds])
        position_m, turn_rad = np.sqrt(squares.mean(axis=0)).tolist()
        return {"m": position_m, "deg": float(np.rad2deg(turn_rad))}

    def _tracked(self, cell: Cell) -> TrackedCell:
        bound = self.bound(cell)
        frames = self.plan.sizes.frames
        end, rest = steady(frames), settled(frames, RATE_HZ)
        runs = {variant: self.tracking(cell, variant) for variant in VARIANTS}
        return TrackedCell(
            cell=cell,
            steady={v: tracking_summary(found, end) for v, found in runs.items()},
            settled={v: tracking_summary(found, rest) for v, found in runs.items()},
            bound_steady=bound_summary(bound, end),
            bound_settled=bound_summary(bound, rest),
            frame_ms={
                v: 1e3 * float(np.median(np.concatenate([each.seconds for each in found])))
                for v, found in runs.items()
            },
        )
