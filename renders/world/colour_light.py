"""A light group as a camera of colours sees it: one for each of its filters.

Light is linear in each band: a Sun becomes a red, a green and a blue one, which share the rays of
one pass and are exposed on their own pixels.
"""

from __future__ import annotations

from dataclasses import replace

from models.sensors.bayer_mosaic import BANDS, ColourBand
from renders.tracing.light_groups import EarthGroup, LightGroup, SunGroup


def in_each_colour(group: LightGroup) -> list[LightGroup]:
    """Return a group's parts in red, green and blue, in that order of channels."""
    return [_part(group, band, channel) for channel, band in enumerate(BANDS)]


def _part(group: LightGroup, band: ColourBand, channel: int) -> LightGroup:
    name = f"{group.name}_{band.name}"
    irradiance = band.sun_irradiance_w_m2
    if isinstance(group, SunGroup):
        return replace(group, name=name, irradiance_w_m2=irradiance, channel=channel)
    if isinstance(group, EarthGroup):
        earth = replace(group.earth, sun_irradiance_w_m2=irradiance)
        return replace(group, name=name, earth=earth, channel=channel)
    ring = replace(
        group.ring,
        wavelength_nm=band.middle_nm,
        intensity_w_sr=band.lamp_share * group.ring.intensity_w_sr,
    )
    return replace(group, name=name, ring=ring, channel=channel)
