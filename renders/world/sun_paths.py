"""Whether sunlight is followed from the Sun, for all of a world's exposures or for each of them.

The choice depends on no number of exposures, so that a frame is the same alone and in a batch.
"""

from __future__ import annotations

from dataclasses import dataclass

from renders.world.world import World

REFERENCE_M = 5.0  # at which a footprint is reckoned: light's noise depends on it, not light


@dataclass(frozen=True)
class SunPaths:
    """How many paths are followed from each Sun.

    Attributes
    ----------
    paths : int
    once : bool
        For all exposures, not for each.
    footprint_m2 : float, m2
        That a pixel covers of the target, about.
    """

    paths: int
    once: bool
    footprint_m2: float


def sun_paths(world: World) -> SunPaths | None:
    """Return how sunlight is followed from the Sun; None if it is not."""
    paths = world.scenario.render.paths
    if paths == 0:
        return None
    footprint = REFERENCE_M**2 / (world.camera.fx * world.camera.fy)
    return SunPaths(paths, world.sky.turning.suns_stand_still, footprint)


def told(chosen: SunPaths | None, suns: int) -> str:
    """Return the choice in words."""
    if chosen is None:
        return "light is found from the lens alone"
    each = "the Sun" if suns == 1 else f"each of {suns} Suns"
    when = "once for all exposures" if chosen.once else "in each exposure"
    return f"{chosen.paths} paths are followed from {each}, {when}"
