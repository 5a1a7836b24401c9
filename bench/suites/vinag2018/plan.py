"""What `rvbench suite vinag2018` does: flights, bounds and counts as units of work."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace
from functools import cache

from bench.suites.pesce2019.cases import case as relative_case
from bench.suites.pesce2019.plan import start_errors, tracking_noise
from bench.suites.units import WorkUnit
from bench.suites.vinag2018.availability import AvailabilityTask, availability
from bench.suites.vinag2018.cases import CASES, GAINS_DBI, GEO, LEO, Case
from bench.suites.vinag2018.chain_run import CASE as CHAIN_CASE
from bench.suites.vinag2018.chain_run import CHASERS, NAVIGATED, TRUE, ChainTask, follow
from bench.suites.vinag2018.navigation_bound import BoundTask, bound
from bench.suites.vinag2018.navigation_run import NavigationTask, navigate
from bench.suites.vinag2018.star_plan import PIXELS, star_options_text, survey_units
from bench.suites.vinag2018.star_survey import SKIES
from models.errors import ScenarioError
from models.gnss import transmit_pattern
from models.gravity import field as gravity_field
from models.motion.clohessy_wiltshire import mean_motion
from models.reading.options import check_option
from pipelines.absolute.options import VARIANTS, absolute_options_for
from pipelines.integrated.options import relative_options_for
from renders.flight.faults import Faults

PARTS = (
    "leo", "geo", "model", "lasting", "mask", "faults", "sampling", "availability", "stars",
    "chain", "dataset",
)  # fmt: skip
DATASET_S = 600.0  # of the flight that is written as a dataset
CHUNK = 25  # runs of one unit, one batch: of 10 a run takes half as long again, of 50 two thirds
MOST_RUNS, MOST_SEED = 100_000, 2**32 - 1
FULL_TURN_RAD = 6.283185307179586
SAMPLED_S, SAMPLED_CASE = 600.0, LEO
LIAR = 4  # in sight of the LEO case all the while that it lies; a test holds it
FAULT_S = 1000.0  # of a flight with a fault, whatever the others last
FAULTS = {
    "a satellite lies by 150 m": Faults(liar=LIAR, lie_m=150.0, lie_start_s=200.0, lie_end_s=500.0),
    "no GNSS for ten minutes": Faults(gap_start_s=200.0, gap_end_s=800.0),
    "a star frame of another field": Faults(swapped_s=200.0, swapped_frames=1, swapped_deg=30.0),
}
# Seconds on one core of 2025 that a frame takes before any was timed here: of a run, of a frame.
FRAME_S, FRAME_OF_RUN_S, LASTING_TIMES, BOUND_S = 0.8e-3, 1.0e-4, 8.0, 2.5e-4
STAR_FRAME_S = 0.4
CHAIN_FRAME_S = {NAVIGATED: 0.05, TRUE: 0.03}


@dataclass(frozen=True)
class Sizes:
    """How much of everything.

    Attributes
    ----------
    runs : int
        Of Figures 5 to 8.
    seeds : int
        Of all other flights.
    duration_s : float or None, s
        None for one orbit.
    geo_share : float
        Of that orbit, in GEO, where it is a day.
    star_rate_hz : int, Hz
        Of the star sensor; the paper's is 5.
    acquisitions : int
        Attitudes that a star camera finds without a prior, under each sky.
    star_flights : int
        Runs whose star sensor is a camera, its frames rendered one by one.
    star_flight_s : float, s
        How long they last.
    chain_s : float, s
        How long a target is followed by a chaser that navigates for itself.
    seed : int
    """

    runs: int = 50
    seeds: int = 10
    duration_s: float | None = None
    geo_share: float = 1.0
    star_rate_hz: int = 5
    acquisitions: int = 1000
    star_flights: int = 2
    star_flight_s: float = 600.0
    chain_s: float = 1200.0
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("runs", "seeds", "acquisitions"):
            check_option(f"--{name}", getattr(self, name), 1, MOST_RUNS, whole=True)
        check_option("--seed", self.seed, 0, MOST_SEED, whole=True)
        if self.duration_s is not None and not 60.0 <= self.duration_s <= 1e6:
            raise ScenarioError(
                f"expected --duration-s from 60 to 1000000, got {self.duration_s}: the first "
                "tenth of a flight is left out of its tables"
            )

    def span_s(self, case: Case) -> float:
        """Return how long a case is flown, whole seconds."""
        if self.duration_s is not None:
            return self.duration_s
        share = self.geo_share if case.key == GEO.key else 1.0
        return float(round(share * FULL_TURN_RAD / mean_motion(1e3 * case.axis_km)))


QUICK = Sizes(
    runs=4,
    seeds=2,
    geo_share=0.25,
    star_rate_hz=1,
    acquisitions=100,
    star_flights=1,
    star_flight_s=120.0,
    chain_s=300.0,
)


@dataclass(frozen=True)
class Cell:
    """One setting under which flights are made.

    Attributes
    ----------
    case : Case
    variant : str
    runs : int
    span_s : float, s
    modelled, lasting, mask, each_sample : bool
        See ``NavigationTask``.
    star_rate_hz : int, Hz
    fault : str
        Among ``FAULTS``; empty for none.
    star_pixels : int
        Of a star camera in place of the data sheet's sensor; 0 for none.
    """

    case: Case
    variant: str
    runs: int
    span_s: float
    modelled: bool = False
    lasting: bool = False
    mask: bool = True
    each_sample: bool = False
    star_rate_hz: int = 5
    fault: str = ""
    star_pixels: int = 0

    @property
    def folder(self) -> str:
        """Where its outcomes are kept."""
        marks = [name for name in ("modelled", "lasting", "each_sample") if getattr(self, name)]
        marks += [] if self.mask else ["unmasked"]
        if self.star_pixels:
            marks.append(f"star_images_{self.star_pixels}")
        if self.fault:
            marks.append(f"fault_{list(FAULTS).index(self.fault)}")
        return "_".join([self.case.key, *marks, f"{self.span_s:.0f}s", f"{self.star_rate_hz}hz"])


@dataclass(frozen=True)
class Plan:
    """What is to be done.

    Attributes
    ----------
    sizes : Sizes
    parts : tuple of str

    Raises
    ------
    ScenarioError
        If a part is none.
    """

    sizes: Sizes = field(default_factory=Sizes)
    parts: tuple[str, ...] = PARTS

    def __post_init__(self) -> None:
        for part in self.parts:
            if part not in PARTS:
                raise ScenarioError(f"expected --parts among {', '.join(PARTS)}, got {part!r}")

    def cell(self, case: Case, variant: str, runs: int) -> Cell:
        """Return a cell of this plan's sizes.

        Parameters
        ----------
        case : Case
        variant : str
        runs : int
        """
        rate_hz = self.sizes.star_rate_hz
        return Cell(case, variant, runs, self.sizes.span_s(case), star_rate_hz=rate_hz)

    def flights(self, part: str) -> list[Cell]:
        """Return the cells of a part, ``paper`` and ``best`` of each case in turn."""
        seeds = self.sizes.seeds
        if part in CASES:
            return [self.cell(CASES[part], variant, self.sizes.runs) for variant in VARIANTS]
        cases = [(case, variant) for case in CASES.values() for variant in VARIANTS]
        if part == "model":
            return [replace(self.cell(*each, seeds), modelled=True) for each in cases]
        if part == "lasting":
            return [replace(self.cell(*each, seeds), lasting=True) for each in cases]
        if part == "mask":
            return [replace(self.cell(GEO, each, seeds), mask=False) for each in VARIANTS]
        if part == "faults":
            own = replace(self.cell(LEO, "best", seeds), span_s=FAULT_S)
            return [replace(own, fault=name) for name in FAULTS]
        if part == "sampling":
            span_s = min(SAMPLED_S, self.sizes.span_s(SAMPLED_CASE))
            one = replace(self.cell(SAMPLED_CASE, "best", 1), span_s=span_s, star_rate_hz=5)
            return [one, replace(one, each_sample=True)]
        if part == "stars":
            span_s = min(self.sizes.star_flight_s, self.sizes.span_s(LEO))
            one = replace(self.cell(LEO, "best", self.sizes.star_flights), span_s=span_s)
            return [one, replace(one, star_pixels=PIXELS)]
        return []

    def units(self) -> list[WorkUnit]:
        """Return all units, each once."""
        found: dict[str, WorkUnit] = {}
        for part in self.parts:
            for cell in self.flights(part):
                for unit in self.flown(cell):
                    found.setdefault(unit.name, unit)
                if part in (*CASES, "model", "lasting"):
                    found.setdefault(self.bound(cell).name, self.bound(cell))
        if "availability" in self.parts:
            for own in self.counted():
                found.setdefault(self.count(own).name, self.count(own))
        if "stars" in self.parts:
            for sky in SKIES:
                found.update({unit.name: unit for unit in self.surveyed(sky)})
        if "chain" in self.parts:
            for variant in VARIANTS:
                for chaser in CHASERS:
                    found.update({each.name: each for each in self.chained(variant, chaser)})
        return list(found.values())

    def chained(self, variant: str, chaser: str) -> list[WorkUnit]:
        """Return the units of a variant's runs with one kind of chaser, one each."""
        span_s = min(self.sizes.chain_s, self.sizes.span_s(LEO))
        own = options_text(variant, LEO.regime, False)
        options = f"{own} {relative_options_for(variant, LEO.regime)!r}"
        return [
            WorkUnit(
                name=f"chain/{span_s:.0f}s/{chaser}/{variant}/run_{run:04d}",
                work=follow,
                task=ChainTask(
                    scenario=CHAIN_CASE.read_text(),
                    chaser=chaser,
                    variant=variant,
                    options=options,
                    noise=tracking_noise(),
                    start=start_errors(relative_case("vinag")),
                    seed=self.sizes.seed,
                    run=run,
                    span_s=span_s,
                ),
                kind=f"chain, {variant}, chaser {chaser}",
                expected_s=span_s * CHAIN_FRAME_S[chaser],
            )
            for run in range(self.sizes.seeds)
        ]

    def surveyed(self, sky: str) -> list[WorkUnit]:
        """Return the units of the attitudes under a sky."""
        return survey_units(sky, self.sizes.acquisitions, self.sizes.seed)

    def flown(self, cell: Cell) -> list[WorkUnit]:
        """Return the units of a cell's runs."""
        faults = FAULTS.get(cell.fault, Faults())
        frames = cell.span_s * (100.0 if cell.each_sample else cell.star_rate_hz)
        times = LASTING_TIMES if cell.lasting and cell.variant == "best" else 1.0
        chunk = 1 if cell.star_pixels else CHUNK
        units = []
        for first in range(0, cell.runs, chunk):
            runs = tuple(range(first, min(first + chunk, cell.runs)))
            units.append(
                WorkUnit(
                    name=f"flights/{cell.folder}/{cell.variant}/runs_{runs[0]:04d}_{runs[-1]:04d}",
                    work=navigate,
                    task=NavigationTask(
                        case=cell.case,
                        variant=cell.variant,
                        options=options_text(cell.variant, cell.case.regime, cell.lasting)
                        + (star_options_text() if cell.star_pixels else ""),
                        duration_s=cell.span_s,
                        seed=self.sizes.seed,
                        runs=runs,
                        modelled=cell.modelled,
                        correlated=cell.lasting,
                        mask=cell.mask,
                        each_sample=cell.each_sample,
                        star_rate_hz=cell.star_rate_hz,
                        faults=faults,
                        star_pixels=cell.star_pixels,
                    ),
                    kind="flight, star images"
                    if cell.star_pixels
                    else f"flight, {cell.variant}{', lasting errors' if cell.lasting else ''}",
                    expected_s=frames * STAR_FRAME_S
                    if cell.star_pixels
                    else frames * times * (FRAME_S + FRAME_OF_RUN_S * len(runs)),
                )
            )
        return units

    def bound(self, cell: Cell) -> WorkUnit:
        """Return the unit of a cell's bound."""
        lasting = "_lasting" if cell.lasting else ""
        return WorkUnit(
            name=f"bounds/{cell.case.key}{lasting}_{cell.span_s:.0f}s_{cell.star_rate_hz}hz/{cell.variant}",
            work=bound,
            task=BoundTask(
                cell.case,
                cell.variant,
                options_text(cell.variant, cell.case.regime, False),
                cell.span_s,
                cell.lasting,
                cell.star_rate_hz,
            ),
            kind=f"bound{', lasting errors' if cell.lasting else ''}",
            expected_s=cell.span_s * BOUND_S * (10.0 if cell.lasting else 1.0),
        )

    def counted(self) -> list[Case]:
        """Return the cases whose satellites are counted: as flown, then GEO by gain and pattern."""
        gains = [
            replace(GEO, gain_dbi=gain, azimuth_averaged=averaged)
            for averaged in (True, False)
            for gain in GAINS_DBI
        ]
        return [LEO, GEO, *(case for case in gains if case != GEO)]

    def count(self, case: Case) -> WorkUnit:
        """Return the unit of a case's satellites, over a whole orbit whatever is flown."""
        whole = Sizes().span_s(case)
        pattern = "mean" if case.azimuth_averaged else "azimuth"
        options = absolute_options_for("paper", case.regime)
        return WorkUnit(
            name=f"availability/{case.key}_{case.gain_dbi:g}_dbi_{pattern}",
            work=availability,
            task=AvailabilityTask(case, options.mask_height_m, whole, tables_hash()),
            kind="availability",
            expected_s=5.0,
        )


def options_text(variant: str, regime: str, lasting: bool) -> str:
    """Return all that shapes a filter and its truth beside code: settings, and hashes of tables.

    Parameters
    ----------
    variant, regime : str
    lasting : bool
    """
    return f"{absolute_options_for(variant, regime, lasting)!r} {tables_hash()}"


@cache
def tables_hash() -> str:
    """Return a hash of the tables of gravity and of the transmit pattern."""
    tables = (gravity_field.TABLE, transmit_pattern.TABLE)
    return hashlib.sha256(b"".join(path.read_bytes() for path in tables)).hexdigest()[:16]
