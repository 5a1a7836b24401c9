"""The star camera: how much light, and which way it looks."""

from dataclasses import replace

import numpy as np
import pytest

from models.sensors.star_camera import StarCamera, star_camera
from models.sky.broadband_flux import zero_magnitude_photons_m2_s


def test_a_star_of_magnitude_zero_is_a_thousand_photons():
    """The rule of thumb at 550 nm: 1000 photons a second, square centimetre and Angstrom."""
    found = zero_magnitude_photons_m2_s(500.0, 600.0) * 1e-4 / 1000.0
    assert found == pytest.approx(1000.0, rel=0.1)


def test_bands_add_up():
    parts = [zero_magnitude_photons_m2_s(*band) for band in ((400.0, 650.0), (650.0, 900.0))]
    assert sum(parts) == pytest.approx(zero_magnitude_photons_m2_s(400.0, 900.0))


def test_five_magnitudes_are_a_hundredfold():
    light = StarCamera().electrons(np.array([1.0, 6.0]))
    assert light[0] == pytest.approx(100.0 * light[1])


def test_with_other_pixels_it_gathers_the_same_light_from_the_same_field():
    one, other = star_camera(1024), star_camera(256)
    assert other.zero_magnitude_e_s == pytest.approx(one.zero_magnitude_e_s)
    corner = [each.camera.rays(each.camera.spread_px(1))[0] for each in (one, other)]
    np.testing.assert_allclose(corner[0], corner[1], atol=1e-12)


@pytest.mark.parametrize("boresight", [(0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.6, 0.0, -0.8)])
def test_it_looks_along_its_boresight(boresight):
    turn = replace(StarCamera(), boresight_in_body=boresight).body_from_cam
    np.testing.assert_allclose(turn @ [0.0, 0.0, 1.0], boresight, atol=1e-12)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1.0)
