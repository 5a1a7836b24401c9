"""What ``rvbench suite uncooperative-suns`` does, as units of work."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from bench.suites.uncooperative_suns.cases import SUN_SIGMA_DEG, SUNS, MotionTask
from bench.suites.uncooperative_suns.frames import scenario_of
from bench.suites.uncooperative_suns.starts import frames_unit, starts_unit
from bench.suites.units import WorkUnit
from models.errors import ScenarioError
from models.reading.options import check_option
from models.spacecraft.wireframes import WIREFRAMES
from renders.scenario.own_target import MESHES, SUFFIX, wireframe_of

TARGETS = ("xmm", "hispasat", "maxar1300_unmarked")
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
        names = [self.name(target) for target in self.targets]
        for target, name in zip(self.targets, names, strict=True):
            if names.count(name) > 1:
                raise ScenarioError(f"expected targets of different names, got {name} twice")
            if target.lower().endswith(MESHES):
                raise ScenarioError(
                    f"expected --parts as targets, of your own the .toml beside its mesh, got "
                    f"{target!r}; `rvbench inspect {target}` writes one"
                )
            if not target.lower().endswith(SUFFIX) and target not in WIREFRAMES:
                raise ScenarioError(
                    f"expected --parts as targets with a wireframe, {', '.join(TARGETS)} or the "
                    f".toml of your own, got {target!r}"
                )

    @staticmethod
    def name(target: str) -> str:
        """Return how a target's files are named."""
        return Path(target).stem if target.lower().endswith(SUFFIX) else target

    def motions(self, target: str) -> list[MotionTask]:
        """Return the motions of a target."""
        sizes, shape = self.sizes, self._shapes[target]
        return [
            MotionTask(self._places[target], shape, number, sizes.seed, sizes.width, sizes.samples)
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

    @cached_property
    def _places(self) -> dict[str, str]:
        return {
            target: str(Path(target).resolve()) if target.lower().endswith(SUFFIX) else target
            for target in self.targets
        }

    @cached_property
    def _shapes(self) -> dict[str, str]:
        """By target: the hash of all that makes one's own; empty for ours."""
        return {
            target: _shape(self._places[target]) if target.lower().endswith(SUFFIX) else ""
            for target in self.targets
        }


def _shape(place: str) -> str:
    scenario = scenario_of(MotionTask(place, "", 0, 0, 1024, 1))
    wireframe_of(scenario)  # before anything is rendered
    own = scenario.own_target
    if own is None:
        return ""
    return hashlib.sha256("\n".join([own.files_sha256, *own.lines]).encode()).hexdigest()
