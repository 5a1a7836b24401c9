"""What ``rvbench suite uncooperative-tumbles`` does, as units of work."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from bench.suites.uncooperative_suns.targets import TARGETS, Targets
from bench.suites.uncooperative_tumbles.cases import IMAGES, TumbleTask
from bench.suites.uncooperative_tumbles.following import following_unit, frames_unit
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
        Tumbles of each target.
    paper_runs : int, optional
        Most of them by the paper's own algorithm.
    width : int, px
    samples : int
        Per pixel.
    images : int
        Of a tumble.
    seed : int
    """

    runs: int = 50
    paper_runs: int | None = None
    width: int = 1024
    samples: int = 32
    images: int = IMAGES
    seed: int = 0

    def __post_init__(self) -> None:
        check_option("--runs", self.runs, 1, MOST_RUNS, whole=True)
        check_option("--paper-runs", self.paper_runs, 0, MOST_RUNS, whole=True)
        check_option("--width", self.width, 128, 4096, whole=True)
        check_option("--seed", self.seed, 0, MOST_SEED, whole=True)


QUICK = Sizes(runs=2, width=512, samples=8, images=12)


@dataclass(frozen=True)
class Plan:
    """A suite that is asked for.

    Attributes
    ----------
    sizes : Sizes
    targets : tuple of str
        Names, or files of one's own targets.
    out : Path

    Raises
    ------
    ScenarioError
        If a target is none, or two have one name.
    """

    sizes: Sizes
    targets: tuple[str, ...] = TARGETS
    out: Path = Path("out")

    def __post_init__(self) -> None:
        self.chosen.check()

    @cached_property
    def chosen(self) -> Targets:
        """The targets, by name, place and shape."""
        return Targets(self.targets)

    def frames(self, target: str) -> list[WorkUnit]:
        """Return the units that render a target's tumbles."""
        sizes, place, shape = self.sizes, self.chosen.place(target), self.chosen.shape(target)
        tasks = [
            TumbleTask(place, shape, number, sizes.seed, sizes.width, sizes.samples, sizes.images)
            for number in range(sizes.runs)
        ]
        return [frames_unit(task, self.chosen.name(target)) for task in tasks]

    def tumbles(self, target: str, variant: str) -> list[WorkUnit]:
        """Return the units that follow a target's tumbles."""
        most = self.sizes.paper_runs if variant == "paper" else None
        return [
            following_unit(unit, self.frames_file(unit), variant, self.chosen.name(target))
            for unit in self.frames(target)[:most]
        ]

    @property
    def units(self) -> list[WorkUnit]:
        """Every unit that follows a tumble."""
        return [
            unit
            for target in self.targets
            for variant in VARIANTS
            for unit in self.tumbles(target, variant)
        ]

    @property
    def every_frame(self) -> list[WorkUnit]:
        """Every unit that renders a tumble."""
        return [unit for target in self.targets for unit in self.frames(target)]

    def frames_file(self, frames: WorkUnit) -> str:
        """Return where a tumble's frames lie, without suffix."""
        return str(self.frames_folder / frames.name)

    @property
    def frames_folder(self) -> Path:
        """Where frames lie."""
        return self.out / "frames"
