"""Light of a frame in which the camera moves: traced at instants, added up row by row."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from models.arrays import Mask, Radiance
from models.pose import RigidTransform
from renders.tracing.light_groups import LightGroup
from renders.world.exposure import Exposure
from renders.world.shutter import OpenShutter

SHUTTER_SEED = 0x5C

TraceInstant = Callable[[Exposure, RigidTransform, Mask, int], dict[str, Radiance]]
"""Traces an exposure at a pose in some pixels, (height, width) bool, by a number of its own."""


def traced_open(
    shutter: OpenShutter,
    exposure: Exposure,
    groups: Sequence[LightGroup],
    width: int,
    trace: TraceInstant,
) -> dict[str, Radiance]:
    """Add up what each row sees while it is exposed.

    Parameters
    ----------
    shutter : OpenShutter
    exposure : Exposure
    groups : sequence of LightGroup
        Suns and Earth stand as at the frame's time; lamps move with the camera.
    width : int, px
    trace : callable

    Returns
    -------
    dict of (height, width) float32 arrays, W m-2 sr-1, by group name
    """
    height = shutter.row_weights.shape[1]
    images = {group.name: np.zeros((height, width)) for group in groups}
    for number, (offset_s, pose, weights) in enumerate(
        zip(shutter.offsets_s, shutter.poses, shutter.row_weights, strict=True)
    ):
        rows = weights > 0.0
        if not rows.any():
            continue
        instant = replace(exposure, time_s=exposure.time_s + float(offset_s))
        wanted = np.repeat(rows[:, None], width, axis=1)
        for name, light in trace(instant, pose, wanted, number).items():
            images[name] += weights[:, None] * light
    return {name: image.astype(np.float32) for name, image in images.items()}


def seed_of(seed: int, instant: int) -> int:
    """Return the seed of one instant: the same in both exposures of a pair."""
    return int(np.random.SeedSequence([seed, SHUTTER_SEED, instant]).generate_state(1)[0])
