"""The colour filters of a Bayer chip: which pixel sees which band, and what each band holds.

Rows of red and green alternate with rows of green and blue (Bayer 1976, US patent 3,971,065); the
first pixel is red. The bands are those of common dye filters, made rectangular; their heights are
our estimate. Sunlight within a band is that of a black body of the Sun's effective temperature and
size, which the true spectrum follows within some per cent between 420 and 680 nm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.arrays import AnyArray, Floats, Indices
from models.sensors.camera_chip import LIGHT_SPEED_M_S, PLANCK_J_S

BOLTZMANN_J_K = 1.380649e-23
SUN_K = 5772.0  # nominal effective temperature, IAU 2015 resolution B3
SUN_RADIUS_AU = 0.00465047  # nominal solar radius over the astronomical unit
RGGB = ((0, 1), (1, 2))  # index of the filter at (row, column), both counted in twos
COLOURS = 3


@dataclass(frozen=True)
class ColourBand:
    """One of the filters.

    Attributes
    ----------
    name : str
    low_nm, high_nm : float, nm
    transmission : float
    lamp_share : float
        Of a white LED's radiant power, how much falls within the band; our estimate.
    """

    name: str
    low_nm: float
    high_nm: float
    transmission: float
    lamp_share: float

    @property
    def middle_nm(self) -> float:
        """Middle of the band, nm."""
        return 0.5 * (self.low_nm + self.high_nm)

    @cached_property
    def sun_irradiance_w_m2(self) -> float:
        """Sunlight within the band on a surface that faces the Sun at 1 au, W/m2."""
        wavelength_m = 1e-9 * np.linspace(self.low_nm, self.high_nm, 101)
        exponent = PLANCK_J_S * LIGHT_SPEED_M_S / (wavelength_m * BOLTZMANN_J_K * SUN_K)
        radiance = 2.0 * PLANCK_J_S * LIGHT_SPEED_M_S**2 / wavelength_m**5 / np.expm1(exponent)
        return float(np.trapezoid(np.pi * SUN_RADIUS_AU**2 * radiance, wavelength_m))


BANDS = (
    ColourBand("red", 590.0, 680.0, transmission=0.90, lamp_share=0.25),
    ColourBand("green", 500.0, 580.0, transmission=0.80, lamp_share=0.35),
    ColourBand("blue", 420.0, 500.0, transmission=0.75, lamp_share=0.25),
)


def filter_of_pixel(height: int, width: int) -> Indices:
    """Return which of ``BANDS`` each pixel sees, (height, width)."""
    pattern = np.array(RGGB)
    tiled = np.tile(pattern, (-(-height // 2), -(-width // 2)))
    return np.asarray(tiled[:height, :width])


def mosaicked(planes: Sequence[AnyArray]) -> Floats:
    """Return what the pixels behind their filters get of three planes.

    Parameters
    ----------
    planes : sequence of three (height, width) arrays
        Red, green, blue at every pixel.

    Returns
    -------
    (height, width) array
    """
    mosaic = np.array(planes[1], dtype=np.float64)
    mosaic[0::2, 0::2] = planes[0][0::2, 0::2]
    mosaic[1::2, 1::2] = planes[2][1::2, 1::2]
    return mosaic
