from __future__ import annotations

import numpy as np
import pytest

from models.sensors.bayer_mosaic import BANDS, filter_of_pixel, mosaicked

# ASTM E490 has 1.9 to 2.1 kW m-2 um-1 in the blue, 1.8 to 1.95 in the green, 1.5 to 1.8 in the red.
SPECTRAL_W_M2_UM = {"red": (1500.0, 1800.0), "green": (1750.0, 1950.0), "blue": (1700.0, 2100.0)}


@pytest.mark.parametrize("band", BANDS, ids=lambda band: band.name)
def test_sunlight_in_a_band_is_that_of_the_measured_spectrum(band) -> None:  # type: ignore[no-untyped-def]
    width_um = 1e-3 * (band.high_nm - band.low_nm)
    low, high = SPECTRAL_W_M2_UM[band.name]
    assert low * width_um < band.sun_irradiance_w_m2 < high * width_um


def test_half_of_the_pixels_are_green_and_the_first_is_red() -> None:
    pattern = filter_of_pixel(7, 9)
    assert pattern.shape == (7, 9)
    assert pattern[0, 0] == 0
    whole = filter_of_pixel(8, 8)
    assert [int((whole == colour).sum()) for colour in range(3)] == [16, 32, 16]


def test_each_pixel_takes_its_own_plane() -> None:
    planes = [np.full((5, 6), float(colour)) for colour in range(3)]
    assert np.array_equal(mosaicked(planes), filter_of_pixel(5, 6))
