"""The stars stand where other catalogues have them, and are as bright as the Sun would be."""

from __future__ import annotations

import numpy as np
import pytest

from models.lights.sun import PASSBAND_IRRADIANCE_W_M2
from models.sky.star_catalogue import TABLE, bright_stars, direction_in_icrs
from models.sky.star_light import ZERO_MAGNITUDE_W_M2, irradiance_w_m2, visual_minus_infrared

PLACE_ARCSEC = (
    3.0  # the list prints 0.1 s of right ascension and 1 arcsec, and 16 years have passed
)
BLACKBODY_MAG = 0.12  # what Balmer's and Paschen's jumps and lines do to the colour of a real star
SUN_SHARE = 0.08  # 3 % of the zero point, 5 % of the colours
LARGEST_KB = 150

# Hipparcos (ESA 1997), epoch 2000: right ascension and declination, deg; of stars that hardly move.
HIPPARCOS = {
    424: (37.95456, 89.26411),  # Polaris
    2061: (88.79294, 7.40706),  # Betelgeuse
    1713: (78.63447, -8.20164),  # Rigel
    1903: (84.05339, -1.20192),  # Alnilam
    5056: (201.29825, -11.16132),  # Spica
    7924: (310.35798, 45.28034),  # Deneb
    6134: (247.35192, -26.43200),  # Antares
    1165: (56.87115, 24.10514),  # Alcyone
    4853: (191.93026, -59.68877),  # Mimosa
}


@pytest.mark.parametrize("number", HIPPARCOS)
def test_stars_stand_where_hipparcos_saw_them(number: int) -> None:
    stars = bright_stars()
    found = stars.directions_in_icrs[stars.numbers.index(number)]
    apart = np.linalg.norm(found - direction_in_icrs(*HIPPARCOS[number]))
    assert np.rad2deg(apart) * 3600.0 < PLACE_ARCSEC


def test_there_is_one_of_each_and_as_many_as_the_sky_has() -> None:
    """Hipparcos has 519 stars to V = 4.0 and 815 to 4.4; some of ours are one half of a pair."""
    stars = bright_stars()
    assert len(set(stars.numbers)) == len(stars.numbers) == 1171
    np.testing.assert_allclose(np.linalg.norm(stars.directions_in_icrs, axis=1), 1.0)
    assert (np.diff(stars.visual_mag) >= 0.0).all()
    assert np.count_nonzero(stars.visual_mag <= 4.0) == pytest.approx(519, rel=0.03)
    assert np.count_nonzero(stars.visual_mag <= 4.4) == pytest.approx(815, rel=0.03)


def test_the_table_says_where_it_comes_from_and_is_small() -> None:
    assert "Astronomical Almanac" in TABLE.read_text().split("\nhr,")[0]
    assert TABLE.stat().st_size < LARGEST_KB * 1000


def test_the_sky_is_not_lopsided() -> None:
    """The mean of 1171 even directions is short of 0.03 but for the Milky Way's southern wealth."""
    mean = bright_stars().directions_in_icrs.mean(axis=0)
    assert np.linalg.norm(mean) < 0.15


@pytest.mark.parametrize("b_v", np.arange(-0.2, 1.41, 0.1))
def test_colours_are_those_of_a_black_body(b_v: float) -> None:
    """Temperature by B-V from Ballesteros 2012, EPL 97, 34008, equation 14; 545 and 798 nm."""

    def temperature_k(colour: float) -> float:
        return 4600.0 * (1.0 / (0.92 * colour + 1.7) + 1.0 / (0.92 * colour + 0.62))

    def ratio(kelvin: float) -> float:
        x, y = 0.0143877 / 545e-9 / kelvin, 0.0143877 / 798e-9 / kelvin
        return float((798.0 / 545.0) ** 5 * np.expm1(y) / np.expm1(x))

    expected = -2.5 * np.log10(ratio(temperature_k(b_v)) / ratio(temperature_k(0.0)))
    assert visual_minus_infrared(b_v, "") == pytest.approx(expected, abs=BLACKBODY_MAG)


def test_the_sun_taken_for_a_star_gives_its_own_light() -> None:
    """V = -26.76 (Willmer 2018), B-V = 0.653 (Ramirez et al. 2012); the light is ASTM E490's."""
    found = irradiance_w_m2(-26.76, 0.653)
    assert found == pytest.approx(PASSBAND_IRRADIANCE_W_M2, rel=SUN_SHARE)


def test_five_magnitudes_are_a_hundredfold_and_red_ones_shine_more() -> None:
    assert irradiance_w_m2(0.0, 0.0) == pytest.approx(ZERO_MAGNITUDE_W_M2)
    assert irradiance_w_m2(1.0, 0.5) == pytest.approx(100.0 * irradiance_w_m2(6.0, 0.5))
    in_order = [irradiance_w_m2(3.0, 0.0)]
    in_order += [irradiance_w_m2(3.0, 1.0)]
    in_order += [irradiance_w_m2(3.0, 1.6, f"M{k}") for k in range(9)]
    assert (np.diff(in_order) > 0.0).all()


def test_the_brightest_in_the_near_infrared_are_those_that_are() -> None:
    """Betelgeuse and Sirius lead, and Gacrux and beta Gruis, of class M, pass Vega."""
    stars = bright_stars()
    order = [stars.numbers[row] for row in np.argsort(-stars.irradiance_w_m2)]
    assert set(order[:2]) == {2061, 2491}
    assert max(order.index(4763), order.index(8636)) < order.index(7001)
