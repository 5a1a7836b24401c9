"""One frame from its light groups: the world's lens, chip and particles, for one exposure.

The chain itself is ``renders.expose``. No Mitsuba is needed, so a frame can be composed again, with
another exposure time, detector or seed, as often as a study wants.
"""

from __future__ import annotations

from collections.abc import Mapping

from models.arrays import Image, Radiance
from renders.expose import electron_rate, expose_electrons, exposure_rng, mean_electrons
from renders.light_groups import LightGroup
from renders.radiation_hits import radiation_hits
from renders.world import Exposure, World


def compose(
    world: World,
    groups: Mapping[LightGroup, Radiance],
    exposure: Exposure,
    exposure_ms: float,
    run: int,
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

    Returns
    -------
    (height, width) uint16 array, DN.
    """
    optics, detector = world.scenario.simulated_optics, world.scenario.simulated_detector
    rate = electron_rate(groups, optics, detector)
    mean_e = mean_electrons(rate, exposure_ms, world.camera, optics, detector)
    key = (run, exposure.frame, exposure.band)
    radiation = world.scenario.simulated_radiation
    particles_e = radiation_hits(radiation, detector, mean_e.shape, exposure_ms, key)
    return expose_electrons(mean_e, detector, exposure_rng(*key), particles_e)
