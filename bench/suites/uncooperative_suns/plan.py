"""What ``rvbench suite uncooperative-suns`` does, as units of work."""

from __future__ import annotations

from dataclasses import dataclass

from bench.suites.uncooperative_suns.cases import SUN_SIGMA_DEG, SUNS, MotionTask
from bench.suites.uncooperative_suns.frame_plan import FramePlan, FrameSizes
from bench.suites.uncooperative_suns.starts import frames_unit, starts_unit
from bench.suites.units import WorkUnit
from models.errors import ScenarioError

MOST_BRACKETED = 16.0  # twelve bits become sixteen


@dataclass(frozen=True)
class Sizes(FrameSizes):
    """How much of everything; runs are starts, rounded up to whole motions of four.

    Attributes
    ----------
    bracket : tuple of float
        Further exposures of each image, as multiples of the metered one.
    """

    runs: int = 500
    bracket: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        every = (1.0, *self.bracket)
        if not (min(every) > 0.0 and max(every) <= MOST_BRACKETED * min(every)):
            raise ScenarioError(
                "expected --bracket as multiples of the metered exposure, above 0 and with it "
                f"within a ratio of {MOST_BRACKETED:g}, got {list(self.bracket)}"
            )


QUICK = Sizes(runs=8, width=512, samples=8)


@dataclass(frozen=True)
class Plan(FramePlan):
    """A suite that is asked for.

    Attributes
    ----------
    sizes : Sizes
    targets, out : as for ``FramePlan``
    """

    sizes: Sizes

    def motions(self, target: str) -> list[MotionTask]:
        """Return the motions of a target."""
        sizes, place, shape = self.sizes, self.chosen.place(target), self.chosen.shape(target)
        return [
            MotionTask(
                place, shape, number, sizes.seed, sizes.width, sizes.samples, bracket=sizes.bracket
            )
            for number in range(-(-sizes.runs // SUNS))
        ]

    def frames(self, target: str) -> list[WorkUnit]:
        """Return the units that render a target's motions."""
        return [frames_unit(task, self.name(target)) for task in self.motions(target)]

    def starts(self, target: str, variant: str) -> list[WorkUnit]:
        """Return the units that try a target's starts by a variant."""
        frames = self.frames(target)
        most = self.sizes.paper_runs if variant == "paper" else None
        chosen = frames if most is None else frames[: -(-most // SUNS)]
        return [
            starts_unit(unit, self.frames_file(unit), variant, SUN_SIGMA_DEG, self.name(target))
            for unit in chosen
        ]
