"""A camera whose attitude is known with an error: what it does to a measured pose."""

import numpy as np
from scipy.spatial.transform import Rotation

from models.motion.tumble import CAM_FROM_LVLH
from models.pose import RigidTransform
from pipelines.filters.camera_mount import CameraMount

DRAWS = 1000
# Of a variance of so many draws, four of its standard errors.
SAMPLING = 4.0 * np.sqrt(2.0 / DRAWS)
POSE = RigidTransform(Rotation.from_euler("xyz", [20.0, -40.0, 70.0], degrees=True).as_matrix(),
                      np.array([2.0, -1.0, 30.0]))  # fmt: skip
SIGMAS_RAD = 1e-4 * np.array([1.0, 2.0, 0.5])


def test_noise_of_the_attitude_is_what_draws_of_it_scatter_by():
    exact = np.zeros((6, 6))
    told = CameraMount(CAM_FROM_LVLH, np.diag(SIGMAS_RAD**2)).measured(POSE, exact)
    rng = np.random.default_rng(3)
    places, turns = [], []
    for draw in SIGMAS_RAD * rng.standard_normal((DRAWS, 3)):
        turned = RigidTransform(Rotation.from_rotvec(draw).as_matrix(), np.zeros(3))
        off = CameraMount(turned @ CAM_FROM_LVLH).measured(POSE, exact)
        places.append(off[0] - told[0])
        turns.append(Rotation.from_matrix(told[2].T @ off[2]).as_rotvec())
    for noise, drawn in ((told[1], places), (told[3], turns)):
        sampled = np.cov(np.array(drawn).T, bias=True)
        scale = np.sqrt(np.outer(np.diag(sampled), np.diag(sampled)))
        assert np.abs((noise - sampled) / scale).max() < SAMPLING


def test_an_exact_attitude_adds_nothing():
    covariance = np.diag([1e-6, 2e-6, 3e-6, 1e-4, 2e-4, 3e-4])
    place, place_noise, attitude, turn_noise = CameraMount(CAM_FROM_LVLH).measured(POSE, covariance)
    lvlh_from_target = CAM_FROM_LVLH.inverse() @ POSE
    np.testing.assert_allclose(place, lvlh_from_target.translation)
    np.testing.assert_allclose(attitude, lvlh_from_target.rotation)
    np.testing.assert_allclose(np.linalg.eigvalsh(place_noise), [1e-4, 2e-4, 3e-4])
    np.testing.assert_allclose(np.linalg.eigvalsh(turn_noise), [1e-6, 2e-6, 3e-6])
