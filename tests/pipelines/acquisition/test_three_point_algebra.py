"""The algebra under three-point poses, step by step: roots by NumPy, Grunert's quartic, Newton."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from pipelines.acquisition import three_point_poses as tested
from pipelines.acquisition.three_point_poses import LandmarkTriples

ROUNDING = 1e-7  # of roots that lie a hundredth apart
EXACT = 1e-9


def triangle(rng: np.random.Generator) -> tuple[Floats, Floats, Floats, Floats]:
    """Return points in the camera's axes, their distances, cosines between them, squared sides."""
    points = rng.uniform([-3.0, -3.0, 6.0], [3.0, 3.0, 14.0], (3, 3))
    distances = np.linalg.norm(points, axis=1)
    rays = points / distances[:, None]
    cosines = np.array([rays[1] @ rays[2], rays[0] @ rays[2], rays[0] @ rays[1]])
    sides = np.array([points[1] - points[2], points[0] - points[2], points[0] - points[1]])
    return points, distances, cosines, (sides**2).sum(axis=1)


def test_the_largest_cubic_root_is_numpys() -> None:
    """With three real roots, with one, and where the depressed cubic has no linear part."""
    rng = np.random.default_rng(1)
    polynomials = [np.poly(rng.uniform(-4.0, 4.0, 3)) for _ in range(60)]
    polynomials += [
        np.real(np.poly([low, middle + 1j * height, middle - 1j * height]))
        for low, middle, height in rng.uniform(0.3, 4.0, (60, 3)) * rng.choice([-1, 1], (60, 3))
    ]
    polynomials += [np.array([1.0, 0.0, 0.0, -8.0]), np.array([1.0, 3.0, 3.0, 9.0])]
    found = tested._largest_cubic_root(*np.array(polynomials)[:, 1:].T)
    for polynomial, root in zip(polynomials, found, strict=True):
        roots = np.roots(polynomial)
        assert root == pytest.approx(roots[np.abs(roots.imag) < 1e-6].real.max(), abs=ROUNDING)


@pytest.mark.parametrize("leading", [1.0, -2.5])
def test_real_quartic_roots_are_numpys_all_of_them_and_no_others(leading: float) -> None:
    rng = np.random.default_rng(2)
    wanted = []
    for pairs in range(3):
        for _ in range(40):
            real = rng.uniform(-3.0, 3.0, 4 - 2 * pairs)
            if len(real) > 1 and np.diff(np.sort(real)).min() < 0.05:
                continue
            middle, height = rng.uniform(-2.0, 2.0, pairs), rng.uniform(0.8, 3.0, pairs)
            wanted.append(np.concatenate([real, middle + 1j * height, middle - 1j * height]))
    wanted += [np.array([-2.0, -1.0, 1.0, 2.0]), np.array([1j, -1j, 3.0, -3.0])]  # even powers
    quartics = leading * np.stack([np.real(np.poly(roots)) for roots in wanted], axis=1)
    found = tested.real_quartic_roots(quartics)
    for roots, own in zip(wanted, found.T, strict=True):
        real = np.sort(roots[np.abs(roots.imag) == 0.0].real)
        np.testing.assert_allclose(np.sort(own[np.isfinite(own)]), real, atol=ROUNDING)


def test_a_pair_of_roots_that_noise_made_complex_keeps_its_real_part() -> None:
    """Half the split over the other pair's place decides: 0.01 of its square and of one."""
    for height, kept in ((0.02, True), (0.5, False)):
        roots = [1.0 + 1j * height, 1.0 - 1j * height, -2.0, 0.2]
        found = tested.real_quartic_roots(np.real(np.poly(roots))[:, None])[:, 0]
        real = np.sort(found[np.isfinite(found)])
        expected = [-2.0, 0.2, 1.0, 1.0] if kept else [-2.0, 0.2]
        np.testing.assert_allclose(real, expected, atol=1e-3 if kept else ROUNDING)


def test_grunerts_quartic_vanishes_at_the_true_ratio() -> None:
    """With the third distance over the first: so Haralick et al. 1994 have it."""
    for seed in range(20):
        _, distances, cosines, squared = triangle(np.random.default_rng([3, seed]))
        quartic = tested._grunert(squared[:, None], cosines[:, None])[:, 0]
        ratio = distances[2] / distances[0]
        assert np.polyval(quartic, ratio) == pytest.approx(0.0, abs=EXACT * np.abs(quartic).sum())


