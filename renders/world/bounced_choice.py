"""Whether bounced sunlight is traced once for a world's exposures, or in each of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from models.errors import ScenarioError
from models.pose import RigidTransform
from renders.world.world import World

LEAST_EXPOSURES = 4  # from which tracing it once costs less
SEEN_FROM = 16  # of the poses that are rendered: what is seen is asked from these


def seen_from(world: World, is_jit: bool) -> list[RigidTransform] | None:
    """Return the poses whose view bounced light is traced for beforehand; None if it is not.

    Parameters
    ----------
    world : World
    is_jit : bool
        Of the variant that renders.

    Raises
    ------
    ScenarioError
        If it is asked for where the Sun turns over the target.
    """
    asked, exposures = world.scenario.render.bounced, world.exposures
    stands = world.sky.turning.suns_stand_still
    if asked == "looked_up" and not stands:
        raise ScenarioError(
            f"{world.scenario.name}: expected render.bounced as traced or auto where the Sun turns "
            "over the target, got looked_up: it would have to be traced anew for each image"
        )
    if asked == "auto":
        uniform = world.scenario.render.noise is None
        if uniform or not stands or len(exposures) < LEAST_EXPOSURES:
            return None
    if asked == "traced" or not is_jit or not exposures:
        return None
    chosen = np.unique(np.linspace(0, len(exposures) - 1, SEEN_FROM).round().astype(int))
    return [world.trajectory.cam_from_target(exposures[n].time_s) for n in chosen]


def told(poses: Sequence[RigidTransform] | None, suns: int) -> str:
    """Return the choice in words."""
    if poses is None:
        return "bounced light is traced in each exposure"
    once = "once for the Sun" if suns == 1 else f"once for each of {suns} Suns"
    return f"bounced light is traced {once}, and looked up in each exposure"
