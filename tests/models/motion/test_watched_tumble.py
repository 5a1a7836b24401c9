"""The truth of an unknown target: it turns as bodies do, and is looked at as the paper says."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.motion.boresight_pointing import HILL_FROM_LVLH, cam_from_hill, cam_from_lvlh
from models.motion.clohessy_wiltshire import mean_motion, propagate, state_on_inclined_ellipse
from models.motion.gravity_gradient_rotation import GravityGradientRotation, lvlh_from_first
from models.motion.rigid_body_rotation import RigidBodyRotation
from models.motion.watched_tumble import WatchedTumble
from models.spacecraft.simple_target import inertia_kg_m2

N = mean_motion(7.0e6)
OMEGA = np.deg2rad([0.3, 0.2, 0.5])
FIRST = Rotation.from_rotvec([0.3, -0.2, 0.9]).as_matrix()
INTEGRATED = 1e-8  # of what two integrations to 1e-12 differ over an hour


def tumble(duration_s=600.0):
    start = state_on_inclined_ellipse(N, 15.0, 20.0, 0.3)
    return WatchedTumble(7.0e6, start, OMEGA, inertia_kg_m2(), duration_s)


def test_without_a_gradient_it_is_a_free_body():
    ours = GravityGradientRotation(inertia_kg_m2(), OMEGA, FIRST, 0.0, 900.0)
    free = RigidBodyRotation(inertia_kg_m2(), OMEGA, FIRST, 900.0)
    for time_s in (0.0, 333.0, 900.0):
        np.testing.assert_allclose(ours.omega_at(time_s), free.omega_at(time_s), atol=1e-11)
        np.testing.assert_allclose(
            ours.lvlh_from_body(time_s), free.inertial_from_body(time_s), atol=INTEGRATED
        )


def test_the_jacobi_integral_is_kept():
    """T of the relative turning, with the potentials of gradient and orbit (Hughes, 9.1)."""
    inertia = inertia_kg_m2()
    body = GravityGradientRotation(inertia, OMEGA, FIRST, N, 3000.0)

    def integral(time_s):
        attitude = body.lvlh_from_body(time_s)
        radial, normal = attitude.T[:, 0], attitude.T[:, 2]
        relative = body.omega_at(time_s) - N * normal
        turning = 0.5 * relative @ inertia @ relative
        return turning + 0.5 * N**2 * (3.0 * radial @ inertia @ radial - normal @ inertia @ normal)

    assert integral(3000.0) == pytest.approx(integral(0.0), rel=1e-8)


def test_a_small_pitch_swings_at_the_rate_of_the_books():
    """About the normal, the long axis up: omega^2 = 3 n^2 (I_along - I_radial) / I_normal."""
    inertia = np.diag([400.0, 900.0, 1000.0])
    rate = N * np.sqrt(3.0 * (900.0 - 400.0) / 1000.0)
    small = 1e-4
    first = Rotation.from_rotvec([0.0, 0.0, small]).as_matrix()
    body = GravityGradientRotation(inertia, np.array([0.0, 0.0, N]), first, N, 5000.0)
    for time_s in (1000.0, 2500.0, 5000.0):
        pitch = Rotation.from_matrix(body.lvlh_from_body(time_s)).as_rotvec()
        assert pitch[2] == pytest.approx(small * np.cos(rate * time_s), abs=1e-3 * small)
        np.testing.assert_allclose(pitch[:2], 0.0, atol=1e-9)


def test_the_relative_orbit_closes_and_is_inclined():
    start = state_on_inclined_ellipse(N, 15.0, 20.0, 0.3)
    np.testing.assert_allclose(propagate(start, N, 2.0 * np.pi / N), start, atol=1e-9)
    places = np.array([propagate(start, N, t)[:3] for t in np.linspace(0.0, 5800.0, 200)])
    assert np.hypot(places[:, 0], places[:, 2]).min() > 10.0  # never along the track
    assert np.linalg.matrix_rank(places, tol=1e-6) == 2  # a plane, not the orbit's


def test_the_camera_looks_at_the_target_and_does_not_roll():
    motion = tumble()
    for time_s in (0.0, 200.0, 600.0):
        state = motion.state(time_s)
        pose = state.cam_from_target
        distance = np.linalg.norm(state.rho_in_lvlh)
        np.testing.assert_allclose(pose.translation, [0.0, 0.0, distance], atol=1e-9)
        right_in_hill = (HILL_FROM_LVLH @ state.R_cam_from_lvlh.T)[:, 0]
        assert right_in_hill[2] == pytest.approx(0.0, abs=1e-12)
        assert np.linalg.det(state.R_cam_from_lvlh) == pytest.approx(1.0)


def test_the_body_has_the_first_cameras_axes():
    np.testing.assert_allclose(tumble().state(0.0).cam_from_target.rotation, np.eye(3), atol=1e-12)


def test_a_chaser_straight_ahead_leaves_the_roll_open():
    with pytest.raises(ValueError, match="off the along-track axis"):
        cam_from_lvlh(np.array([0.0, 30.0, 0.0]))
    assert cam_from_hill(np.array([1.0, 0.0, 30.0])).shape == (3, 3)


def test_the_hill_frame_is_the_papers():
    """Axis 2 along the momentum, right-handed: axis 3 against the motion."""
    np.testing.assert_allclose(HILL_FROM_LVLH @ [0.0, 0.0, 1.0], [0.0, 1.0, 0.0])
    np.testing.assert_allclose(HILL_FROM_LVLH @ [0.0, 1.0, 0.0], [0.0, 0.0, -1.0])
    assert np.linalg.det(HILL_FROM_LVLH) == pytest.approx(1.0)
    np.testing.assert_allclose(lvlh_from_first(0.5 * np.pi) @ [0.0, 1.0, 0.0], [1.0, 0.0, 0.0],
                               atol=1e-12)  # fmt: skip
