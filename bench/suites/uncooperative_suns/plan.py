"""What ``rvbench suite uncooperative-suns`` does, as units of work."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from bench.suites.uncooperative_suns.cases import SUN_SIGMA_DEG, SUNS, MotionTask
from bench.suites.uncooperative_suns.starts import frames_unit, starts_unit
from bench.suites.uncooperative_suns.targets import Targets
from bench.suites.units import WorkUnit
from models.reading.options import check_option

VARIANTS = ("paper", "best")
MOST_RUNS, MOST_SEED = 100_000, 2**32 - 1


@dataclass(frozen=True)
class Sizes:
    """How much of everything.

    Attributes
    ----------
    runs : int
        Starts of each target; rounded up to whole motions of four.
    paper_runs : int, optional
        Most of them by the paper's own algorithm.
    width : int, px
    samples : int
        Per pixel.
    seed : int
    """

    runs: int = 500
    paper_runs: int | None = None
    width: int = 1024
    samples: int = 32
    seed: int = 0

    def __post_init__(self) -> None:
        check_option("--runs", self.runs, 1, MOST_RUNS, whole=True)
        check_option("--paper-runs", self.paper_runs, 0, MOST_RUNS, whole=True)
        check_option("--width", self.width, 128, 4096, whole=True)
        check_option("--seed", self.seed, 0, MOST_SEED, whole=True)


QUICK = Sizes(runs=8, width=512, samples=8)


@dataclass(frozen=True)
class Plan:
    """A suite that is asked for.

    Attributes
    ----------
    sizes : Sizes
    targets : tuple of str
        Names, or files of one's own targets.
    out : Path
    """

    sizes: Sizes
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

    def motions(self, target: str) -> list[MotionTask]:
        """Return the motions of a target."""
        sizes, place, shape = self.sizes, self.chosen.place(target), self.chosen.shape(target)
        return [
            MotionTask(place, shape, number, sizes.seed, sizes.width, sizes.samples)
            for number in range(-(-sizes.runs // SUNS))
        ]

    def frames(self, target: str) -> list[WorkUnit]:
        """Return the units that render a target's motions."""
        return [frames_unit(task, self.name(target)) for task in self.motions(target)]

    def starts(self, target: str, variant: str) -> list[WorkUnit]:
        """Return the units that try a target's starts."""
        frames = self.frames(target)
        most = self.sizes.paper_runs if variant == "paper" else None
        chosen = frames if most is None else frames[: -(-most // SUNS)]
        return [
            starts_unit(unit, self.frames_file(unit), variant, SUN_SIGMA_DEG, self.name(target))
            for unit in chosen
        ]

    @property
    def units(self) -> list[WorkUnit]:
        """Every unit that tries starts."""
        return [
            unit
            for target in self.targets
            for variant in VARIANTS
            for unit in self.starts(target, variant)
        ]

    @property
    def every_frame(self) -> list[WorkUnit]:
        """Every unit that renders a motion."""
        return [unit for target in self.targets for unit in self.frames(target)]

    def frames_file(self, frames: WorkUnit) -> str:
        """Return where a motion's frames lie, without suffix."""
        return str(self.frames_folder / frames.name)

    @property
    def frames_folder(self) -> Path:
        """Where frames lie."""
        return self.out / "frames"
