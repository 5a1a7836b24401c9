"""The recursive bound against the batch that it stands for, and a filter that meets it."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.scoring.pairs.cramer_rao import pose_bound
from bench.suites.pesce2019.cases import case, tumble_of
from bench.suites.pesce2019.filter_bound import (
    BoundTask,
    bound,
    inertial_rate,
    pose_information,
    transition,
)
from bench.suites.pesce2019.plan import start_errors
from models.camera import camera_preset
from models.motion.tumble import CAM_FROM_LVLH, Tumble
from models.spacecraft.wireframes import wireframe_by_name

CAMERA, TARGET = camera_preset("chaser_fixed"), wireframe_by_name("xmm")
STEP_S = 1.0
SMALL_RAD, SMALL_RAD_S = 1e-6, 1e-8
# Half a step's change of a rate of 1 deg/s, in the middle of which the flow is taken.
LINEAR = 1e-4


def task(frames=30, key="3", sigma_px=2.0):
    return BoundTask(case(key), "chaser_fixed", sigma_px, start_errors(case(key)), frames, 1.0)


def perturbed(tumble: Tumble, at_s: float, turn, rate) -> Tumble:
    """Return the tumble from a moment on, its attitude and inertial rate a little other."""
    state = tumble.state(at_s)
    orbit = tumble.orbit
    later = type(orbit)(
        orbit.semi_major_axis_m, orbit.eccentricity, orbit.inclination_rad, orbit.raan_rad,
        orbit.argument_of_perigee_rad, orbit.true_anomaly(at_s),
    )  # fmt: skip
    return Tumble(
        later,
        state.rho_in_lvlh,
        state.rho_dot_in_lvlh,
        inertial_rate(tumble, at_s) + rate,
        tumble.inertia_kg_m2,
        10.0,
        state.R_lvlh_from_target @ Rotation.from_rotvec(turn).as_matrix(),
    )


@pytest.mark.parametrize("key", ["2", "3", "4"])
def test_small_errors_go_where_the_true_motion_takes_them(key):
    tumble, at_s = tumble_of(case(key), 100.0), 40.0
    carried = transition(tumble, at_s, at_s + STEP_S)[6:, 6:]
    plain = perturbed(tumble, at_s, np.zeros(3), np.zeros(3)).state(STEP_S)
    for axis in range(6):
        small = np.zeros(6)
        small[axis] = SMALL_RAD if axis < 3 else SMALL_RAD_S
        moved = perturbed(tumble, at_s, small[:3], small[3:])
        there = moved.state(STEP_S)
        turn = Rotation.from_matrix(
            plain.R_lvlh_from_target.T @ there.R_lvlh_from_target
        ).as_rotvec()
        still = perturbed(tumble, at_s, np.zeros(3), np.zeros(3))
        rate = inertial_rate(moved, STEP_S) - inertial_rate(still, STEP_S)
        expected = carried @ small
        scale = np.abs(expected).max()
        np.testing.assert_allclose(turn, expected[:3], atol=LINEAR * scale)
        np.testing.assert_allclose(rate, expected[3:], atol=LINEAR * scale)


def test_one_image_tells_what_its_pose_bound_says():
    """In rotated axes, the information is the same."""
    tumble = tumble_of(case("3"), 100.0)
    pose = tumble.cam_from_target(30.0)
    smallest = pose_bound(CAMERA, TARGET.points_in_target, pose, [2.0, 2.0])
    seen = np.linalg.inv(pose_information(tumble, TARGET, CAMERA, 2.0, 30.0))
    position = CAM_FROM_LVLH.rotation @ seen[:3, :3] @ CAM_FROM_LVLH.rotation.T
    attitude = pose.rotation @ seen[3:, 3:] @ pose.rotation.T
    np.testing.assert_allclose(position, smallest[3:, 3:], rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(attitude, smallest[:3, :3], rtol=1e-6, atol=1e-14)


def test_the_recursion_is_the_batch():
    """All images' information, carried to the end, inverted once."""
    own = task(frames=25)
    tumble = tumble_of(own.case, 24.0)
    start = np.repeat(
        [own.start.sigma_m, 0.02, own.start.sigma_rad, np.deg2rad(2.0)], 3
    )  # START_M_S, START_DEG_S
    information = np.diag(start**-2.0)
    for frame in range(own.frames):
        if frame > 0:
            back = np.linalg.inv(transition(tumble, frame - 1.0, float(frame)))
            information = back.T @ information @ back
        seen = pose_information(tumble, TARGET, CAMERA, own.sigma_px, float(frame))
        rows = np.r_[0:3, 6:9]
        information[np.ix_(rows, rows)] += seen
    covariance = np.linalg.inv(information)
    found = bound(own).values
    assert found["position_m"][-1] == pytest.approx(np.sqrt(np.trace(covariance[:3, :3])), rel=1e-4)
    assert found["attitude_deg"][-1] == pytest.approx(
        np.rad2deg(np.sqrt(np.trace(covariance[6:9, 6:9]))), rel=1e-4
    )


def test_a_filter_knows_more_than_an_image_and_more_with_every_image():
    found = bound(task(frames=40)).values
    for name in ("position_m", "attitude_deg"):
        assert (found[name] <= found[f"raw_{name}"]).all()
    assert found["position_m"][-1] < 0.5 * found["raw_position_m"][-1]
    assert (np.diff(found["velocity_m_s"]) < 0.0).all()


def test_the_bound_is_proportional_to_the_noise_once_the_start_is_forgotten():
    two, four = (bound(task(frames=60, sigma_px=sigma)).values for sigma in (2.0, 4.0))
    assert four["raw_position_m"][5] == pytest.approx(2.0 * two["raw_position_m"][5], rel=1e-5)
    # What is left of the start after 60 images: a part in its information ratio.
    assert four["position_m"][-1] == pytest.approx(2.0 * two["position_m"][-1], rel=0.05)


def test_an_honest_filter_of_linear_errors_meets_the_bound():
    """Draw starts and images from the bound's own model and filter them: NEES and size agree."""
    own, runs = task(frames=20), 400
    tumble = tumble_of(own.case, 19.0)
    rng = np.random.default_rng(0)
    sigmas = np.repeat([own.start.sigma_m, 0.02, own.start.sigma_rad, np.deg2rad(2.0)], 3)
    errors = rng.normal(size=(runs, 12)) * sigmas
    covariance = np.diag(sigmas**2)
    seen_rows = np.r_[0:3, 6:9]
    for frame in range(own.frames):
        if frame > 0:
            carried = transition(tumble, frame - 1.0, float(frame))
            errors, covariance = errors @ carried.T, carried @ covariance @ carried.T
        noise = np.linalg.inv(pose_information(tumble, TARGET, CAMERA, 2.0, float(frame)))
        drawn = rng.multivariate_normal(np.zeros(6), noise, runs)
        gain = covariance[:, seen_rows] @ np.linalg.inv(
            covariance[np.ix_(seen_rows, seen_rows)] + noise
        )
        errors = errors - (errors[:, seen_rows] + drawn) @ gain.T
        covariance = covariance - gain @ covariance[seen_rows]
    size = np.sqrt(np.mean(np.sum(errors[:, :3] ** 2, axis=1)))
    # A root mean square over n runs of three numbers: relative deviation 1 / sqrt(6 n).
    assert bound(own).values["position_m"][-1] == pytest.approx(size, rel=4.0 / np.sqrt(6 * runs))
