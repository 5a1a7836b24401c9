"""Wahba's problem against SciPy's own solver, and its covariance against many draws."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pipelines.star_attitude.wahba import wahba_attitude, wahba_covariance

SEEDS = range(8)


def sky(rng: np.random.Generator, count: int) -> np.ndarray:
    """Directions within 14 deg of an axis."""
    aside = rng.uniform(-0.17, 0.17, (count, 2))
    rays = np.concatenate([aside, np.ones((count, 1))], axis=1)
    return rays / np.linalg.norm(rays, axis=1, keepdims=True)


@pytest.mark.parametrize("seed", SEEDS)
def test_it_is_scipy_s(seed):
    """The same loss, the same minimum: to rounding, weights and errors whatever they are."""
    rng = np.random.default_rng(seed)
    known = rng.standard_normal((3 + seed, 3))
    known /= np.linalg.norm(known, axis=1, keepdims=True)
    turn = Rotation.random(random_state=seed)
    seen = turn.apply(known) + 0.05 * rng.standard_normal(known.shape)
    weights = rng.uniform(0.1, 5.0, len(known))
    theirs, _ = Rotation.align_vectors(seen, known, weights)
    np.testing.assert_allclose(wahba_attitude(seen, known, weights), theirs.as_matrix(), atol=1e-9)


def test_two_directions_are_enough_and_a_mirror_image_is_no_attitude():
    turn = Rotation.from_rotvec([0.3, -2.0, 1.0]).as_matrix()
    known = np.array([[1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])
    np.testing.assert_allclose(wahba_attitude(known @ turn.T, known, np.ones(2)), turn, atol=1e-12)
    mirrored = np.eye(3) * [1.0, 1.0, -1.0]
    assert np.linalg.det(wahba_attitude(mirrored, np.eye(3), np.ones(3))) == pytest.approx(1.0)


def test_its_covariance_is_that_of_its_errors():
    """2000 draws, 12 stars: each variance known to 3 %, so 12 % is four sigmas."""
    rng = np.random.default_rng(3)
    seen = sky(rng, 12)
    sigmas = rng.uniform(2e-6, 2e-5, 12)
    turn = Rotation.random(random_state=1).as_matrix()
    known = seen @ turn
    told = wahba_covariance(seen, sigmas**2)
    errors = []
    for _ in range(2000):
        noisy = seen + np.cross(sigmas[:, None] * rng.standard_normal((12, 3)), seen)
        found = wahba_attitude(noisy, known, 1.0 / sigmas**2)
        errors.append(Rotation.from_matrix(found @ turn.T).as_rotvec())
    squares = np.einsum("ni,ij,nj->n", errors, np.linalg.inv(told), errors)
    assert squares.mean() / 3.0 == pytest.approx(1.0, abs=0.07)
    np.testing.assert_allclose(np.var(errors, axis=0), np.diag(told), rtol=0.12)


def test_the_covariance_of_three_stars_square_to_each_other_is_half_a_stars() -> None:
    """About each axis two of them tell: v / 2; with one twice as sure, by hand."""
    np.testing.assert_allclose(wahba_covariance(np.eye(3), np.full(3, 4e-10)), 2e-10 * np.eye(3))
    found = wahba_covariance(np.eye(3), np.array([1e-10, 4e-10, 4e-10]))
    expected = 1.0 / np.array([0.5e10, 1.25e10, 1.25e10])
    np.testing.assert_allclose(found, np.diag(expected))


def test_three_stars_at_right_angles_tell_each_axis_by_two():
    """Each axis is told by the two stars across it: half of a star's variance, exactly."""
    variance = 2.5e-9
    found = wahba_covariance(np.eye(3), np.full(3, variance))
    np.testing.assert_allclose(found, 0.5 * variance * np.eye(3), rtol=1e-12, atol=1e-24)
