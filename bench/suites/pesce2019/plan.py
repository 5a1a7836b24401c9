"""What `rvbench suite pesce2019` does: the paper's tables as units of work.

A run is named by what it is, not by the table that asks for it: Table 7's first row, Table 8's
first row and Table 6's first case are the same runs, done once.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.suites.pesce2019.acquisition_trial import AcquisitionTask, acquire
from bench.suites.pesce2019.cases import Case, case, published
from bench.suites.pesce2019.filter_bound import BoundTask, bound
from bench.suites.pesce2019.navigators import OURS, options_text
from bench.suites.pesce2019.start_errors import StartErrors
from bench.suites.pesce2019.synthetic_points import PointNoise
from bench.suites.pesce2019.tracking_run import TrackingTask, track
from bench.suites.units import WorkUnit
from models.errors import ScenarioError
from models.reading.options import check_option

PARTS = ("table5", "table6", "table7", "table8", "vinag")
VARIANTS = ("paper", "best")
CAMERA = "chaser_fixed"
ACQUIRED_CASES = ("1", "2", "3")
TRACKED_CASES = ("1", "2", "3", "4", "5")
SIGMAS_PX = (2.0, 3.0, 4.0, 5.0, 6.0)
OUTLIERS = (1, 2, 3, 4, 5)
TABLE_RUNS = 100  # of the acquisitions are Table 5's; the others tell the failure rate of best
MOST_RUNS, MOST_SEED = 100_000, 2**32 - 1
CHUNK = 20  # acquisitions of one unit
MOST_IMAGES = 100  # Algorithm 1 takes the next image for as long as it takes
RATE_HZ = 1.0
# Seconds on one core of 2025 that a piece takes before any was timed here.
ACQUISITION_S = {"paper": 10.0, "best": 0.4}
FRAME_S = {"paper": 0.015, "best": 0.01}
BOUND_FRAME_S = 0.002


@dataclass(frozen=True)
class Sizes:
    """How much of everything; the paper's sizes, and ours where it has one run or none.

    Attributes
    ----------
    runs : int
        Of each case of Table 6.
    acquisitions : int
        Of each case of Table 5 by best; of the paper variant, that takes long, no more than the
        table's own.
    seeds : int
        Runs of each cell of Tables 7 and 8 and of VINAG's case, where the paper has one.
    duration_s : float, s
    seed : int
    paper_runs : int, optional
        Most runs and acquisitions of a case by the paper variant, which takes far longer.
    """

    runs: int = 50
    acquisitions: int = 1000
    seeds: int = 10
    duration_s: float = 1800.0
    seed: int = 0
    paper_runs: int | None = None

    def __post_init__(self) -> None:
        for name in ("runs", "acquisitions", "seeds"):
            check_option(f"--{name}", getattr(self, name), 1, MOST_RUNS, whole=True)
        check_option("--paper-runs", self.paper_runs, 1, MOST_RUNS, whole=True)
        check_option("--seed", self.seed, 0, MOST_SEED, whole=True)
        if not 60.0 <= self.duration_s <= 1e5:
            raise ScenarioError(
                "expected --duration-s from 60 (the errors count from 50 s on) to 100000, "
                f"got {self.duration_s:g}"
            )

    def of_variant(self, variant: str, count: int) -> int:
        """Return how many of ``count`` runs a variant makes."""
        if variant != "paper" or self.paper_runs is None:
            return count
        return min(count, self.paper_runs)

    @property
    def frames(self) -> int:
        """Frames of a run."""
        return round(self.duration_s * RATE_HZ)


QUICK = Sizes(runs=4, acquisitions=10, seeds=2, duration_s=200.0)


@dataclass(frozen=True)
class Cell:
    """One setting under which runs are made.

    Attributes
    ----------
    case : Case
    noise : PointNoise
    runs : int
    """

    case: Case
    noise: PointNoise
    runs: int


@dataclass(frozen=True, eq=False)
class Plan:
    """The units of a suite, and which of them each table reads.

    Attributes
    ----------
    sizes : Sizes
    parts : tuple of str
    navigator : str
        Module of the pipeline.
    """

    sizes: Sizes
    parts: tuple[str, ...] = PARTS
    navigator: str = OURS

    def __post_init__(self) -> None:
        strange = [part for part in self.parts if part not in PARTS]
        if strange or not self.parts:
            raise ScenarioError(
                f"expected --parts among {', '.join(PARTS)}, got {', '.join(strange) or 'none'}"
            )

    def units(self) -> list[WorkUnit]:
        """Return every unit, each once."""
        found: dict[str, WorkUnit] = {}
        if "table5" in self.parts:
            for key in ACQUIRED_CASES:
                for variant in VARIANTS:
                    found |= _named(self.acquisitions(case(key), variant))
        for cell in self.cells():
            found |= _named([self.bound(cell)])
            for variant in VARIANTS:
                found |= _named(self.tracking(cell, variant))
        return list(found.values())

    def cells(self) -> list[Cell]:
        """Return the tracking cells of all parts asked for."""
        cells = {
            "table5": [],
            "table6": self.table6(),
            "table7": self.table7(),
            "table8": self.table8(),
            "vinag": [self.vinag()],
        }
        return [cell for part in self.parts for cell in cells[part]]

    def table6(self) -> list[Cell]:
        """Return the cells of Table 6: the five cases."""
        noise = tracking_noise()
        return [Cell(case(key), noise, self.sizes.runs) for key in TRACKED_CASES]

    def table7(self) -> list[Cell]:
        """Return the cells of Table 7: noise levels on case 1."""
        outliers = tracking_noise().outliers
        return [Cell(case("1"), PointNoise(s, outliers), self.sizes.seeds) for s in SIGMAS_PX]

    def table8(self) -> list[Cell]:
        """Return the cells of Table 8: numbers of outliers on case 1."""
        sigma_px = tracking_noise().sigma_px
        return [Cell(case("1"), PointNoise(sigma_px, n), self.sizes.seeds) for n in OUTLIERS]

    def vinag(self) -> Cell:
        """Return VINAG's relative case, with the noise of Table 6."""
        return Cell(case("vinag"), tracking_noise(), self.sizes.seeds)

    def acquisitions(self, own: Case, variant: str) -> list[WorkUnit]:
        """Return the units of one case of Table 5."""
        noise = published()["noise"]["acquisition"]
        count = self.sizes.acquisitions
        if variant == "paper":
            count = self.sizes.of_variant(variant, min(count, TABLE_RUNS))
        chunks = [
            tuple(range(first, min(first + CHUNK, count))) for first in range(0, count, CHUNK)
        ]
        return [
            WorkUnit(
                name=f"acquisition/case_{own.key}/{variant}/runs_{chunk[0]:05d}_{chunk[-1]:05d}",
                work=acquire,
                task=AcquisitionTask(
                    case=own,
                    camera=CAMERA,
                    navigator=self.navigator,
                    variant=variant,
                    options=options_text(self.navigator, variant),
                    noise=PointNoise(noise["sigma_pix"], noise["outliers"]),
                    seed=self.sizes.seed,
                    runs=chunk,
                    span_s=self.sizes.duration_s,
                    most_images=MOST_IMAGES,
                    rate_hz=RATE_HZ,
                ),
                kind=f"acquisition, {variant}",
                expected_s=len(chunk) * ACQUISITION_S[variant],
                modules=(self.navigator,),
            )
            for chunk in chunks
        ]

    def tracking(self, cell: Cell, variant: str) -> list[WorkUnit]:
        """Return the units of one tracking cell, a run each."""
        return [
            WorkUnit(
                name=f"tracking/{_folder(cell)}/{variant}/run_{run:04d}",
                work=track,
                task=TrackingTask(
                    case=cell.case,
                    camera=CAMERA,
                    navigator=self.navigator,
                    variant=variant,
                    options=options_text(self.navigator, variant),
                    noise=cell.noise,
                    start=start_errors(cell.case),
                    seed=self.sizes.seed,
                    run=run,
                    frames=self.sizes.frames,
                    rate_hz=RATE_HZ,
                ),
                kind=f"tracking, {variant}",
                expected_s=self.sizes.frames * FRAME_S[variant],
                modules=(self.navigator,),
            )
            for run in range(self.sizes.of_variant(variant, cell.runs))
        ]

    def bound(self, cell: Cell) -> WorkUnit:
        """Return the unit of a cell's bound; outliers do not change it."""
        return WorkUnit(
            name=f"bound/case_{cell.case.key}/sigma_{cell.noise.sigma_px:g}",
            work=bound,
            task=BoundTask(
                case=cell.case,
                camera=CAMERA,
                sigma_px=cell.noise.sigma_px,
                start=start_errors(cell.case),
                frames=self.sizes.frames,
                rate_hz=RATE_HZ,
            ),
            kind="bound",
            expected_s=self.sizes.frames * BOUND_FRAME_S,
        )


def tracking_noise() -> PointNoise:
    """Return the noise of Table 6."""
    noise = published()["noise"]["tracking"]
    return PointNoise(noise["sigma_pix"], noise["outliers"])


def start_errors(own: Case) -> StartErrors:
    """Return from what statistics a case's starts are drawn: the paper's Table 5.

    Cases 4 and 5 take case 1's, as the paper says; VINAG's takes case 2's, which turns as fast.
    """
    column = own.key if own.key in ACQUIRED_CASES else {"vinag": "2"}.get(own.key, "1")
    row = published()["acquisition"][f"case{column}"]
    return StartErrors(*map(float, np.ravel([row["e_rho_m"], row["e_R_deg"]])))


def _folder(cell: Cell) -> str:
    return f"case_{cell.case.key}/sigma_{cell.noise.sigma_px:g}_outliers_{cell.noise.outliers}"


def _named(units: list[WorkUnit]) -> Iterator[tuple[str, WorkUnit]]:
    return iter([(unit.name, unit) for unit in units])
