"""One frame from its light groups: the world's lens, chip and particles, for one exposure.

The chain itself is ``renders.detector.expose``. No Mitsuba is needed, so a frame can be composed
again, with another exposure time, detector or seed, as often as a study wants.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from models.arrays import Image, Radiance
from models.sensors.bayer_mosaic import mosaicked
from models.spacecraft.line_of_sight import is_hidden
from renders.detector.colour import colour_rates, electrons_of_band
from renders.detector.drift import Drift
from renders.detector.expose import (
    SUNLIGHT_NM,
    electron_rate,
    electrons_per_radiance,
    expose_electrons,
    exposure_rng,
    mean_electrons,
)
from renders.detector.radiation_hits import radiation_hits
from renders.detector.stars import star_electrons
from renders.detector.veiling_glare import sun_glare
from renders.tracing.light_groups import LightGroup, SunGroup
from renders.world.exposure import Exposure
from renders.world.world import World


def compose(
    world: World,
    groups: Mapping[LightGroup, Radiance],
    exposure: Exposure,
    exposure_ms: float,
    run: int,
    depth_m: Radiance | None = None,
) -> Image:
    """Expose one frame from its light groups.

    Parameters
    ----------
    world : World
    groups : mapping of LightGroup to (height, width) arrays, W m-2 sr-1
        What lights it.
    exposure : Exposure
    exposure_ms : float, ms
    run : int
        Keys its random numbers, with the exposure's frame and band.
    depth_m : (height, width) array, m, optional
        Of each pixel, 0 in space; a lens with a focus and the stars need it.

    Returns
    -------
    (height, width) uint16 array, DN.
    """
    optics, detector = world.scenario.simulated_optics, world.scenario.simulated_detector
    drift = Drift.of(world.scenario.drift, run)
    lit = groups if drift is None else drift.lit(groups, world.camera)
    charges = [
        mean_electrons(rate, exposure_ms, world.camera, optics, detector, depth_m, drift)
        for rate in rates_of(world, lit, exposure)
    ]
    mean_e = mosaicked(charges) if world.sensor.in_colour else charges[0]
    if world.scenario.stars.shine and world.sky.shows_stars(exposure.time_s):
        mean_e += star_electrons(world, exposure.time_s, exposure_ms, depth_m)
    own_seed = world.scenario.exposure.noise_seed
    key = (run, exposure.frame, exposure.band, *(() if own_seed is None else (own_seed,)))
    radiation = world.scenario.simulated_radiation
    particles_e = radiation_hits(radiation, detector, mean_e.shape, exposure_ms, key)
    return expose_electrons(mean_e, detector, exposure_rng(*key), particles_e)


def rates_of(
    world: World, groups: Mapping[LightGroup, Radiance], exposure: Exposure
) -> list[Radiance]:
    """Add light groups, and what the lens scatters of their Suns, up to electrons.

    Parameters
    ----------
    world : World
    groups : mapping of LightGroup to (height, width) arrays, W m-2 sr-1
    exposure : Exposure

    Returns
    -------
    list of (height, width) float32 arrays, e/s
        Unblurred: one, or behind the red, the green and the blue filter.
    """
    optics, detector = world.scenario.simulated_optics, world.scenario.simulated_detector
    in_colour = world.sensor.in_colour
    if not groups:  # in the Earth's shadow
        shape = (3,) if in_colour else (1,)
        return list(np.zeros((*shape, world.camera.height, world.camera.width), np.float32))
    groups = _left_free(world, groups, exposure)
    if in_colour:
        rates = colour_rates(groups, optics, detector)
    else:
        rates = [electron_rate(groups, optics, detector)]
    for sun, glare in _glares(world, groups, exposure):
        electrons = electrons_per_radiance(optics, detector, SUNLIGHT_NM)
        if in_colour:
            electrons = electrons_of_band(sun.channel, optics, detector)
        rates[sun.channel] += glare * np.float32(electrons)
    return rates


def _glares(
    world: World, groups: Mapping[LightGroup, Radiance], exposure: Exposure
) -> Iterator[tuple[SunGroup, Radiance]]:
    """Yield the Suns that the target does not hide, and each one's glare, W m-2 sr-1."""
    scatter = world.scenario.simulated_scatter
    if scatter.peak_1_sr <= 0.0:
        return
    cam_from_target = world.trajectory.cam_from_target(exposure.time_s)
    lens = cam_from_target.inverse().translation
    for group in groups:
        if not isinstance(group, SunGroup):
            continue
        towards = np.array(group.direction_in_target)
        glare = sun_glare(
            world.camera,
            cam_from_target.rotation @ towards,
            group.irradiance_w_m2,
            scatter,
            is_hidden(world.target, lens, towards),
        )
        if glare is not None:
            free = np.float32(world.sky.sunlit_share(group, exposure.time_s))
            yield group, free * glare


def _left_free(
    world: World, groups: Mapping[LightGroup, Radiance], exposure: Exposure
) -> dict[LightGroup, Radiance]:
    """Return groups with each Sun as dim as the Earth leaves it: light is linear."""
    scaled = dict(groups)
    for group in groups:
        if isinstance(group, SunGroup):
            share = world.sky.sunlit_share(group, exposure.time_s)
            if share < 1.0:
                scaled[group] = groups[group] * np.float32(share)
    return scaled
