"""Charge of a chip behind Bayer's filters: all bands pass the lens, each pixel takes its own.

The lens blurs each band before the filters part them, so all three are there at every pixel until
then. Demosaicing is the pipeline's.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from models.arrays import Radiance
from models.sensors.bayer_mosaic import BANDS
from models.sensors.camera_chip import Detector, Optics
from renders.detector.expose import electrons_per_radiance
from renders.tracing.light_groups import LightGroup


def colour_rates(
    groups: Mapping[LightGroup, Radiance], optics: Optics, detector: Detector
) -> list[Radiance]:
    """Add light groups up to electrons per pixel and second, on axis and unblurred.

    Parameters
    ----------
    groups : mapping of LightGroup to (height, width) arrays, W m-2 sr-1
        Each in the channel of its band.
    optics : Optics
    detector : Detector

    Returns
    -------
    list of three (height, width) float32 arrays, e/s
        Behind the red, the green and the blue filter, were it over all pixels.
    """
    shape = next(iter(groups.values())).shape
    rates = [np.zeros(shape, dtype=np.float32) for _ in BANDS]
    for group, radiance in groups.items():
        factor = electrons_of_band(group.channel, optics, detector)
        rates[group.channel] += radiance * np.float32(factor)
    return rates


def electrons_of_band(channel: int, optics: Optics, detector: Detector) -> float:
    """Return electrons per pixel and second for 1 W m-2 sr-1 within a filter's band, on axis.

    Parameters
    ----------
    channel : int
        Which of ``models.sensors.bayer_mosaic.BANDS``.
    optics : Optics
    detector : Detector
    """
    band = BANDS[channel]
    return band.transmission * electrons_per_radiance(optics, detector, band.middle_nm)
