"""The Sun's light within a band: the table of E490, against Planck's law and against itself."""

import numpy as np
import pytest

from models.lights.solar_spectrum import E490, band_irradiance_w_m2
from models.lights.sun import PASSBAND_IRRADIANCE_W_M2, PASSBAND_NM


def planck_w_m2_um(wavelength_nm: float, kelvin: float) -> float:
    """Irradiance of a black body of the Sun's size and distance."""
    wavelength_m, h, c, k = wavelength_nm * 1e-9, 6.62607015e-34, 299792458.0, 1.380649e-23
    radiance = 2 * h * c**2 / wavelength_m**5 / np.expm1(h * c / (wavelength_m * k * kelvin))
    return float(radiance * np.pi * (6.957e8 / 1.495978707e11) ** 2 * 1e-6)


def test_the_passband_holds_some_74_w_m2() -> None:
    assert band_irradiance_w_m2(*PASSBAND_NM) == PASSBAND_IRRADIANCE_W_M2
    one_watt = 1.0
    assert pytest.approx(74.0, abs=one_watt) == PASSBAND_IRRADIANCE_W_M2


def test_the_spectrum_has_the_slope_of_a_black_body_and_the_calcium_triplet() -> None:
    """The effective temperature is 5772 K; the dips lie at 850.0, 854.4 and 866.5 nm."""
    four_percent = 0.04  # lines of iron and magnesium, and a photosphere of many temperatures
    for wavelength_nm, level in E490:
        if wavelength_nm < 848.0:
            assert level == pytest.approx(planck_w_m2_um(wavelength_nm, 5772.0), rel=four_percent)
    by_nm = dict(E490)
    assert by_nm[850] < 0.97 * by_nm[848]
    assert by_nm[854] < 0.91 * by_nm[852]


def test_bands_add_up() -> None:
    parts = band_irradiance_w_m2(785.0, 812.3) + band_irradiance_w_m2(812.3, 862.0)
    assert parts == pytest.approx(band_irradiance_w_m2(785.0, 862.0), rel=1e-12)


@pytest.mark.parametrize("band", [(700.0, 800.0), (800.0, 900.0), (820.0, 820.0), (830.0, 810.0)])
def test_a_band_that_is_none_or_leaves_the_table_is_refused(band: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="within 779 to 862 nm, got"):
        band_irradiance_w_m2(*band)
