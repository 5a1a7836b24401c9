"""The published filter: its dynamics are the simulation's, and it is the size that is printed."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.suites.volpe2017.cases import published, states_of
from bench.suites.volpe2017.motion_errors import COLUMNS, motion_errors
from bench.suites.volpe2017.point_frames import camera_of, frames_of
from models.motion.boresight_pointing import HILL_FROM_LVLH, cam_from_hill
from models.spacecraft.simple_target import inertia_kg_m2, points_in_target
from pipelines.unknown_target.options import UnscentedOptions
from pipelines.unknown_target.paper_dynamics import (
    PaperState,
    observed,
    pointing,
    redundancy,
    step,
)
from pipelines.unknown_target.paper_filter import PaperFilter
from pipelines.unknown_target.target_estimate import of_filter
from tests.support.watched_target import SHORT, case, motion_start

LAYOUT = PaperState(12)
STEP_S = 2.0
RUNGE_KUTTA = 1e-6  # of sixty steps of 2 deg, m and 1


def true_state(state):
    pose, inertia = state.cam_from_target, inertia_kg_m2()
    found = np.zeros(LAYOUT.size)
    found[LAYOUT.from_chaser] = (pose @ points_in_target()).ravel()
    found[LAYOUT.from_centre] = points_in_target().ravel()
    found[LAYOUT.quaternion] = Rotation.from_matrix(pose.rotation).as_quat()
    found[LAYOUT.omega] = state.omega_in_target
    found[LAYOUT.rho] = HILL_FROM_LVLH @ state.rho_in_lvlh
    found[LAYOUT.rho_dot] = HILL_FROM_LVLH @ state.rho_dot_in_lvlh
    found[LAYOUT.inertia] = [*np.diag(inertia), 0.0, 0.0, 0.0]
    return found


def test_it_has_as_many_numbers_as_printed():
    assert LAYOUT.size == published()["paper"]["states"]


def test_the_dynamics_carry_the_truth_along():
    states = states_of(SHORT)
    carried = true_state(states[0])[None]
    for _ in range(60):
        carried = step(LAYOUT, carried, SHORT.orbit_rate, STEP_S)
    there = true_state(states[60])
    if there[LAYOUT.quaternion] @ carried[0, LAYOUT.quaternion] < 0.0:
        there[LAYOUT.quaternion] *= -1.0
    np.testing.assert_allclose(carried[0], there, atol=RUNGE_KUTTA)
    np.testing.assert_allclose(redundancy(LAYOUT, carried), 0.0, atol=RUNGE_KUTTA)


def test_what_is_observed_is_what_is_seen():
    state, camera = states_of(SHORT)[30], camera_of()
    found = observed(LAYOUT, true_state(state)[None], (camera.fx, camera.fy))[0]
    assert found[0] == pytest.approx(np.linalg.norm(state.rho_in_lvlh))
    true_px = camera.project(state.cam_from_target @ points_in_target())
    np.testing.assert_allclose(
        found[1:].reshape(-1, 2) + np.array([camera.cx, camera.cy]), true_px, atol=1e-7
    )


def test_the_camera_stands_and_turns_as_the_text_says():
    states, small_s = states_of(SHORT), 1e-3
    rho = HILL_FROM_LVLH @ states[10].rho_in_lvlh
    rho_dot = HILL_FROM_LVLH @ states[10].rho_dot_in_lvlh
    attitude, spin, distance, closing = pointing(rho[None], rho_dot[None])
    np.testing.assert_allclose(attitude[0], cam_from_hill(rho), atol=1e-12)
    later, before = (cam_from_hill(rho + sign * small_s * rho_dot) for sign in (1.0, -1.0))
    # A camera that turns by spin sees the frame turn the other way.
    turn = Rotation.from_matrix(before @ later.T).as_rotvec() / (2.0 * small_s)
    np.testing.assert_allclose(spin[0], turn, rtol=1e-5, atol=1e-10)
    assert closing[0] == pytest.approx(rho @ rho_dot / distance[0])


def test_shape_improves_and_the_inertias_scale_does_not():
    own = case(duration_s=300.0, step_s=2.0)
    found = PaperFilter(camera_of(), own.orbit_rate, motion_start(own), UnscentedOptions())
    rows = []
    for frame, state in frames_of(own, 0, 0):
        known = of_filter(found.add(frame))
        rows.append(motion_errors(known, state, own.points_in_target))
    errors = dict(zip(COLUMNS, np.array(rows).T, strict=True))
    assert errors["shape_m"][-1] < 0.3 * errors["shape_m"][0]
    scale = sum(errors[f"inertia_kg_m2_{k}"] for k in (1, 2, 3))
    assert abs(scale[-1]) > 0.5 * abs(scale[0])  # nothing tells it


def test_a_point_not_seen_and_a_range_not_read_are_not_measured():
    hidden = case(hidden_s=(40.0, 60.0), range_to="none", duration_s=80.0)
    found = PaperFilter(camera_of(), hidden.orbit_rate, motion_start(hidden), UnscentedOptions())
    spreads = []
    for frame, _ in frames_of(hidden, 0, 0):
        spreads.append(
            np.trace(found.add(frame).covariance[LAYOUT.from_chaser, LAYOUT.from_chaser])
        )
    assert spreads[29] > spreads[19]  # while nothing is seen
    assert spreads[-1] < spreads[29]
