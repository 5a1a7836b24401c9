"""The arrow says what the whole matrix says."""

import numpy as np
import pytest

from pipelines.unknown_target.arrow_equations import ArrowEquations

SHARED, POINTS, ROWS = 4, 6, 40
rng = np.random.default_rng(3)
BY_SHARED = rng.normal(size=(ROWS, 2, SHARED))
BY_POINT = rng.normal(size=(ROWS, 2, 3))
ERROR = rng.normal(size=(ROWS, 2))
WHO = rng.permutation(np.arange(ROWS) % POINTS)


def arrow():
    equations = ArrowEquations.empty(SHARED, POINTS)
    equations.add_rows(BY_SHARED[:25], BY_POINT[:25], ERROR[:25], WHO[:25])
    equations.add_rows(BY_SHARED[25:], BY_POINT[25:], ERROR[25:], WHO[25:])
    return equations


def whole():
    """Return the dense matrix and gradient."""
    rows = np.zeros((ROWS, 2, SHARED + 3 * POINTS))
    rows[:, :, :SHARED] = BY_SHARED
    for row, (who, by_point) in enumerate(zip(WHO, BY_POINT, strict=True)):
        rows[row, :, SHARED + 3 * who : SHARED + 3 * who + 3] = by_point
    flat = rows.reshape(2 * ROWS, -1)
    return flat.T @ flat, flat.T @ ERROR.ravel()


def split(vector):
    return vector[:SHARED], vector[SHARED:].reshape(POINTS, 3)


def test_solution_and_covariances_are_those_of_the_whole():
    matrix, gradient = whole()
    solved, covariance = arrow().solve(), np.linalg.inv(matrix)
    shared, points = split(covariance @ gradient)
    np.testing.assert_allclose(solved.shared, shared, rtol=1e-9)
    np.testing.assert_allclose(solved.points, points, rtol=1e-9)
    np.testing.assert_allclose(solved.covariance, covariance[:SHARED, :SHARED], rtol=1e-8)
    for place, own in enumerate(solved.point_covariances()):
        first = SHARED + 3 * place
        np.testing.assert_allclose(
            own, covariance[first : first + 3, first : first + 3], rtol=1e-7, atol=1e-12
        )


def test_the_spread_of_a_prediction_is_that_of_the_whole():
    solved, covariance = arrow().solve(), np.linalg.inv(whole()[0])
    row = np.zeros((2, SHARED + 3 * POINTS))
    row[:, :SHARED] = BY_SHARED[0]
    row[:, SHARED + 6 : SHARED + 9] = BY_POINT[0]
    found = solved.predicted_spread(BY_SHARED[:1], BY_POINT[:1], np.array([2]))
    np.testing.assert_allclose(found[0], row @ covariance @ row.T, rtol=1e-8)


def test_a_square_and_a_move_are_those_of_the_whole():
    matrix, gradient = whole()
    step = rng.normal(size=SHARED + 3 * POINTS)
    assert arrow().square(*split(step)) == pytest.approx(step @ matrix @ step)
    moved = arrow().moved(*split(step))
    shared, points = split(gradient - matrix @ step)
    np.testing.assert_allclose(moved.a, shared, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(moved.d, points, rtol=1e-9, atol=1e-9)


def test_damping_enlarges_the_diagonal_alone():
    damped, plain = arrow().damped(0.5), arrow()
    np.testing.assert_allclose(np.diag(damped.A), 1.5 * np.diag(plain.A))
    assert damped.A[0, 1] == plain.A[0, 1]
    assert damped.D[0, 1, 1] == pytest.approx(1.5 * plain.D[0, 1, 1])
    assert damped.D[0, 0, 1] == plain.D[0, 0, 1]


def test_new_points_leave_the_old_ones_alone():
    equations = arrow()
    before = equations.solve()
    equations.grow(2)
    equations.D[POINTS:] += np.eye(3)
    after = equations.solve()
    np.testing.assert_allclose(after.points[:POINTS], before.points, rtol=1e-9)
    np.testing.assert_allclose(after.points[POINTS:], 0.0)


def test_what_nothing_is_known_of_is_no_solution():
    equations = arrow()
    equations.grow(1)
    with pytest.raises(np.linalg.LinAlgError):
        equations.solve()
