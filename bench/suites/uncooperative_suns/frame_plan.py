"""What studies of an uncooperative target have in common: frames, then starts on them.

Frames are rendered once and lie beside the outcomes; starts read them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from rich.console import Console

from bench.suites.spread import do_units
from bench.suites.uncooperative_suns.targets import Targets
from bench.suites.units import WorkUnit
from models.reading.options import check_option

VARIANTS = ("paper", "best")
MOST_RUNS, MOST_SEED = 100_000, 2**32 - 1


@dataclass(frozen=True)
class FrameSizes:
    """How much of everything.

    Attributes
    ----------
    runs : int
        Of each target.
    paper_runs : int, optional
        Most of them by the paper's own algorithm.
    width : int, px
    samples : int
        Per pixel.
    seed : int
    """

    runs: int
    paper_runs: int | None = None
    width: int = 1024
    samples: int = 32
    seed: int = 0

    def __post_init__(self) -> None:
        check_option("--runs", self.runs, 1, MOST_RUNS, whole=True)
        check_option("--paper-runs", self.paper_runs, 0, MOST_RUNS, whole=True)
        check_option("--width", self.width, 128, 4096, whole=True)
        check_option("--seed", self.seed, 0, MOST_SEED, whole=True)


@dataclass(frozen=True)
class FramePlan(ABC):
    """A study that is asked for.

    Attributes
    ----------
    sizes : FrameSizes
    targets : tuple of str
        Names, or files of one's own targets.
    out : Path

    Raises
    ------
    ScenarioError
        If a target is none, or two have one name.
    """

    sizes: FrameSizes
    targets: tuple[str, ...]
    out: Path

    def __post_init__(self) -> None:
        self.chosen.check()

    @cached_property
    def chosen(self) -> Targets:
        """The targets, by name, place and shape."""
        return Targets(self.targets)

    def name(self, target: str) -> str:
        """Return how a target's files are named."""
        return self.chosen.name(target)

    @abstractmethod
    def frames(self, target: str) -> list[WorkUnit]:
        """Return the units that render what is tried of a target."""

    @abstractmethod
    def starts(self, target: str, variant: str) -> list[WorkUnit]:
        """Return the units that start a variant on a target's frames."""

    @property
    def units(self) -> list[WorkUnit]:
        """Every unit that starts on frames."""
        return [
            unit
            for target in self.targets
            for variant in VARIANTS
            for unit in self.starts(target, variant)
        ]

    @property
    def every_frame(self) -> list[WorkUnit]:
        """Every unit that renders."""
        return [unit for target in self.targets for unit in self.frames(target)]

    def frames_file(self, frames: WorkUnit) -> str:
        """Return where a unit's frames lie, without suffix."""
        return str(self.frames_folder / frames.name)

    @property
    def frames_folder(self) -> Path:
        """Where frames lie."""
        return self.out / "frames"

    @property
    def units_folder(self) -> Path:
        """Where lies what starts came to."""
        return self.out / "units"

    def render_for(self, units: Sequence[WorkUnit], workers: int, console: Console) -> None:
        """Render the frames that some units, which are not done, read.

        Parameters
        ----------
        units : sequence of WorkUnit
        workers : int
        console : Console
            For progress.

        Raises
        ------
        ScenarioError, VariantError, StorageError
            Each says what to do; nothing already done is lost.
        """
        read = {unit.reads for unit in units}
        own = [unit for unit in self.every_frame if self.frames_file(unit) in read]
        do_units(own, self.frames_folder, workers, console, self.every_frame)

    def do_all(self, workers: int, console: Console) -> None:
        """Do what is missing: all frames, then all starts on them; see ``render_for``."""
        do_units(self.every_frame, self.frames_folder, workers, console)
        do_units(self.units, self.units_folder, workers, console)
