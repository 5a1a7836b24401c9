from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from models.arrays import Floats
from models.motion.clohessy_wiltshire import EARTH_MU_M3_S2
from models.motion.kepler_orbit import KeplerOrbit, eccentric_anomaly
from models.motion.relative_state import ChaserState

ROUNDING = 1e-9  # relative: an eccentricity of 0.9 costs a factor of a few hundred
INTEGRATOR_M = 1e-3  # DOP853 at rtol 1e-13 over one revolution of 1e8 m
HEO = KeplerOrbit.from_elements_deg(
    a_km=66931.6,
    e=0.808,
    i_deg=69.9,
    raan_deg=352.5,
    argument_of_perigee_deg=96.0,
    true_anomaly_deg=30.0,
)
PERIOD_S = 2.0 * np.pi / HEO.mean_motion_rad_s

angles = st.floats(-np.pi, np.pi)
orbits = st.builds(
    KeplerOrbit,
    semi_major_axis_m=st.floats(6.6e6, 1e8),
    eccentricity=st.floats(0.0, 0.9),
    inclination_rad=st.floats(0.0, np.pi),
    raan_rad=angles,
    argument_of_perigee_rad=angles,
    true_anomaly_rad=angles,
)


@given(st.floats(-50.0, 50.0), st.floats(0.0, 0.99))
def test_keplers_equation_holds(mean: float, e: float) -> None:
    found = eccentric_anomaly(mean, e)
    excess = found - e * np.sin(found) - mean
    assert np.sin(0.5 * excess) == pytest.approx(0.0, abs=1e-14)  # whole turns do not count
    assert abs(found) <= np.pi + 1e-12


@given(orbits, st.floats(-1e5, 1e5))
def test_the_state_obeys_the_vis_viva_and_keeps_its_momentum(
    orbit: KeplerOrbit, time_s: float
) -> None:
    state = orbit.state(time_s)
    radius = np.linalg.norm(state.position_in_inertial)
    speed_squared = state.velocity_in_inertial @ state.velocity_in_inertial
    wanted = EARTH_MU_M3_S2 * (2.0 / radius - 1.0 / orbit.semi_major_axis_m)
    assert speed_squared == pytest.approx(wanted, rel=ROUNDING)
    momentum = np.cross(state.position_in_inertial, state.velocity_in_inertial)
    axis = [
        np.sin(orbit.raan_rad) * np.sin(orbit.inclination_rad),
        -np.cos(orbit.raan_rad) * np.sin(orbit.inclination_rad),
        np.cos(orbit.inclination_rad),
    ]
    np.testing.assert_allclose(momentum / orbit.momentum_m2_s, axis, atol=ROUNDING)


@given(orbits, st.floats(-1e4, 1e4))
def test_a_state_gives_back_the_orbit(orbit: KeplerOrbit, ahead_s: float) -> None:
    """Compared by the motion, not by the elements: those of a circle or the equator jump."""
    read = KeplerOrbit.from_state(orbit.state(500.0))
    then, wanted = read.state(500.0 + ahead_s), orbit.state(500.0 + ahead_s)
    scale = orbit.semi_major_axis_m
    np.testing.assert_allclose(
        then.position_in_inertial, wanted.position_in_inertial, atol=100 * ROUNDING * scale
    )


@pytest.mark.parametrize("e", [0.0, 1e-13, 1.1e-4])
@pytest.mark.parametrize("inclination", [0.0, 1e-14, np.pi, 0.7])
def test_orbits_without_a_perigee_or_a_node_move_as_they_should(
    e: float, inclination: float
) -> None:
    orbit = KeplerOrbit(4.2e7, e, inclination, 0.3, 0.9, -2.0)
    read = KeplerOrbit.from_state(orbit.state(0.0))
    for time_s in (0.0, 5000.0):
        np.testing.assert_allclose(
            read.state(time_s).position_in_inertial,
            orbit.state(time_s).position_in_inertial,
            atol=1e-2,  # an eccentricity of 1e-13 taken for none is 4e-6 m, the rest rounding
        )


def test_it_is_what_gravity_does() -> None:
    def gravity(_: float, state: Floats) -> Floats:
        distance = np.linalg.norm(state[:3])
        return np.concatenate([state[3:], -EARTH_MU_M3_S2 * state[:3] / distance**3])

    start = HEO.state(0.0)
    times = np.linspace(0.0, PERIOD_S, 5)
    found = solve_ivp(
        gravity,
        (0.0, PERIOD_S),
        np.concatenate([start.position_in_inertial, start.velocity_in_inertial]),
        "DOP853",
        times,
        rtol=1e-13,
        atol=1e-6,
    )
    for time_s, state in zip(times, found.y.T, strict=True):
        np.testing.assert_allclose(
            HEO.state(time_s).position_in_inertial, state[:3], atol=INTEGRATOR_M
        )


@given(orbits, st.floats(-1e4, 1e4))
def test_the_local_frame_stands_on_the_state(orbit: KeplerOrbit, time_s: float) -> None:
    axes = orbit.inertial_from_lvlh(time_s)
    state = orbit.state(time_s)
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    np.testing.assert_allclose(
        axes.T @ state.position_in_inertial,
        [orbit.radius_m(time_s), 0.0, 0.0],
        atol=ROUNDING * orbit.semi_major_axis_m,
    )
    velocity = axes.T @ state.velocity_in_inertial
    assert velocity[1] > 0.0
    assert velocity[2] == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize("time_s", [0.0, 900.0, 0.45 * PERIOD_S])
def test_rate_and_acceleration_are_derivatives_of_the_anomaly(time_s: float) -> None:
    step_s = 0.5
    before, after = time_s - step_s, time_s + step_s
    rate = (HEO.true_anomaly(after) - HEO.true_anomaly(before)) / (2.0 * step_s)
    assert HEO.anomaly_rate(time_s) == pytest.approx(rate, rel=1e-6)
    change = (HEO.anomaly_rate(after) - HEO.anomaly_rate(before)) / (2.0 * step_s)
    assert HEO.anomaly_acceleration(time_s) == pytest.approx(change, rel=1e-6)


def test_it_comes_back_after_a_revolution() -> None:
    assert HEO.true_anomaly(PERIOD_S) == pytest.approx(np.deg2rad(30.0), abs=1e-12)
    assert HEO.true_anomaly(0.0) == pytest.approx(np.deg2rad(30.0), abs=1e-15)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"e": 1.0}, r"elliptic orbit, eccentricity in \[0, 1\), got 1.0"),
        ({"a_km": -1.0}, "semi-major axis in m above zero"),
        ({"i_deg": float("nan")}, "finite inclination_rad"),
    ],
)
def test_what_is_no_ellipse_is_refused(change: dict[str, float], words: str) -> None:
    elements = {
        "a_km": 7000.0,
        "e": 0.1,
        "i_deg": 10.0,
        "raan_deg": 0.0,
        "argument_of_perigee_deg": 0.0,
        "true_anomaly_deg": 0.0,
    }
    with pytest.raises(ValueError, match=words):
        KeplerOrbit.from_elements_deg(**{**elements, **change})


@pytest.mark.parametrize(
    "velocity", [[0.0, 2e4, 0.0], [0.0, 0.0, 0.0], [1000.0, 0.0, 0.0]], ids=["away", "0", "down"]
)
def test_a_state_that_leaves_or_falls_is_refused(velocity: list[float]) -> None:
    state = ChaserState(0.0, np.array([7e6, 0.0, 0.0]), np.array(velocity))
    with pytest.raises(ValueError, match="state on an ellipse about Earth"):
        KeplerOrbit.from_state(state)
