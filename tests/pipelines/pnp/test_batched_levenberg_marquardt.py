"""Many problems at once against the solver of one, and against exact data."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.pose import RigidTransform
from pipelines.chaser_fixed.options import options_for
from pipelines.pnp.batched_levenberg_marquardt import TOGETHER, solve_poses
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.problem import PnpProblem

BEST = options_for("best").solver
EXACT = 1e-9  # m and rad, data without noise
SAME = 1e-7  # m and rad: two ways to one minimum, where the last steps are smaller than rounding


def drawn(rng: np.random.Generator, count: int, known: int, noise: float, own: bool = False):
    """Return points, observations, true and first poses: points within a metre, 3 m to 6 m off."""
    shape = (count, known, 3) if own else (known, 3)
    points = rng.uniform(-1.0, 1.0, shape)
    turns = Rotation.from_rotvec(rng.uniform(-2.0, 2.0, (count, 3)))
    rotations = turns.as_matrix()
    translations = np.array([0.0, 0.0, 4.5]) + rng.uniform(-1.0, 1.0, (count, 3))
    in_cam = points @ rotations.transpose(0, 2, 1) + translations[:, None]
    observed = in_cam[..., :2] / in_cam[..., 2:] + noise * rng.standard_normal((count, known, 2))
    off = Rotation.from_rotvec(0.03 * rng.standard_normal((count, 3))).as_matrix()
    start = off @ rotations, translations + 0.03 * rng.standard_normal((count, 3))
    return points, observed, (rotations, translations), start


def one_by_one(points, observed, start, options=BEST, weights=None):
    found = []
    for k, seen in enumerate(observed):
        own = np.ones(len(seen)) if weights is None else weights[k]
        problem = PnpProblem(
            points if points.ndim == 2 else points[k], seen, own[:, None, None] * np.eye(2)
        )
        found.append(solve_pose(problem, RigidTransform(start[0][k], start[1][k]), options))
    return found


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(1, 6),
    known=st.integers(4, 12),
    own=st.booleans(),
    weighted=st.booleans(),
)
def test_it_is_the_solver_of_one(seed, count, known, own, weighted):
    rng = np.random.default_rng(seed)
    points, observed, _, start = drawn(rng, count, known, 1e-4, own)
    weights = rng.uniform(500.0, 2000.0, (count, known)) if weighted else None
    found = solve_poses(points, observed, *start, BEST, weights)
    for k, one in enumerate(one_by_one(points, observed, start, BEST, weights)):
        assert found.chi2[k] == pytest.approx(one.chi2, rel=1e-9, abs=1e-25)
        if one.stopped_by == "step" and found.converged[k] and found.chi2[k] < one.chi2 * 1.01:
            np.testing.assert_allclose(found.translations[k], one.pose.translation, atol=SAME)
            np.testing.assert_allclose(found.rotations[k], one.pose.rotation, atol=SAME)


def test_exact_data_give_the_exact_poses():
    """More of them than go together, so that a batch is cut."""
    points, observed, truth, start = drawn(np.random.default_rng(5), TOGETHER + 3, 8, 0.0)
    found = solve_poses(points, observed, *start, BEST)
    assert found.converged.all()
    np.testing.assert_allclose(found.translations, truth[1], atol=EXACT)
    np.testing.assert_allclose(found.rotations, truth[0], atol=EXACT)
    assert found.chi2.max() < EXACT**2


def test_a_problem_ends_the_same_in_any_company():
    """What the others need is not taken by those that are done; sums differ by rounding alone."""
    points, observed, _, start = drawn(np.random.default_rng(6), 40, 7, 1e-3)
    whole = solve_poses(points, observed, *start, BEST)
    for own in (slice(0, 1), slice(7, 20), slice(39, 40)):
        part = solve_poses(points, observed[own], start[0][own], start[1][own], BEST)
        np.testing.assert_allclose(part.rotations, whole.rotations[own], atol=EXACT)
        np.testing.assert_allclose(part.translations, whole.translations[own], atol=EXACT)
    assert whole.iterations.min() < whole.iterations.max()


def test_a_point_without_weight_is_as_if_it_were_not_there():
    points, observed, _, start = drawn(np.random.default_rng(7), 5, 9, 1e-4)
    weights = np.ones((5, 9))
    weights[:, 4] = 0.0
    there = weights[0] > 0.0
    wild = observed.copy()
    wild[:, 4] = 7.0
    without = solve_poses(points[there], observed[:, there], *start, BEST)
    found = solve_poses(points, wild, *start, BEST, weights)
    np.testing.assert_allclose(found.translations, without.translations, atol=SAME)
    np.testing.assert_allclose(found.chi2, without.chi2, rtol=1e-9)


def test_from_behind_the_camera_there_is_no_pose():
    """The others are none the worse for it, and the start is given back."""
    points, observed, truth, start = drawn(np.random.default_rng(8), 3, 6, 0.0)
    start[1][1, 2] = -3.0
    before = start[1].copy()
    found = solve_poses(points, observed, *start, BEST)
    assert found.converged.tolist() == [True, False, True]
    assert np.isinf(found.chi2[1])
    np.testing.assert_array_equal(found.translations[1], before[1])
    np.testing.assert_array_equal(start[1], before)
    np.testing.assert_allclose(found.translations[[0, 2]], truth[1][[0, 2]], atol=EXACT)


def test_points_in_a_line_are_no_pose():
    """A turn about the line changes nothing: whatever is returned fits, and nothing is raised."""
    points, observed, _, start = drawn(np.random.default_rng(9), 2, 5, 0.0)
    points[:] = np.linspace(-1.0, 1.0, 5)[:, None] * np.array([0.6, 0.0, 0.8])
    found = solve_poses(points, observed, *start, BEST)
    assert np.isfinite(found.rotations).all()
    assert np.isfinite(found.translations).all()


@pytest.mark.parametrize(
    "other", [{"lambda_rule": "paper"}, {"parametrisation": "euler_321"}], ids=str
)
def test_what_it_does_not_know_is_refused(other):
    points, observed, _, start = drawn(np.random.default_rng(0), 1, 5, 0.0)
    with pytest.raises(ValueError, match="lambda_rule 'gavin' and parametrisation"):
        solve_poses(points, observed, *start, replace(BEST, **other))


def test_of_none_there_are_none():
    points, observed, _, start = drawn(np.random.default_rng(0), 1, 5, 0.0)
    found = solve_poses(points, observed[:0], start[0][:0], start[1][:0], BEST)
    assert len(found.chi2) == 0
