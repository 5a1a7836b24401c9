"""The light of one frame, traced as ``rvbench run`` would, and what it cost."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.grain.rows import Place, pixels_of
from models.arrays import AnyArray, Floats, Radiance
from renders.batches.studio import Studio
from renders.detector.expose import electron_rate
from renders.store.kept_light import LightKeeping
from renders.store.light_keys import LightKeys
from renders.store.radiance_store import RadianceStore
from renders.tracing.light_groups import LightGroup

if TYPE_CHECKING:
    from renders.tracing.scene import SceneGeometry

MOST_AT_ONCE = 1024  # samples of a pixel: a longer sum in single precision would lose digits


@dataclass(frozen=True, eq=False)
class Traced:
    """One frame's light.

    Attributes
    ----------
    electrons : (height, width) array, e
        That each pixel would collect at the exposure time planned.
    bake_s, light_s : float, s
        Processor time of what all exposures share, and of this one; compiling left out.
    """

    electrons: Floats
    bake_s: float
    light_s: float


def studio_of(place: Place) -> Studio:
    """Return a renderer that keeps nothing."""
    keys = LightKeys(place.world, "jit")
    store = RadianceStore(Path("/nonexistent"), None)
    return Studio(place.world, store, keys, place.world.target.markers, kept=LightKeeping("none"))


def traced(place: Place) -> Traced:
    """Trace a place's frame: twice, as the first time compiles its kernels."""
    cam_from_target = place.world.trajectory.cam_from_target(place.exposure.time_s)
    groups = place.world.lit_by(place.exposure)
    studio = studio_of(place)
    spent = []
    for _ in range(2):
        start = time.process_time()
        light = studio.trace(place.exposure, cam_from_target, groups)
        spent.append(time.process_time() - start)
    return Traced(electrons(place, {group: light[group.name] for group in groups}), *spent)


def exposure_s(place: Place) -> float:
    """Return the exposure time planned, s."""
    prior = place.world.onboard(0).prior
    return 1e-3 * place.world.plan.before_any_image(place.exposure.time_s, prior)


def electrons(place: Place, light: dict[LightGroup, Radiance]) -> Floats:
    """Return what light is worth in each pixel, e, before the lens spreads it.

    Parameters
    ----------
    place : Place
    light : dict of (...,) arrays, W m-2 sr-1

    Returns
    -------
    (...,) array, e
    """
    scenario = place.world.scenario
    rate = electron_rate(light, scenario.simulated_optics, scenario.simulated_detector)
    return np.asarray(rate, dtype=np.float64) * exposure_s(place)


def seen(place: Place) -> AnyArray:
    """Return the pixels that show a spacecraft, (height, width) bool."""
    studio = studio_of(place)
    pose = place.world.trajectory.cam_from_target(place.exposure.time_s)
    truth = studio.pixel_truth(place.exposure, pose)
    return np.asarray(truth.labels > 0)


def path_traced(place: Place, tiles: AnyArray, samples: int, seed: int) -> Floats:
    """Trace some tiles with many samples each, nothing looked up.

    Parameters
    ----------
    place : Place
    tiles : (n, 2) array of int
    samples : int
    seed : int

    Returns
    -------
    (n, TILE_PX, TILE_PX) array, e
    """
    from renders.tracing.group_integrator import trace_groups

    world = place.world
    cam_from_target = world.trajectory.cam_from_target(place.exposure.time_s)
    studio = studio_of(place)
    studio.build(place.exposure, cam_from_target)
    geometry: SceneGeometry = studio.geometry
    groups: Any = world.lit_by(place.exposure)
    pixels = pixels_of(tiles, world.camera.width)
    depth = world.scenario.render.max_depth
    shape = pixels.shape
    total = np.zeros(shape)
    turns = max(1, samples // MOST_AT_ONCE)
    for turn in range(turns):
        light = trace_groups(
            studio.scene,
            geometry.surfaces,
            world.camera,
            cam_from_target,
            groups,
            pixels.ravel(),
            samples // turns,
            depth,
            seed + turn,
        )
        by_group = {group: light[group.name].reshape(shape) for group in groups}
        total += electrons(place, by_group) / turns
    return total
