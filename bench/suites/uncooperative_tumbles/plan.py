"""What ``rvbench suite uncooperative-tumbles`` does, as units of work."""

from __future__ import annotations

from dataclasses import dataclass

from bench.suites.uncooperative_suns.cases import MotionTask
from bench.suites.uncooperative_suns.frame_plan import FramePlan, FrameSizes
from bench.suites.uncooperative_tumbles.cases import IMAGES
from bench.suites.uncooperative_tumbles.following import following_unit, frames_unit
from bench.suites.units import WorkUnit


@dataclass(frozen=True)
class Sizes(FrameSizes):
    """How much of everything; runs are tumbles of each target.

    Attributes
    ----------
    images : int
        Of a tumble.
    """

    runs: int = 50
    images: int = IMAGES


QUICK = Sizes(runs=2, width=512, samples=8, images=12)


@dataclass(frozen=True)
class Plan(FramePlan):
    """A suite that is asked for.

    Attributes
    ----------
    sizes : Sizes
    targets, out : as for ``FramePlan``
    """

    sizes: Sizes

    def frames(self, target: str) -> list[WorkUnit]:
        """Return the units that render a target's tumbles."""
        one, place, shape = self.sizes, self.chosen.place(target), self.chosen.shape(target)
        tasks = [
            MotionTask(place, shape, number, one.seed, one.width, one.samples, one.images)
            for number in range(one.runs)
        ]
        return [frames_unit(task, self.name(target)) for task in tasks]

    def starts(self, target: str, variant: str) -> list[WorkUnit]:
        """Return the units that follow a target's tumbles by a variant."""
        most = self.sizes.paper_runs if variant == "paper" else None
        return [
            following_unit(unit, self.frames_file(unit), variant, self.name(target))
            for unit in self.frames(target)[:most]
        ]
