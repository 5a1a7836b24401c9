"""Outliers and errors that nobody foresaw: against least squares solved anew, and draws."""

from __future__ import annotations

from itertools import combinations

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.camera import Camera
from models.pose import RigidTransform
from models.quantiles import chi_square_quantile
from pipelines.chaser_fixed.options import options_for
from pipelines.detection.blobs import find_blobs
from pipelines.detection.circularity import chain_perimeters, circularity, crofton_perimeters
from pipelines.pnp import consistency
from pipelines.pnp.consistency import common_variance_px2, deletion_gains, find_outliers
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.problem import PnpProblem

CAMERA = Camera.from_fov(1000, 900, 45.0)
SOLVER = options_for("best").solver
TRUTH = RigidTransform(
    Rotation.from_rotvec([2.9, 0.3, -0.2]).as_matrix(), np.array([0.1, -0.2, 4.0])
)
POINTS = np.random.default_rng(1).uniform(-0.8, 0.8, (9, 3))


def problem_of(off_px: Floats, sigma_px: float = 0.1) -> tuple[PnpProblem, RigidTransform]:
    pixels = CAMERA.project(TRUTH @ POINTS) + off_px
    covariance = np.broadcast_to(sigma_px**2 * np.eye(2), (len(POINTS), 2, 2))
    problem = PnpProblem.weighted(CAMERA, POINTS, pixels, covariance)
    return problem, solve_pose(problem, TRUTH, SOLVER).pose


@pytest.mark.parametrize("together", [1, 2])
def test_what_leaving_matches_out_gains_is_what_solving_without_them_tells(together: int) -> None:
    """To first order: errors of a tenth of a pixel at 1000 px leave 1e-4 beyond."""
    problem, pose = problem_of(0.1 * np.random.default_rng(2).standard_normal((9, 2)))
    total = float((problem.residuals(pose.rotation, pose.translation) ** 2).sum())
    gains = deletion_gains(problem, pose, together)
    assert set(gains) == set(combinations(range(9), together))
    for chosen, gain in gains.items():
        keep = ~np.isin(np.arange(9), chosen)
        without = solve_pose(problem.subset(keep), pose, SOLVER).chi2
        assert gain == pytest.approx(total - without, rel=5e-3, abs=5e-3)


@pytest.mark.parametrize("wrong", [(), (4,), (2, 7)])
def test_matches_that_do_not_agree_are_named(wrong: tuple[int, ...]) -> None:
    named = []
    for seed in range(6):
        rng = np.random.default_rng([3, seed])
        off = 0.1 * rng.standard_normal((9, 2))
        off[list(wrong)] += 1.5 * np.array([[0.8, 0.6]])
        named.append(find_outliers(*problem_of(off), 5.0, SOLVER) == wrong)
    assert np.mean(named) >= 5 / 6


def test_errors_larger_than_foreseen_make_no_outlier_of_the_largest() -> None:
    """Ten times what was told, everywhere: none is more wrong than the others."""
    for seed in range(6):
        off = 1.0 * np.random.default_rng([4, seed]).standard_normal((9, 2))
        assert find_outliers(*problem_of(off), 4.0, SOLVER) == ()


def test_too_few_matches_tell_of_no_outlier() -> None:
    """Of four matches three are left: six numbers for six unknowns."""
    off = np.zeros((9, 2))
    off[0] = 3.0
    problem, _ = problem_of(off)
    four = problem.subset(np.arange(9) < 4)
    pose = solve_pose(four, TRUTH, SOLVER).pose
    assert find_outliers(four, pose, 4.0, SOLVER) == ()


def test_a_common_variance_explains_what_is_left() -> None:
    """Its moment equation holds: r' (C + v)^-1 r is the degrees of freedom."""
    rng = np.random.default_rng(5)
    residuals = rng.standard_normal((12, 2)) * np.array([0.5, 0.4])
    root = rng.uniform(-0.1, 0.1, (12, 2, 2))
    covariance = root @ root.transpose(0, 2, 1) + 0.01 * np.eye(2)
    found = common_variance_px2(residuals, covariance)
    wider = covariance + found * np.eye(2)
    left = sum(float(r @ np.linalg.solve(c, r)) for r, c in zip(residuals, wider, strict=True))
    assert left == pytest.approx(18.0, rel=1e-3)
    assert found > 0.1


@pytest.mark.parametrize(("beyond", "explained"), [(0.99, True), (1.01, False)])
def test_residuals_as_foreseen_want_none(beyond: float, explained: bool) -> None:
    """Up to the 0.9999 quantile of chi-square; of three points nothing is left to judge."""
    ways = np.random.default_rng(6).standard_normal((8, 2))
    unit = np.broadcast_to(np.eye(2), (8, 2, 2))
    scaled = ways * np.sqrt(beyond * chi_square_quantile(0.9999, 10) / (ways**2).sum())
    assert (common_variance_px2(scaled, unit) == 0.0) == explained
    assert common_variance_px2(100.0 * ways[:3], unit[:3]) == 0.0
    assert common_variance_px2(1e4 * ways, unit) == 0.0  # beyond a hundred pixels: no survey error
    assert consistency.LARGEST_COMMON_PX == 100.0


@pytest.mark.parametrize("radius", [3, 6, 12])
def test_perimeters_of_a_disc_by_both_rules(radius: int) -> None:
    """Crofton's is the circle's to a tenth; the chain runs half a pixel inside."""
    v, u = np.mgrid[:60, :60]
    blobs = find_blobs(np.hypot(u - 30, v - 28) <= radius + 0.1)
    area = blobs.area_px[0]
    around = 2.0 * np.sqrt(np.pi * area)
    assert crofton_perimeters(blobs)[0] == pytest.approx(around, rel=0.11)
    contours, _ = cv2.findContours(
        np.pad(blobs.foreground.astype(np.uint8), 2), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE
    )
    assert chain_perimeters(blobs)[0] == pytest.approx(cv2.arcLength(contours[0], True))
    for rule, perimeter in (("crofton", crofton_perimeters), ("chain", chain_perimeters)):
        expected = 4.0 * np.pi * area / perimeter(blobs)[0] ** 2
        assert circularity(blobs, rule)[0] == pytest.approx(expected)


def test_croftons_formula_counts_ends_of_runs_in_four_directions() -> None:
    """Of a w by h rectangle: 2 w and 2 h ends along the axes, 2 (w + h - 1) along each diagonal.

    Each end is counted once, at the side of the neighbour looked at.
    """
    image = np.zeros((30, 40), bool)
    image[5:12, 8:29] = True
    image[20:22, 1:4] = True
    image[0, 0] = True
    found = crofton_perimeters(find_blobs(image))
    sizes = {(7, 21), (2, 3), (1, 1)}
    expected = {0.25 * np.pi * (h + w + 2.0 * np.sqrt(0.5) * (h + w - 1)) for h, w in sizes}
    np.testing.assert_allclose(np.sort(found), np.sort(list(expected)))


def test_among_errors_larger_than_foreseen_a_gross_one_is_still_named() -> None:
    """Ten times what was told everywhere, and one that is two hundred times."""
    named = []
    for seed in range(6):
        off = 1.0 * np.random.default_rng([7, seed]).standard_normal((9, 2))
        off[3] += [16.0, 12.0]
        named.append(find_outliers(*problem_of(off), 4.0, SOLVER) == (3,))
    assert np.mean(named) >= 5 / 6
