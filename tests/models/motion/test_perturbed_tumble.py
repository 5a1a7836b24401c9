"""Two satellites in the real field: against J2 integrated apart, and laws of turning frames."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from models.gravity.field import MU_M3_S2
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.perturbed_orbit import Ball, lvlh_axes
from models.motion.perturbed_tumble import LocalFrameAttitude, PerturbedTumble
from models.motion.tumble import Tumble
from models.sky.sun_ephemeris import epoch_of

SPAN_S = 300.0
J2, RADIUS_M = 1.0826355e-3, 6_378_136.3
INERTIA = np.diag([7000.0, 129000.0, 131000.0])
RHO, RHO_DOT = (0.0, 30.0, 5.0), (0.0, 1e-3, -0.01)
OMEGA = np.deg2rad([1.0, 0.1, -0.2])
# Of 30 m in 300 s: C22 and other terms are a thousandth of J2, tides a tenth of a millimetre.
OTHER_TERMS_M = 1e-3
ORBIT = KeplerOrbit.from_elements_deg(
    a_km=7158.0, e=0.001, i_deg=98.5, raan_deg=40.0, argument_of_perigee_deg=10.0,
    true_anomaly_deg=70.0,
)  # fmt: skip


@pytest.fixture(scope="module")
def tumble() -> PerturbedTumble:
    ball = Ball(100.0, 1.28)
    return PerturbedTumble.from_start(
        epoch_of("2026-03-20T12:00:00Z"),
        ORBIT.state(0.0),
        rho0_m=RHO,
        rho_dot0_m_s=RHO_DOT,
        omega0_rad_s=OMEGA,
        inertia_kg_m2=INERTIA,
        R_lvlh_from_target=np.eye(3),
        duration_s=SPAN_S,
        chaser=ball,
        target=ball,
        degree=4,
    )


def oblate_slope(_: float, state: np.ndarray) -> np.ndarray:
    place, radius = state[:3], np.linalg.norm(state[:3])
    polar = (place[2] / radius) ** 2
    oblate = 1.5 * J2 * (RADIUS_M / radius) ** 2
    pull = place * np.array([5.0 * polar - 1.0] * 2 + [5.0 * polar - 3.0])
    return np.concatenate([state[3:], -MU_M3_S2 / radius**3 * (place - oblate * pull)])


def test_it_begins_where_it_is_told(tumble):
    start = tumble.state(0.0)
    np.testing.assert_allclose(start.rho_in_lvlh, RHO, atol=1e-6)
    np.testing.assert_allclose(start.rho_dot_in_lvlh, RHO_DOT, atol=1e-9)
    np.testing.assert_allclose(start.R_lvlh_from_target, np.eye(3), atol=1e-12)


def test_the_oblate_earth_draws_two_satellites_apart_as_another_integration_has_it(tumble):
    """And by more than the tolerance from where two-body motion would have them."""
    chaser = tumble.chaser_state(0.0)
    axes = lvlh_axes(chaser.position_in_inertial, chaser.velocity_in_inertial)
    begun = tumble.target.states(np.zeros(1))[0]
    ends = [
        solve_ivp(oblate_slope, (0.0, SPAN_S), each, method="LSODA", rtol=1e-12, atol=1e-8).y[:, -1]
        for each in (
            np.concatenate([chaser.position_in_inertial, chaser.velocity_in_inertial]),
            begun,
        )
    ]
    axes = lvlh_axes(ends[0][:3], ends[0][3:])
    expected = axes.T @ (ends[1][:3] - ends[0][:3])
    found = tumble.state(SPAN_S).rho_in_lvlh
    np.testing.assert_allclose(found, expected, atol=OTHER_TERMS_M)
    plain = Tumble(ORBIT, np.array(RHO), np.array(RHO_DOT), OMEGA, INERTIA, SPAN_S)
    assert np.linalg.norm(plain.state(SPAN_S).rho_in_lvlh - expected) > 5.0 * OTHER_TERMS_M


def test_rates_are_the_derivatives_of_places(tumble):
    """Central differences over 0.2 s: their error is of the third derivative, below 1e-7."""
    now_s, half_s = 150.0, 0.1
    before, now, after = (tumble.state(now_s + part * half_s) for part in (-1, 0, 1))
    slope = (after.rho_in_lvlh - before.rho_in_lvlh) / (2.0 * half_s)
    np.testing.assert_allclose(now.rho_dot_in_lvlh, slope, atol=1e-7)
    turned = Rotation.from_matrix(before.R_lvlh_from_target.T @ after.R_lvlh_from_target)
    np.testing.assert_allclose(
        now.omega_target_wrt_lvlh_in_target, turned.as_rotvec() / (2.0 * half_s), atol=1e-7
    )


def test_gyroscopes_of_the_local_frame_add_up_to_its_turn(tumble):
    attitude = LocalFrameAttitude(tumble.chaser)
    times_s = np.arange(0.0, 100.0, 0.1) + 0.05
    turns = Rotation.from_rotvec(0.1 * attitude.rates(times_s))
    whole = Rotation.identity()
    for turn in turns:
        whole = whole * turn
    ends = Rotation.from_quat(attitude.quaternions(np.array([0.0, 100.0])), scalar_first=True)
    off = (whole.inv() * (ends[0].inv() * ends[1])).magnitude()
    assert off < 1e-8  # rad, of 0.1 turned


@pytest.mark.parametrize(("end_s", "late_s"), [(0.0, -1.0), (SPAN_S, 1.0)])
def test_a_shutter_beside_the_motion_sees_it_go_on(tumble, end_s, late_s):
    """Before and after, the orbit is its own continuation, to the third order in time.

    The pull at the end is that of the velocities inside, by a difference of second order; in a
    second it moves the chaser by 4 m, its change by a millimetre.
    """
    states = [tumble.chaser_state(end_s - step * late_s) for step in range(3)]
    first, second, third = (state.velocity_in_inertial for state in states)
    pull = (1.5 * first - 2.0 * second + 0.5 * third) / late_s
    beside = tumble.chaser_state_beside(end_s + late_s)
    moved = beside.position_in_inertial - states[0].position_in_inertial
    np.testing.assert_allclose(moved, late_s * first + 0.5 * late_s**2 * pull, atol=3e-3)
    np.testing.assert_allclose(beside.velocity_in_inertial, first + late_s * pull, atol=1e-4)


def test_there_is_no_motion_beyond_its_end(tumble):
    with pytest.raises(ValueError, match="longer duration"):
        tumble.state(SPAN_S + 1.0)