def test_the_law_of_cosines_tells_by_how_much_it_is_missed() -> None:
    points, distances, cosines, squared = triangle(np.random.default_rng(4))
    found = tested._law_of_cosines(distances[:, None], squared[:, None], cosines[:, None])
    np.testing.assert_allclose(found, 0.0, atol=EXACT)
    longer = distances * np.array([1.1, 1.2, 0.9])
    moved = points * np.array([1.1, 1.2, 0.9])[:, None]
    sides = [moved[1] - moved[2], moved[0] - moved[2], moved[0] - moved[1]]
    found = tested._law_of_cosines(longer[:, None], squared[:, None], cosines[:, None])
    np.testing.assert_allclose(found[:, 0], [side @ side for side in sides] - squared)


def test_two_newton_steps_square_the_error_twice() -> None:
    """From a thousandth off, two steps leave some 1e-12 of it, times what triangles amplify."""
    ends = []
    for seed in range(30):
        rng = np.random.default_rng([5, seed])
        _, distances, cosines, squared = triangle(rng)
        start = distances * (1.0 + 1e-3 * rng.standard_normal(3))
        found = tested._polished(start[:, None], squared[:, None], cosines[:, None])[:, 0]
        ends.append(np.abs(found / distances - 1.0).max())
    assert np.median(ends) < 1e-9
    assert np.percentile(ends, 80) < 1e-6


def test_newton_never_leaps_and_stands_still_where_there_is_no_slope() -> None:
    """Two steps of at most a tenth of the first distance each."""
    _, distances, cosines, squared = triangle(np.random.default_rng(6))
    start = 1.9 * distances
    found = tested._polished(start[:, None], squared[:, None], cosines[:, None])[:, 0]
    moved = np.abs(found - start)
    assert (moved <= 0.1 * start[0] * (1.0 + 1.1)).all()
    assert moved.max() > 0.1 * start[0]
    alike = np.ones((3, 1))  # three times the same ray: every column of the Jacobian vanishes
    np.testing.assert_array_equal(tested._polished(alike, alike, alike), alike)


def test_the_true_pose_is_among_those_of_exact_rays() -> None:
    """The first landmark is on its ray, and all are but for the real parts of complex pairs."""
    worst = []
    for seed in range(25):
        rng = np.random.default_rng([7, seed])
        in_cam, _, _, _ = triangle(rng)
        turn = Rotation.random(random_state=seed).as_matrix()
        shift = rng.uniform(-2.0, 2.0, 3)
        in_target = (in_cam - shift) @ turn
        triples = LandmarkTriples.of(in_target, np.array([[0, 1, 2]]))
        rays = in_cam / np.linalg.norm(in_cam, axis=1, keepdims=True)
        rotations, translations, of_triple = tested.three_point_poses(rays, triples)
        assert (of_triple == 0).all()
        off = np.abs(rotations - turn).max(axis=(1, 2)) + np.abs(translations - shift).max(axis=1)
        assert off.min() < 1e-5  # a few triangles are near a double root
        for rotation, translation in zip(rotations, translations, strict=True):
            along = in_target @ rotation.T + translation
            away = np.cross(along / np.linalg.norm(along, axis=1, keepdims=True), rays)
            np.testing.assert_allclose(away[0], 0.0, atol=EXACT)
            worst.append(np.abs(away).max())
    assert max(worst) < 0.02
    assert np.mean(np.array(worst) < 1e-5) > 0.85


def test_triples_know_their_sides_and_a_right_handed_triad() -> None:
    points = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 3.0]])
    triples = LandmarkTriples.of(points, np.array([[0, 1, 2], [2, 0, 1]]))
    np.testing.assert_allclose(triples.squared_sides.T, [[13.0, 9.0, 4.0], [4.0, 13.0, 9.0]])
    first, second = triples.axes
    np.testing.assert_allclose(first, [[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    np.testing.assert_allclose(second[0], [0, 0, -1])
    np.testing.assert_allclose(np.cross(second[0], second[1]), second[2])
    np.testing.assert_allclose(triples.first_in_target, points[[0, 2]])
    assert triples.row.tolist() == [0, 1]


@pytest.mark.parametrize(("altitude", "kept"), [(0.048, False), (0.052, True)])
def test_triples_flatter_than_a_twentieth_are_left_out(altitude: float, kept: bool) -> None:
    """Altitude over the longest side, whichever landmark comes first, whatever the size."""
    points = 7.0 * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.4, altitude, 0.0]])
    triples = LandmarkTriples.of(points, np.array([[0, 1, 2], [2, 0, 1], [1, 2, 0]]))
    assert len(triples) == 3 * kept
    assert len(LandmarkTriples.among(points, np.array([0, 1, 2]))) == 6 * kept


def test_the_root_is_found_where_cardanos_term_is_exactly_one_or_none() -> None:
    """z^3 + 1.5 z - 0.875 has the root 1/2 by u = 1; z^3 has none but 0, by u = 0."""
    found = tested._largest_cubic_root(np.zeros(2), np.array([1.5, 0.0]), np.array([-0.875, 0.0]))
    assert found == pytest.approx([0.5, 0.0], abs=1e-12)
