"""Many poses at once against the solver that takes one."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from models.pose import RigidTransform
from pipelines.chaser_fixed.options import options_for
from pipelines.pnp.gauss_newton import gauss_newton_step, linearised, turned_by
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.problem import PnpProblem
from pipelines.pnp.projection_jacobian import jacobian_by_turn, project_normalised
from tests.support.point_targets import CAMERA, any_pose, telescope_target

POINTS = telescope_target().points_in_target
ROUNDING = 1e-12
SAME_MINIMUM = 1e-9


def poses(count: int) -> list[RigidTransform]:
    return [any_pose(np.random.default_rng([1, seed])) for seed in range(count)]


def stacked(some: list[RigidTransform]) -> tuple[np.ndarray, np.ndarray]:
    return np.array([p.rotation for p in some]), np.array([p.translation for p in some])


def test_projection_and_derivatives_are_those_of_one_pose() -> None:
    some = poses(5)
    predicted, jacobian = linearised(*stacked(some), POINTS)
    for index, pose in enumerate(some):
        one = project_normalised(pose.rotation, pose.translation, POINTS)
        slopes = jacobian_by_turn(pose.rotation, pose.translation, POINTS)
        np.testing.assert_allclose(predicted[index].T, one, atol=ROUNDING)
        np.testing.assert_allclose(jacobian[index].transpose(2, 1, 0), slopes, atol=ROUNDING)


def test_turns_are_those_of_the_exponential_map() -> None:
    turns = np.array([[0.0, 0.0, 0.0], [1e-6, 0.0, -1e-6], [0.3, -0.5, 0.7], [0.0, 3.0, 0.0]])
    expected = Rotation.from_rotvec(turns).as_matrix()
    given = turned_by(np.broadcast_to(np.eye(3), (4, 3, 3)), turns)
    np.testing.assert_allclose(given, expected, atol=ROUNDING)


def test_steps_end_at_the_minimum_of_levenberg_marquardt() -> None:
    some = poses(4)
    rng = np.random.default_rng(2)
    observed = []
    for pose in some:
        pixels = CAMERA.project(pose @ POINTS)
        observed.append(CAMERA.normalise(pixels + rng.standard_normal(pixels.shape)))
    seen = np.array(observed)
    weights = (rng.random((4, len(POINTS))) > 0.3).astype(np.float64)
    started = [
        p.perturbed(0.01 * rng.standard_normal(3), 0.1 * rng.standard_normal(3)) for p in some
    ]
    rotations, translations = stacked(started)
    for _ in range(8):
        rotations, translations, moved = gauss_newton_step(
            rotations,
            translations,
            linearised(rotations, translations, POINTS),
            seen.transpose(0, 2, 1),
            weights,
        )
        assert moved.all()
    for index, start in enumerate(started):
        kept = weights[index] > 0
        identity = np.broadcast_to(np.eye(2), (int(kept.sum()), 2, 2))
        problem = PnpProblem(POINTS[kept], seen[index][kept], identity)
        alone = solve_pose(problem, start, options_for("best").solver).pose
        np.testing.assert_allclose(rotations[index], alone.rotation, atol=SAME_MINIMUM)
        np.testing.assert_allclose(translations[index], alone.translation, rtol=1e-7, atol=1e-7)


def test_points_that_determine_nothing_leave_the_pose() -> None:
    rotations, translations = stacked(poses(1))
    nothing = np.zeros((1, len(POINTS)))
    observed = np.zeros((1, 2, len(POINTS)))
    linear = linearised(rotations, translations, POINTS)
    after, shifted, _ = gauss_newton_step(rotations, translations, linear, observed, nothing)
    np.testing.assert_allclose(after, rotations, atol=ROUNDING)
    np.testing.assert_allclose(shifted, translations, atol=ROUNDING)
