"""Errors that all points share: the best linear estimate, its covariance, and no false outliers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from models.arrays import Floats
from models.camera import Camera
from models.pose import RigidTransform
from pipelines.chaser_fixed.options import options_for
from pipelines.pnp.consistency import common_variance_px2, deletion_gains, find_outliers
from pipelines.pnp.covariance import pose_covariance, pose_scatter
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.problem import PnpProblem
from pipelines.pnp.told_errors import CALIBRATION, calibration_errors_px
from tests.support.synthetic_pair import CAMERA_2048, PATTERN, facing_pose

CAMERA = replace(CAMERA_2048, k1=-0.05, p1=1e-3)
POINTS = PATTERN.points_in_target
POSE = facing_pose(3.0, (179.0, 1.5, -2.0))
SIGMAS = {f"camera.{key}": 1.0 for key in ("fx", "fy", "cx", "cy")} | {"camera.k1": 5e-4}
NOISE_PX = 0.01
OWN = np.broadcast_to(NOISE_PX**2 * np.eye(2), (len(POINTS), 2, 2))
SOLVER = options_for("best").solver
RUNS = 300
# A mean over 300 runs of a NEES of six: its own 99.9 % interval.
HONEST = (
    chi2.ppf(0.0005, 6 * RUNS) / (6 * RUNS),
    chi2.ppf(0.9995, 6 * RUNS) / (6 * RUNS),
)


def told_wrong(rng: np.random.Generator) -> Camera:
    """Return the camera as a calibration of ``SIGMAS`` has it."""
    return replace(
        CAMERA,
        **{
            key: getattr(CAMERA, key) + SIGMAS.get(f"camera.{key}", 0.0) * rng.standard_normal()
            for key in CALIBRATION
        },
    )


def problem_of(camera: Camera, pixels: Floats, shared: bool) -> PnpProblem:
    """Return the problem by a told camera, its errors known as shared or left out."""
    common = calibration_errors_px(camera, camera.normalise(pixels), SIGMAS) if shared else None
    return PnpProblem.weighted(camera, POINTS, pixels, OWN, common)


def drawn(rng: np.random.Generator, shared: bool) -> tuple[PnpProblem, RigidTransform]:
    """Return a run's problem, and its solution."""
    pixels = CAMERA.project(POSE @ POINTS) + NOISE_PX * rng.standard_normal((len(POINTS), 2))
    problem = problem_of(told_wrong(rng), pixels, shared)
    return problem, solve_pose(problem, POSE, SOLVER).pose


def error_of(pose: RigidTransform) -> Floats:
    """Return a pose's error, (6,), rad and m."""
    turn = Rotation.from_matrix(pose.rotation @ POSE.rotation.T).as_rotvec()
    return np.array([*turn, *(pose.translation - POSE.translation)])


@pytest.mark.parametrize("key", CALIBRATION)
def test_what_a_calibration_does_is_what_a_camera_told_otherwise_sees(key: str) -> None:
    """The projection is linear in each number: a step of any size tells its slope."""
    in_cam = POSE @ POINTS
    step = 1e-4
    other = replace(CAMERA, **{key: getattr(CAMERA, key) + step})
    moved = (other.project(in_cam) - CAMERA.project(in_cam)) / step
    found = calibration_errors_px(CAMERA, in_cam[:, :2] / in_cam[:, 2:], {f"camera.{key}": 1.0})
    assert found is not None
    assert found[..., 0] == pytest.approx(moved, abs=1e-6 * np.abs(moved).max())


def test_weighed_together_poses_are_nearer_and_their_covariance_is_honest() -> None:
    """Least squares with the whole covariance is the best of all linear estimates (Aitken 1935)."""
    squares = {shared: np.zeros(6) for shared in (False, True)}
    nees = []
    for run in range(RUNS):
        for shared in squares:
            problem, pose = drawn(np.random.default_rng(run), shared)
            error = error_of(pose)
            squares[shared] += error**2
            if shared:
                covariance = pose_covariance(problem, pose)
                assert covariance is not None
                nees.append(error @ np.linalg.solve(covariance, error))
    assert (squares[True] < squares[False]).all()
    assert squares[True][0] < 0.5 * squares[False][0]  # a turn that fx and fy apart pretend
    assert HONEST[0] < np.mean(nees) / 6.0 < HONEST[1]


def test_a_marker_is_no_outlier_for_what_the_calibration_does_to_all() -> None:
    apart, together = 0, 0
    for run in range(40):
        apart += find_outliers(*drawn(np.random.default_rng(run), shared=False), 5.5, SOLVER) != ()
        together += (
            find_outliers(*drawn(np.random.default_rng(run), shared=True), 5.5, SOLVER) != ()
        )
    assert together == 0 < apart


def test_a_marker_that_is_wrong_is_named_all_the_same() -> None:
    for run in range(10):
        rng = np.random.default_rng(run)
        pixels = CAMERA.project(POSE @ POINTS) + NOISE_PX * rng.standard_normal((len(POINTS), 2))
        pixels[run] += [0.6, -0.4]
        problem = problem_of(told_wrong(rng), pixels, shared=True)
        pose = solve_pose(problem, POSE, SOLVER).pose
        assert find_outliers(problem, pose, 5.5, SOLVER) == (run,)


def test_what_leaving_a_match_out_gains_is_what_solving_without_it_tells() -> None:
    problem, pose = drawn(np.random.default_rng(4), shared=True)
    total = float((problem.residuals(pose.rotation, pose.translation) ** 2).sum())
    for (index,), gain in deletion_gains(problem, pose, 1).items():
        keep = np.arange(len(POINTS)) != index
        without = solve_pose(problem.subset(keep), pose, SOLVER).chi2
        assert gain == pytest.approx(total - without, rel=1e-3, abs=1e-3)


def test_scatter_is_how_poses_of_one_calibration_differ() -> None:
    rng = np.random.default_rng(9)
    camera = told_wrong(rng)
    exact = CAMERA.project(POSE @ POINTS)
    errors = []
    for _ in range(RUNS):
        pixels = exact + NOISE_PX * rng.standard_normal(exact.shape)
        problem = problem_of(camera, pixels, shared=True)
        errors.append(error_of(solve_pose(problem, POSE, SOLVER).pose))
    problem = problem_of(camera, exact, shared=True)
    covariance = pose_covariance(problem, POSE)
    assert covariance is not None
    scatter = pose_scatter(problem, POSE, covariance)
    off = np.array(errors) - np.mean(errors, axis=0)
    squares = np.einsum("ra,ab,rb->r", off, np.linalg.inv(scatter), off)
    assert HONEST[0] < squares.mean() / 6.0 < HONEST[1]
    assert (np.diag(scatter) < np.diag(covariance)).all()


def test_residuals_that_a_calibration_explains_need_no_widening() -> None:
    rng = np.random.default_rng(6)
    pixels = CAMERA.project(POSE @ POINTS) + NOISE_PX * rng.standard_normal((len(POINTS), 2))
    camera = told_wrong(rng)
    common = calibration_errors_px(camera, camera.normalise(pixels), SIGMAS)
    pose = solve_pose(problem_of(camera, pixels, shared=True), POSE, SOLVER).pose
    left = pixels - camera.project(pose @ POINTS)
    assert common_variance_px2(left, OWN, common) == 0.0
    assert common_variance_px2(left, OWN) > NOISE_PX**2
