"""The detector's numbers, against the textbook and by hand."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import constants

from models.sensors.camera_chip import Detector, photon_energy_j

DETECTOR = Detector()


@pytest.mark.parametrize("wavelength_nm", [400.0, 800.0, 850.0])
def test_photon_energy_is_planck_times_light_speed_over_wavelength(wavelength_nm: float) -> None:
    expected = constants.h * constants.c / (wavelength_nm * 1e-9)
    assert photon_energy_j(wavelength_nm) == pytest.approx(expected, rel=1e-12)


def test_an_850_nm_photon_has_1_46_electronvolts() -> None:
    assert photon_energy_j(850.0) / constants.e == pytest.approx(1.459, abs=5e-4)


def test_twelve_bits_end_at_4095() -> None:
    assert DETECTOR.max_dn == 4095
    assert replace(DETECTOR, bits=8).max_dn == 255
    assert isinstance(DETECTOR.max_dn, int)


def test_saturation_is_the_full_well_or_the_converters_end() -> None:
    """100 ke at 26 e/DN over a bias of 100 DN is 3946 DN; at 20 e/DN the converter ends first."""
    assert DETECTOR.saturation_dn == pytest.approx(3946.15, abs=0.01)
    assert replace(DETECTOR, gain_e_dn=20.0).saturation_dn == 4095.0


def test_noise_at_the_bias_is_read_noise_and_rounding() -> None:
    expected = np.sqrt((12.0 / 26.0) ** 2 + 1.0 / 12.0)
    assert DETECTOR.noise_dn(np.array([100.0]))[0] == pytest.approx(expected)
    below = DETECTOR.noise_dn(np.array([80.0]))  # read noise may go below the bias
    assert below[0] == pytest.approx(expected)


def test_noise_of_a_bright_pixel_is_the_square_root_of_its_electrons() -> None:
    level = 100.0 + 60_000.0 / 26.0
    assert DETECTOR.noise_dn(np.array([level]))[0] == pytest.approx(np.sqrt(60_000) / 26, rel=5e-3)


@given(
    level=st.floats(0.0, 4095.0),
    step=st.floats(0.0, 1000.0),
    gain=st.floats(0.5, 100.0),
)
def test_noise_grows_with_the_level(level: float, step: float, gain: float) -> None:
    detector = replace(DETECTOR, gain_e_dn=gain)
    low, high = detector.noise_dn(np.array([level, level + step]))
    assert 0.0 < low <= high
