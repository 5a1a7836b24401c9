from __future__ import annotations

import pickle

import numpy as np
import pytest

from models.motion.chaser_navigation import SIGMA_M, SIGMA_M_S, corrupted
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.tumble import CAM_FROM_LVLH, Tumble

XMM = [[7052.0, -820.0, -3991.0], [-820.0, 129129.0, 0.0], [-3991.0, 0.0, 131196.0]]
LEO = KeplerOrbit.from_elements_deg(
    a_km=7143.1,
    e=1.4e-4,
    i_deg=98.2,
    raan_deg=79.2,
    argument_of_perigee_deg=85.9,
    true_anomaly_deg=0.0,
)
DURATION_S = 600.0


def case_3(duration_s: float = DURATION_S) -> Tumble:
    return Tumble.from_case(
        LEO,
        rho0_m=[0.0, 30.0, 0.0],
        rho_dot0_m_s=[0.0, 1e-4, 0.0],
        omega_t0_deg_s=[0.5, -0.3, 0.2],
        inertia_kg_m2=XMM,
        duration_s=duration_s,
    )


@pytest.fixture(scope="module")
def tumble() -> Tumble:
    return case_3()


def test_it_starts_as_the_table_says(tumble: Tumble) -> None:
    start = tumble.state(0.0)
    np.testing.assert_array_equal(start.rho_in_lvlh, [0.0, 30.0, 0.0])
    np.testing.assert_array_equal(start.rho_dot_in_lvlh, [0.0, 1e-4, 0.0])
    np.testing.assert_allclose(start.R_lvlh_from_target, np.eye(3), atol=1e-14)
    # Table 4's rate is inertial; relative to the local frame, its turning about +z is less.
    inertial = start.omega_target_wrt_lvlh_in_target + np.array([0.0, 0.0, LEO.anomaly_rate(0.0)])
    np.testing.assert_allclose(np.rad2deg(inertial), [0.5, -0.3, 0.2], atol=1e-14)


@pytest.mark.parametrize("time_s", [1.0, 250.0, 599.0])
def test_the_rates_are_derivatives(tumble: Tumble, time_s: float) -> None:
    step_s = 1e-2
    before, now, after = (tumble.state(time_s + s) for s in (-step_s, 0.0, step_s))
    turning = now.R_lvlh_from_target.T @ (after.R_lvlh_from_target - before.R_lvlh_from_target)
    skew = turning / (2.0 * step_s)
    omega = [skew[2, 1], skew[0, 2], skew[1, 0]]
    np.testing.assert_allclose(now.omega_target_wrt_lvlh_in_target, omega, atol=1e-10)
    moving = (after.rho_in_lvlh - before.rho_in_lvlh) / (2.0 * step_s)
    np.testing.assert_allclose(now.rho_dot_in_lvlh, moving, atol=1e-10)


def test_the_relative_rate_is_not_constant(tumble: Tumble) -> None:
    """What equation 10 leaves out, and its process noise must make up for."""
    first, last = (tumble.state(t).omega_target_wrt_lvlh_in_target for t in (0.0, DURATION_S))
    assert np.rad2deg(np.linalg.norm(last - first)) > 0.2


def test_a_target_that_does_not_turn_keeps_its_attitude_among_the_stars() -> None:
    still = Tumble(
        LEO, np.array([0.0, 30.0, 0.0]), np.zeros(3), np.zeros(3), np.array(XMM), DURATION_S
    )
    first = LEO.inertial_from_lvlh(0.0)
    for time_s in (100.0, DURATION_S):
        now = LEO.inertial_from_lvlh(time_s) @ still.state(time_s).R_lvlh_from_target
        np.testing.assert_allclose(now, first, atol=1e-12)


def test_the_camera_looks_along_track_with_nadir_down(tumble: Tumble) -> None:
    pose = tumble.cam_from_target(0.0)
    np.testing.assert_allclose(pose.translation, [0.0, 0.0, 30.0], atol=1e-12)
    np.testing.assert_array_equal(CAM_FROM_LVLH.rotate([0.0, 1.0, 0.0]), [0.0, 0.0, 1.0])
    np.testing.assert_array_equal(CAM_FROM_LVLH.rotate([-1.0, 0.0, 0.0]), [0.0, 1.0, 0.0])
    np.testing.assert_array_equal(CAM_FROM_LVLH.rotate([0.0, 0.0, -1.0]), [1.0, 0.0, 0.0])


def test_a_state_depends_on_its_time_alone(tumble: Tumble) -> None:
    """Whatever was asked before, in whatever process: suites must not depend on their workers."""
    wanted = tumble.state(321.0)
    other = pickle.loads(pickle.dumps(case_3()))
    other.state(DURATION_S)
    for again in (other.state(321.0), case_3().state(321.0)):
        np.testing.assert_array_equal(again.rho_in_lvlh, wanted.rho_in_lvlh)
        np.testing.assert_array_equal(again.R_lvlh_from_target, wanted.R_lvlh_from_target)


def test_a_longer_tumble_begins_the_same(tumble: Tumble) -> None:
    ours, longer = tumble.state(500.0), case_3(1800.0).state(500.0)
    np.testing.assert_allclose(ours.rho_in_lvlh, longer.rho_in_lvlh, atol=1e-9)
    np.testing.assert_allclose(ours.R_lvlh_from_target, longer.R_lvlh_from_target, atol=1e-9)


@pytest.mark.parametrize("time_s", [-1.0, DURATION_S + 1.0, float("nan")])
def test_a_time_outside_is_refused(tumble: Tumble, time_s: float) -> None:
    with pytest.raises(ValueError, match=r"time between 0 and 600\.0 s"):
        tumble.state(time_s)


def test_the_last_frame_may_be_counted_in_tenths(tumble: Tumble) -> None:
    assert tumble.state(sum([0.1] * 6000)).time_s == DURATION_S


def test_bad_cases_are_refused() -> None:
    with pytest.raises(ValueError, match="duration in s above zero"):
        case_3(0.0)
    with pytest.raises(ValueError, match="three finite numbers as rho0_in_lvlh"):
        Tumble(LEO, np.zeros(2), np.zeros(3), np.zeros(3), np.array(XMM), 1.0)


def test_chaser_noise_is_keyed_by_run_and_frame_and_has_its_sigmas(tumble: Tumble) -> None:
    truth = tumble.chaser_state(10.0)
    one = corrupted(truth, seed=1, run=2, frame=3)
    same = corrupted(truth, seed=1, run=2, frame=3)
    np.testing.assert_array_equal(one.position_in_inertial, same.position_in_inertial)
    for seed, run, frame in ((1, 2, 4), (1, 3, 3), (2, 2, 3)):
        other = corrupted(truth, seed=seed, run=run, frame=frame)
        assert not np.array_equal(one.position_in_inertial, other.position_in_inertial)
    drawn = [corrupted(truth, seed=0, run=0, frame=frame) for frame in range(1000)]
    place = np.array([d.position_in_inertial for d in drawn]) - truth.position_in_inertial
    speed = np.array([d.velocity_in_inertial for d in drawn]) - truth.velocity_in_inertial
    spread = 4.0 / np.sqrt(2.0 * place.size)  # relative, of a standard deviation: four sigmas
    assert place.std() == pytest.approx(SIGMA_M, rel=spread)
    assert speed.std() == pytest.approx(SIGMA_M_S, rel=spread)
