from __future__ import annotations

import numpy as np
import pytest

from models.motion.chaser_navigation import SIGMA_M, SIGMA_M_S, corrupted
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.yamanaka_ankersen import state_transition
from pipelines.filters.translation_process import tidal_sigma, transition_and_noise

ORBITS = {
    "LEO": KeplerOrbit(7.1431e6, 1.4e-4, np.deg2rad(98.2), 1.38, 1.5, 0.0),
    "HEO": KeplerOrbit(6.69316e7, 0.808, np.deg2rad(69.9), 6.15, 1.68, np.deg2rad(30.0)),
    "GEO": KeplerOrbit(4.21641e7, 1.1e-4, np.deg2rad(0.005), 4.8, 0.73, 0.0),
}
STATE = np.array([0.3, 30.0, -0.5, 3e-3, -1e-3, 0.0])


@pytest.mark.parametrize("name", list(ORBITS))
def test_the_noise_is_that_of_a_corrupted_anomaly(name: str) -> None:
    """Against transitions with the chaser's orbit drawn wrong: covered, and not by much more."""
    orbit = ORBITS[name]
    right = state_transition(orbit, 99.0, 100.0) @ STATE
    kicks = []
    for frame in range(200):
        noisy = KeplerOrbit.from_state(corrupted(orbit.state(100.0), seed=0, run=0, frame=frame))
        kicks.append((state_transition(noisy, 99.0, 100.0) @ STATE - right)[3:])
    drawn = np.sqrt(np.mean(np.square(kicks), axis=0)).max()  # m/s in one second: m/s2
    sigma = tidal_sigma(orbit, STATE, 100.0, SIGMA_M, SIGMA_M_S)
    assert drawn < 1.1 * sigma  # 200 draws know their sigma to 5 %
    assert sigma < 10.0 * drawn


def test_what_the_model_leaves_out_is_a_slow_push() -> None:
    """Against pushes drawn, each held for two radians of the orbit: the drift after ten."""
    orbit, sigma = ORBITS["LEO"], 1e-7
    radian_s = 1.0 / orbit.anomaly_rate(0.0)
    _, noise = transition_and_noise(
        orbit, STATE, 0.0, 10.0 * radian_s, sigma_m=0.0, sigma_m_s=0.0, acceleration_m_s2=sigma
    )
    pushes = sigma * np.random.default_rng(2).standard_normal((20_000, 5))
    speed = 2.0 * radian_s * pushes.cumsum(axis=1)  # without the tides, as the noise has it
    place = 2.0 * radian_s * (speed - radian_s * pushes).sum(axis=1)
    drawn = np.array([place.std(), speed[:, -1].std()])
    expected = np.sqrt([noise[1, 1], noise[4, 4]])
    np.testing.assert_allclose(drawn, expected, rtol=0.03)  # pushes held are not quite white
    share = noise[1, 4] / (expected[0] * expected[1])
    assert np.corrcoef(place, speed[:, -1])[0, 1] == pytest.approx(share, abs=0.03)


def test_the_transition_is_yamanakas_and_ankersens() -> None:
    flow, noise = transition_and_noise(
        ORBITS["HEO"], STATE, 5.0, 7.0, sigma_m=0.0, sigma_m_s=0.0, acceleration_m_s2=0.0
    )
    np.testing.assert_array_equal(flow, state_transition(ORBITS["HEO"], 5.0, 7.0))
    np.testing.assert_array_equal(noise, np.zeros((6, 6)))
