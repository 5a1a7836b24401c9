"""What ``rvbench suite opromolla2022`` does: frames to be rendered, and runs over them as units."""

from __future__ import annotations

from collections.abc import Sequence as Many
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from bench.suites.opromolla2022.cases import (
    APPROACH,
    BY_NAME,
    CHASER,
    FLIGHTS,
    GRASP_LAMP,
    GRASP_SUN,
    SEQUENCES,
    STUDIED,
    Flight,
    Sequence,
    studies,
)
from bench.suites.opromolla2022.flight_run import FlightTask, fly
from bench.suites.opromolla2022.frame_making import (
    FlightFrames,
    FlightSizes,
    flight_folder,
    flight_hash,
    scenario_of,
)
from bench.suites.units import WorkUnit
from models.errors import ScenarioError
from models.reading.options import check_option
from pipelines.registry import registered_pipeline
from renders.scenario.error_sets import ALONE, ERROR_SETS
from renders.scenario.scenario import Scenario

PARTS = ("chaser", "hand", "sun-map", "sensitivity")
VARIANTS = ("paper", "best")
MOST_RUNS, MOST_SEED = 100_000, 2**32 - 1
RUNS_IN_A_UNIT = 5
# Of one core of 2025, before any was timed here: a frame by both variants, by columns of its image.
FRAME_S = {CHASER: 0.12, "eye_in_hand": 0.2}
RENDER_S_PER_GROUP = 1.2e-6  # s of one core a pixel, light group and exposure
BYTES_PER_PIXEL = 1.3  # of an image in its file, at most: 1.2 at 256 columns, 0.6 to 1.0 at 2048
GB = 1e9


@dataclass(frozen=True)
class Sizes:
    """How much of everything.

    Attributes
    ----------
    runs : int
        Of each sequence that the paper flies a hundred times, and under all errors together.
    seeds : int
        Runs under each error by itself.
    rates_hz : tuple of (str, float)
        Frames a second, by flight.
    width : int, px
    seed : int
    """

    runs: int = 100
    seeds: int = 20
    rates_hz: tuple[tuple[str, float], ...] = tuple((own.key, 1.0) for own in FLIGHTS)
    width: int = 2048
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("runs", "seeds"):
            value = getattr(self, name)
            check_option(f"--{name}", value, 1, MOST_RUNS, whole=True)
        check_option("--seed", self.seed, 0, MOST_SEED, whole=True)

    def at(self, rate_hz: float | None) -> Sizes:
        """Return them with one rate for all flights."""
        if rate_hz is None:
            return self
        return replace(self, rates_hz=tuple((own.key, rate_hz) for own in FLIGHTS))

    def of(self, flight: Flight) -> FlightSizes:
        """Return how much of a flight is rendered."""
        return FlightSizes(dict(self.rates_hz)[flight.key], self.width)


QUICK = Sizes(
    runs=5,
    seeds=3,
    rates_hz=((APPROACH.key, 0.025), (GRASP_LAMP.key, 0.15), (GRASP_SUN.key, 0.05)),
    width=1024,
)


