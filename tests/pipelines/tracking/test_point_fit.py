"""The pose near a rough one: the peers' minimum, and the Cramer-Rao bound."""

from __future__ import annotations

import cv2
import numpy as np
import poselib
import pytest

from models.pose import RigidTransform, pose_error
from pipelines.chaser_fixed.options import options_for
from pipelines.pnp.covariance import pose_covariance
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.problem import PnpProblem
from pipelines.tracking.point_fit import PointFit, covariance_of, fit_points
from tests.support.point_targets import (
    CAMERA,
    any_pose,
    normalised_squared_error,
    seen_points,
    telescope_target,
)

TARGET = telescope_target()
POINTS = TARGET.points_in_target
SIGMA_PX = 2.0
GATE_PX = 4.0 * SIGMA_PX
SAME_MINIMUM_M, SAME_MINIMUM_DEG = 1e-6, 1e-5  # the last step is below 1e-6 and falls quadratically
PEER_M, PEER_DEG = 1e-5, 1e-4  # OpenCV stops at a relative step of 1e-7
RUNS = 300
# RMSE over the bound: chi2 with 6 * RUNS degrees of freedom, sqrt, at 3.3 sigmas.
EFFICIENCY = (1.0 - 3.3 / np.sqrt(2 * 6 * RUNS), 1.0 + 3.3 / np.sqrt(2 * 6 * RUNS))


def fitted(seed: int, outliers: int = 1) -> tuple[PointFit, RigidTransform, np.ndarray, np.ndarray]:
    rng = np.random.default_rng([31, seed])
    pose = any_pose(rng)
    points, landmark = seen_points(TARGET, pose, rng, SIGMA_PX, outliers)
    start = pose.perturbed(np.deg2rad(0.1) * rng.standard_normal(3), 0.02 * rng.standard_normal(3))
    fit = fit_points(points, POINTS, CAMERA, start, SIGMA_PX, 1.2 * GATE_PX, GATE_PX)
    assert isinstance(fit, PointFit), fit
    return fit, pose, points, landmark


def test_tracked_points_are_as_good_as_the_cramer_rao_bound() -> None:
    """A wrong association would show here: as errors that the bound knows nothing of."""
    squared = []
    for seed in range(RUNS):
        fit, pose, _, _ = fitted(seed)
        bound = covariance_of(pose, POINTS, CAMERA.fx, SIGMA_PX)
        assert bound is not None
        squared.append(normalised_squared_error(fit.pose, pose, bound))
        assert fit.rested
    ratio = float(np.sqrt(np.mean(squared) / 6.0))
    assert EFFICIENCY[0] < ratio < EFFICIENCY[1]


@pytest.mark.parametrize("seed", range(4))
def test_it_ends_where_the_peers_end(seed: int) -> None:
    fit, _, points, _ = fitted(seed)
    named = fit.matched >= 0
    known, seen = POINTS[fit.matched[named]], points[named]
    ours = solve_pose(
        PnpProblem.unweighted(CAMERA, known, seen), fit.pose, options_for("best").solver
    ).pose
    assert np.linalg.norm(ours.translation - fit.pose.translation) < SAME_MINIMUM_M
    assert pose_error(ours, fit.pose).attitude_deg < SAME_MINIMUM_DEG

    turn, _ = cv2.Rodrigues(fit.pose.rotation)
    shift = fit.pose.translation[:, None].copy()
    turn, shift = cv2.solvePnPRefineLM(known, seen, CAMERA.matrix, None, turn, shift)
    theirs = RigidTransform(cv2.Rodrigues(turn)[0], shift[:, 0])
    assert np.linalg.norm(theirs.translation - fit.pose.translation) < PEER_M
    assert pose_error(theirs, fit.pose).attitude_deg < PEER_DEG

    guess = poselib.CameraPose()
    guess.R, guess.t = fit.pose.rotation, fit.pose.translation
    pinhole = {"model": "SIMPLE_PINHOLE", "width": 2, "height": 2, "params": [1.0, 0.0, 0.0]}
    refined, _ = poselib.refine_absolute_pose(
        CAMERA.normalise(seen),
        known,
        guess,
        pinhole,
        {"loss_type": "TRIVIAL", "max_iterations": 100, "gradient_tol": 1e-14, "step_tol": 1e-14},
    )
    assert np.linalg.norm(refined.t - fit.pose.translation) < PEER_M


def test_its_covariance_is_that_of_the_weighted_problem() -> None:
    fit, _, points, _ = fitted(7)
    named = fit.matched >= 0
    each = np.broadcast_to(SIGMA_PX**2 * np.eye(2), (int(named.sum()), 2, 2))
    problem = PnpProblem.weighted(CAMERA, POINTS[fit.matched[named]], points[named], each)
    expected = pose_covariance(problem, fit.pose)
    assert expected is not None
    np.testing.assert_allclose(fit.covariance, expected, rtol=1e-5, atol=1e-16)


def test_matches_are_one_to_one_and_outliers_stay_out() -> None:
    wrong = right = 0
    for seed in range(40, 60):
        fit, _, _, landmark = fitted(seed, outliers=5)
        named = fit.matched[fit.matched >= 0]
        assert len(set(named)) == len(named)
        wrong += np.count_nonzero((fit.matched >= 0) & (fit.matched != landmark))
        right += np.count_nonzero((fit.matched >= 0) & (fit.matched == landmark))
    assert wrong < 0.03 * right  # crowded landmarks change places, clutter falls on some


def test_landmarks_not_shown_are_not_matched() -> None:
    rng = np.random.default_rng(32)
    pose = any_pose(rng)
    points, _ = seen_points(TARGET, pose, rng, SIGMA_PX, 0)
    shown = np.arange(6, 24)
    fit = fit_points(points, POINTS, CAMERA, pose, SIGMA_PX, GATE_PX, GATE_PX, shown=shown)
    assert isinstance(fit, PointFit)
    assert fit.matched[fit.matched >= 0].min() >= 6


def test_nothing_near_is_said_in_words() -> None:
    rng = np.random.default_rng(33)
    pose = any_pose(rng)
    points, _ = seen_points(TARGET, pose, rng, SIGMA_PX, 0)
    far = fit_points(points + 500.0, POINTS, CAMERA, pose, SIGMA_PX, GATE_PX, GATE_PX)
    assert isinstance(far, str)
    assert "match a landmark" in far


def test_points_in_a_line_determine_nothing() -> None:
    line = np.column_stack([np.linspace(-4.0, 4.0, 6), np.zeros(6), np.zeros(6)])
    pose = RigidTransform(np.eye(3), np.array([0.0, 0.0, 30.0]))
    fit = fit_points(CAMERA.project(pose @ line), line, CAMERA, pose, 1.0, 4.0, 4.0)
    assert isinstance(fit, str)
    assert "do not determine" in fit
    assert covariance_of(pose, line, CAMERA.fx, 1.0) is None
