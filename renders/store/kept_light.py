"""What is kept of a run's light once its frames are exposed, and whether a budget can hold it.

Thousands of exposures of eight groups outgrow any disk. A run streams: it traces, exposes and
moves on. Detector frames and truth always stay; of the light all may, or that of every so many
frames, or nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from models.errors import ScenarioError
from renders.scenario.scenario import RenderRequest
from renders.store.budget import GB, budget_bytes
from renders.world.world import World

What: TypeAlias = Literal["all", "some", "none"]
KEEP_EVERY = 10  # frames from one that keeps its light to the next, unless asked
GROUP_BYTES, GEOMETRY_BYTES = 2, 12  # of a pixel: a half float; depth, a normal and a label
HEADER_BYTES = 65536  # more than header and row table of any entry


@dataclass(frozen=True)
class LightKeeping:
    """What is kept.

    Attributes
    ----------
    what : str
        ``all``, ``some`` or ``none``.
    every : int
        With ``some``, frames from one whose groups are kept to the next.
    """

    what: What = "all"
    every: int = KEEP_EVERY

    def keeps(self, frame: int) -> bool:
        """Tell whether the groups of a frame go to the store."""
        return self.what == "all" or (self.what == "some" and frame % self.every == 0)

    @property
    def uses_store(self) -> bool:
        """Whether anything goes to the store."""
        return self.what != "none"

    def __str__(self) -> str:
        """Return it as it is typed."""
        every = f" --keep-every {self.every}" if self.what == "some" else ""
        return f"--keep-light {self.what}{every}"


ALL_LIGHT = LightKeeping()


def keeping(request: RenderRequest) -> LightKeeping:
    """Return what a request asks to keep.

    Raises
    ------
    ScenarioError
        If its options contradict each other.
    """
    what, every, seeds = request.keep_light, request.keep_every, request.seeds
    if every is not None and what != "some":
        raise ScenarioError(
            f"expected --keep-every only with --keep-light some, got it with {what}"
        )
    if every is not None and every < 1:
        raise ScenarioError(f"expected --keep-every of at least 1, got {every}")
    if seeds > 1 and what != "all":
        raise ScenarioError(
            f"expected --keep-light all with --seeds {seeds}, got {what}: each run exposes every "
            "frame again from its light groups; leave out one of the two"
        )
    return LightKeeping(what, every or KEEP_EVERY)


def exposure_bytes(world: World) -> int:
    """Return the most that one exposure can take in the store: all that is never compressed."""
    groups = _most_groups(world)
    each = GROUP_BYTES * groups + GEOMETRY_BYTES
    return each * world.camera.width * world.camera.height + HEADER_BYTES * (groups + 1)


def _most_groups(world: World) -> int:
    """Return how many groups light the exposure with the most: none do in the Earth's shadow."""
    some = world.exposures if world.sky.eclipses else world.exposures[: len(world.bands)]
    return max(len(world.groups(exposure)) for exposure in some)


def checked_budget(request: RenderRequest, world: World) -> float:
    """Return the store's budget in bytes; see ``budget_bytes``.

    Raises
    ------
    ScenarioError
        If it is none, or cannot hold even one exposure.
    """
    budget, least = budget_bytes(request.store_budget_gb), exposure_bytes(world)
    if keeping(request).uses_store and budget < least:
        groups = _most_groups(world)
        raise ScenarioError(
            f"expected --store-budget-gb of at least {least / GB:.2g}, so that one exposure of "
            f"{groups} light groups at {world.camera.width} x {world.camera.height} is sure to "
            f"fit, got {budget / GB:g}; give more, or --keep-light none"
        )
    return budget