@dataclass(frozen=True, eq=False)
class Plan:
    """The frames and units of a suite.

    Attributes
    ----------
    sizes : Sizes
    out : Path
        The suite's folder.
    parts : tuple of str
        Of ``PARTS``, or names of sequences.
    """

    sizes: Sizes
    out: Path
    parts: tuple[str, ...] = PARTS
    _scenarios: dict[str, Scenario] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        strange = [part for part in self.parts if part not in PARTS and part not in BY_NAME]
        if strange or not self.parts:
            raise ScenarioError(
                f"expected --parts among {', '.join(PARTS)} or sequences such as S2, M1 or E-SB, "
                f"got {', '.join(strange) or 'none'}"
            )

    @cached_property
    def sequences(self) -> list[Sequence]:
        """The paper's test cases that are flown, in its order."""
        return [own for own in SEQUENCES if own.name in self.parts or _part(own) in self.parts]

    @cached_property
    def studied(self) -> list[str]:
        """Names of the sequences that are flown under each error."""
        if "sensitivity" not in self.parts:
            return []
        named = [own.name for own in self.sequences if own.name in STUDIED]
        return named or list(STUDIED)

    def runs(self, own: Sequence) -> int:
        """Return how many runs a sequence has."""
        if own.once:
            return 1
        return self.sizes.seeds if _is_alone(own) else self.sizes.runs

    def scenario(self, flight: Flight) -> Scenario:
        """Return a flight's scenario."""
        if flight.key not in self._scenarios:
            self._scenarios[flight.key] = scenario_of(flight, self.sizes.of(flight))
        return self._scenarios[flight.key]

    @cached_property
    def flights(self) -> list[FlightFrames]:
        """The frames to be rendered, flight by flight, with the Suns that are wanted."""
        wanted: dict[str, list[str]] = {}
        for own in [*self.sequences, *(BY_NAME[name] for name in self.studied)]:
            wanted.setdefault(own.flight.key, []).append(own.sun)
        return [
            FlightFrames(self.folder(flight), flight, self.scenario(flight), wanted[flight.key])
            for flight in FLIGHTS
            if flight.key in wanted
        ]

    def folder(self, flight: Flight) -> Path:
        """Return where a flight's frames lie."""
        return flight_folder(self.out / "frames", flight, self.scenario(flight))

    @cached_property
    def units(self) -> list[WorkUnit]:
        """Every unit, each once."""
        found: dict[str, WorkUnit] = {}
        for group in self._groups():
            for unit in self._of_group(group):
                found.setdefault(unit.name, unit)
        return list(found.values())

    def units_of(self, own: Sequence) -> list[WorkUnit]:
        """Return the units in which a sequence's runs are, in their order."""
        group = next(each for each in self._groups() if own in each)
        return self._of_group(group)

    def _groups(self) -> list[list[Sequence]]:
        """Return sequences that share frames and noise, and so a unit."""
        together: dict[tuple[str, str], list[Sequence]] = {}
        for own in self.sequences:
            together.setdefault((own.flight.key, own.sun), []).append(own)
        studied = []
        for name in self.studied:
            for alone in (True, False):
                studied.append([own for own in studies(name) if _is_alone(own) == alone])
        return [*together.values(), *studied]

    def _of_group(self, group: Many[Sequence]) -> list[WorkUnit]:
        first = group[0]
        flight, errors = first.flight, tuple(dict.fromkeys(own.errors for own in group))
        sizes = self.sizes.of(flight)
        registered = registered_pipeline(flight.pipeline)
        assert registered.settings is not None
        options = " ".join(registered.settings(variant) for variant in VARIANTS)
        frames = len(self.scenario(flight).times_s)
        flown = "each_error" if _is_alone(first) else "-".join(errors)
        units = []
        total = self.runs(first)
        for number in range(0, total, RUNS_IN_A_UNIT):
            runs = min(RUNS_IN_A_UNIT, total - number)
            units.append(
                WorkUnit(
                    name=f"{flight.key}/{first.sun}/{flown}/{number:04d}_{runs}",
                    work=fly,
                    task=FlightTask(
                        flight.key,
                        first.sun,
                        flight_hash(flight, self.scenario(flight)),
                        sizes,
                        errors,
                        " ".join(repr(ERROR_SETS[name]) for name in errors),
                        options,
                        VARIANTS,
                        number,
                        runs,
                        self.sizes.seed,
                    ),
                    kind=flight.key,
                    expected_s=frames * runs * len(errors) * FRAME_S[flight.pipeline],
                    modules=(f"pipelines.{flight.pipeline}.registered",),
                    reads=str(self.folder(flight)),
                )
            )
        return units

    def price(self, flights: Many[FlightFrames]) -> Price:
        """Return what rendering some flights takes, as thought before any of it was done.

        Parameters
        ----------
        flights : sequence of FlightFrames
            Those of which something is still to be flown.
        """
        frames, render_s, size = 0, 0.0, 0.0
        for flight in flights:
            camera = flight.scenario.simulated_camera
            pixels = camera.width * camera.height
            bands = 2 if flight.scenario.frame_kind == "pairs" else 1
            colours = 1 if bands == 2 else 3
            left = [(index, len(flight.missing(index))) for index in flight.left]
            frames += sum(suns for _, suns in left)
            groups = sum(bands * colours * (suns + 1) for _, suns in left)
            render_s += RENDER_S_PER_GROUP * groups * pixels
            size += sum(bands * suns for _, suns in left) * pixels * BYTES_PER_PIXEL
        return Price(frames, render_s, size / GB)


@dataclass(frozen=True)
class Price:
    """What rendering will take.

    Attributes
    ----------
    frames : int
    render_s : float, s
        Of one core.
    size_gb : float
        Of the frames' files, at most.
    """

    frames: int
    render_s: float
    size_gb: float


def _is_alone(own: Sequence) -> bool:
    """Tell whether a sequence is flown under one error by itself, or none."""
    return "/" in own.name and own.errors in ALONE


def _part(own: Sequence) -> str:
    if own.once:
        return "sun-map"
    return "chaser" if own.flight.pipeline == CHASER else "hand"
