"""How much Monte-Carlo noise the light of an exposure may have: a share of what the detector adds.

It is told for the exposure time that is planned before any image; where a meter chooses, for the
first one. A frame exposed for longer shows more of it. Light that frames at one pose share is
traced for the longest of them.
"""

from __future__ import annotations

from collections.abc import Sequence

from models.onboard import PosePrior
from renders.detector.expose import SUNLIGHT_NM, electrons_per_radiance
from renders.tracing.light_groups import LampGroup, LightGroup
from renders.tracing.noise_limit import NoiseLimit
from renders.world.exposure import Exposure
from renders.world.world import World

LAMPS_SHARE = 2.0  # of the noise in lamps' light: sunlight, and its own shot noise, lie over it


def noise_limits(
    world: World, exposure: Exposure, groups: Sequence[LightGroup], prior: PosePrior | None
) -> dict[str, NoiseLimit] | None:
    """Return what the light of an exposure is traced to.

    Parameters
    ----------
    world : World
    exposure : Exposure
    groups : sequence of LightGroup
    prior : PosePrior or None
        From which exposure times are planned.

    Returns
    -------
    dict of NoiseLimit, or None
        By the name of a group; None if the scenario asks for as many samples in each pixel.
    """
    scenario = world.scenario
    if scenario.render.noise is None:
        return None
    optics, detector = scenario.simulated_optics, scenario.simulated_detector
    company = world.company(exposure)
    limits = {}
    for group in groups:
        exposure_s = 1e-3 * max(
            world.plan.before_any_image(each.time_s, prior)
            for each in company
            if each == exposure or group in world.groups(each)
        )
        wavelength = group.ring.wavelength_nm if isinstance(group, LampGroup) else SUNLIGHT_NM
        electrons = exposure_s * electrons_per_radiance(optics, detector, wavelength)
        share = scenario.render.noise * (LAMPS_SHARE if isinstance(group, LampGroup) else 1.0)
        limits[group.name] = NoiseLimit(
            share, electrons, detector.read_noise_e, detector.full_well_e
        )
    return limits
