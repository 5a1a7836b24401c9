from __future__ import annotations

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.camera import camera_preset
from models.motion.prior import draw_prior
from models.pose import RigidTransform
from models.spacecraft.grasp_markers import GRASP_MARKERS
from pipelines.eye_in_hand.options import BEST
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.match import Match
from pipelines.pnp.predicted_pose import PredictedPose
from pipelines.pnp.problem import PnpProblem
from pipelines.pnp.three_points import FittingPose, poses_of_three
from tests.support.synthetic_dots import facing

CAMERA = camera_preset("eye_in_hand")
SIGMA_PX = 0.05
PRIOR_M, PRIOR_DEG = np.full(3, 0.010), np.full(3, 0.667)  # Opromolla et al. 2022, Table 5
PEER_RAD, PEER_M = 1e-6, 1e-6  # two least-squares solvers of the same six equations


def match_at(pose: RigidTransform, seed: int = 0, sigma_px: float = SIGMA_PX) -> Match:
    rng = np.random.default_rng(seed)
    pixels = CAMERA.project(pose @ GRASP_MARKERS.points_in_target)
    noisy = pixels + sigma_px * rng.standard_normal((3, 2))
    each = np.broadcast_to(SIGMA_PX**2 * np.eye(2), (3, 2, 2))
    return Match(noisy, each, np.arange(3))


def predicted_from(pose: RigidTransform, seed: int, times: float = 1.0) -> PredictedPose:
    """Return a prior of Table 5, wrong by so many times what it says it is."""
    drawn = draw_prior(pose, times * PRIOR_M, times * PRIOR_DEG, np.random.default_rng(seed))
    sigma = np.concatenate([np.deg2rad(PRIOR_DEG), PRIOR_M])
    return PredictedPose(drawn, np.diag((times * sigma) ** 2), 0)


def fits_at(pose: RigidTransform, seed: int = 0, times: float = 1.0) -> list[FittingPose]:
    predicted = predicted_from(pose, seed, times)
    return poses_of_three(CAMERA, GRASP_MARKERS, match_at(pose, seed), predicted, BEST.solver)


@pytest.mark.parametrize("range_m", [1.4, 0.8, 0.4])
def test_the_right_pose_is_first_and_the_others_fit_as_well(range_m: float) -> None:
    pose = facing(range_m, [3.0, -2.0, 4.0], (0.01, 0.0))
    fits = fits_at(pose)
    assert len(fits) >= 2
    for each in fits:  # six numbers, six unknowns: all of them explain the dots
        left = CAMERA.project(each.pose @ GRASP_MARKERS.points_in_target)
        assert np.abs(left - match_at(pose).points_px).max() < 1e-3
    turn = Rotation.from_matrix(fits[0].pose.rotation @ pose.rotation.T).magnitude()
    assert np.rad2deg(turn) < 0.1
    assert fits[1].squared_distance - fits[0].squared_distance > BEST.decisive_chi2


@pytest.mark.parametrize("times", [1.0, 4.0])
def test_no_prior_of_table_5_nor_four_times_as_wide_chooses_the_wrong_pose(times: float) -> None:
    rng = np.random.default_rng(5)
    chosen = 0
    for seed in range(150):
        pose = facing(rng.uniform(0.4, 1.4), rng.normal(0.0, 4.0, 3).tolist())
        fits = fits_at(pose, seed, times)
        lead = fits[1].squared_distance - fits[0].squared_distance if len(fits) > 1 else np.inf
        if lead < BEST.decisive_chi2:
            continue  # said to be ambiguous, which is not wrong
        chosen += 1
        turn = Rotation.from_matrix(fits[0].pose.rotation @ pose.rotation.T).magnitude()
        assert np.rad2deg(turn) < 2.0
    assert chosen == 150


def test_solves_as_opencv_does() -> None:
    pose = facing(0.9, [5.0, 3.0, -6.0])
    match = match_at(pose, seed=4)
    points = GRASP_MARKERS.points_in_target
    problem = PnpProblem.weighted(CAMERA, points, match.points_px, match.covariance_px2)
    ours = solve_pose(problem, pose.perturbed([0.01, -0.01, 0.02], [0.01, 0.0, 0.02]), BEST.solver)
    start = pose.perturbed([0.01, -0.01, 0.02], [0.01, 0.0, 0.02])
    turn, shift = cv2.solvePnPRefineLM(
        points[:, None],
        CAMERA.normalise(match.points_px)[:, None],
        np.eye(3),
        None,
        Rotation.from_matrix(start.rotation).as_rotvec()[:, None],
        start.translation[:, None].copy(),
        (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 200, 1e-16),
    )
    theirs = Rotation.from_rotvec(np.ravel(turn))
    apart = (theirs * Rotation.from_matrix(ours.pose.rotation).inv()).magnitude()
    assert apart < PEER_RAD
    assert np.ravel(shift) == pytest.approx(ours.pose.translation, abs=PEER_M)


def test_dots_that_no_pose_fits_near_the_camera_give_an_empty_list_or_other_poses() -> None:
    pose = facing(0.9, [0.0, 0.0, 0.0])
    match = match_at(pose)
    swapped = Match(match.points_px[[1, 0, 2]], match.covariance_px2, match.marker)
    predicted = predicted_from(pose, 1)
    fits = poses_of_three(CAMERA, GRASP_MARKERS, swapped, predicted, BEST.solver)
    assert all(each.squared_distance > BEST.farthest_chi2 for each in fits)
