from __future__ import annotations

import numpy as np
import pytest

from models.arrays import Floats
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.relative_motion import integrate, linear_rate, nonlinear_rate
from models.motion.relative_state import ChaserState

# Both orbits are known to 1e-16 of 7e6 m (1.3e7 m at the HEO's perigee), and their anomalies to
# 1e-16 of a radian: what is left of their difference is some nanometres.
TWO_ORBITS_M = 1e-7
LEO = KeplerOrbit.from_elements_deg(
    a_km=7143.1,
    e=1.4e-4,
    i_deg=98.2,
    raan_deg=79.2,
    argument_of_perigee_deg=85.9,
    true_anomaly_deg=0.0,
)
HEO = KeplerOrbit.from_elements_deg(
    a_km=66931.6,
    e=0.808,
    i_deg=69.9,
    raan_deg=352.5,
    argument_of_perigee_deg=96.0,
    true_anomaly_deg=30.0,
)
ORBITS = pytest.mark.parametrize("orbit", [LEO, HEO], ids=["LEO", "HEO"])


def target_orbit(chaser: KeplerOrbit, relative: Floats) -> KeplerOrbit:
    """Return the orbit of the target, by the two-body problem alone."""
    axes, state = chaser.inertial_from_lvlh(0.0), chaser.state(0.0)
    spin = np.array([0.0, 0.0, chaser.anomaly_rate(0.0)])
    velocity = relative[3:] + np.cross(spin, relative[:3])
    return KeplerOrbit.from_state(
        ChaserState(
            0.0,
            state.position_in_inertial + axes @ relative[:3],
            state.velocity_in_inertial + axes @ velocity,
        )
    )


@ORBITS
@pytest.mark.parametrize("reach_m", [30.0, 5000.0])
def test_it_is_the_difference_of_two_orbits(orbit: KeplerOrbit, reach_m: float) -> None:
    """Equation 11 against two ellipses, each solved by Kepler, at 30 m and far from linear."""
    relative = reach_m * np.array([0.2, 1.0, -0.4, 3e-4, -1e-4, 2e-4])
    target = target_orbit(orbit, relative)
    found = integrate(orbit, relative, (0.0, 1800.0))
    for time_s in (0.0, 613.0, 1800.0):
        apart = target.state(time_s).position_in_inertial - orbit.state(time_s).position_in_inertial
        expected = orbit.inertial_from_lvlh(time_s).T @ apart
        np.testing.assert_allclose(found(time_s)[:3], expected, atol=TWO_ORBITS_M)


@ORBITS
def test_its_rate_is_that_of_its_position(orbit: KeplerOrbit) -> None:
    found = integrate(orbit, [1.0, 30.0, 2.0, 3e-3, -1e-3, 1e-3], (0.0, 1000.0))
    rate = (found(500.5)[:3] - found(499.5)[:3]) / 1.0
    np.testing.assert_allclose(found(500.0)[3:], rate, atol=1e-8)  # third derivative / 24


@ORBITS
def test_the_linear_equation_is_its_limit(orbit: KeplerOrbit) -> None:
    """What is left falls with the square of the distance."""
    away = np.array([0.3, 1.0, 0.5, 1e-4, 2e-4, -1e-4])
    left = [
        np.linalg.norm(
            nonlinear_rate(orbit, 100.0, reach * away) - linear_rate(orbit, 100.0, reach * away)
        )
        for reach in (1000.0, 2000.0)
    ]
    assert left[1] / left[0] == pytest.approx(4.0, rel=1e-3)


def test_what_stands_still_at_the_chaser_stays() -> None:
    np.testing.assert_array_equal(integrate(LEO, np.zeros(6), (0.0, 100.0))(100.0), np.zeros(6))


def test_bad_states_and_spans_are_refused() -> None:
    with pytest.raises(ValueError, match="six finite numbers"):
        integrate(LEO, [1.0, 2.0, 3.0], (0.0, 1.0))
    with pytest.raises(ValueError, match="earlier then later"):
        integrate(LEO, np.zeros(6), (1.0, 1.0))
