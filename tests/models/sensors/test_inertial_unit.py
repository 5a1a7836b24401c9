"""An inertial unit's errors: random walks, a bias that keeps its size, and the printed numbers."""

from __future__ import annotations

import numpy as np
import pytest

from models.sensors.inertial_unit import InertialUnit

DEG_H = np.deg2rad(1.0) / 3600.0


def test_it_is_as_good_as_is_printed() -> None:
    """VINAG 2018, section 4.1: 100 Hz, 0.1 deg/h and 0.015 mg of bias."""
    unit = InertialUnit()
    assert unit.sample_s == pytest.approx(0.01)
    assert unit.gyro_bias_deg_h == 0.1
    assert unit.force_bias_mg == 0.015


def test_an_hours_noise_walks_by_what_it_is_called_after() -> None:
    """Samples that are independent add up to the walk's size: an hour has 360,000 of them."""
    unit = InertialUnit(gyro_noise_deg_rth=0.05, force_noise_m_s_rth=0.03)
    count = 3600.0 / unit.sample_s
    assert unit.turn_sigma_rad * np.sqrt(count) == pytest.approx(np.deg2rad(0.05), rel=1e-12)
    walked = unit.force_sigma_m_s2 * unit.sample_s * np.sqrt(count)
    assert walked == pytest.approx(0.03, rel=1e-12)


@pytest.mark.parametrize("after_s", [0.01, 60.0, 3600.0, 40_000.0])
def test_a_bias_keeps_its_size_and_forgets(after_s: float) -> None:
    """Gauss and Markov: what is left and what comes are of one variance; e-fold in its time."""
    unit = InertialUnit(gyro_bias_deg_h=0.1, gyro_bias_s=3600.0)
    left, comes = unit.bias_steps(after_s)
    assert left == pytest.approx(np.exp(-after_s / 3600.0))
    kept = (left * 0.1 * DEG_H) ** 2 + comes**2
    assert kept == pytest.approx((0.1 * DEG_H) ** 2, rel=1e-12)


def test_gyroscopes_give_the_turn_of_rate_and_bias() -> None:
    rates, biases = np.array([[0.01, -0.02, 0.03]]), np.array([[1e-4, 2e-4, -3e-4]])
    unit = InertialUnit()
    assert unit.turns(rates, biases, np.zeros((1, 3))) == pytest.approx((rates + biases) * 0.01)
    noisy = unit.turns(rates, biases, np.ones((1, 3)))
    assert noisy - (rates + biases) * 0.01 == pytest.approx(
        np.full((1, 3), unit.turn_sigma_rad), rel=1e-9
    )
