"""A range to the hull of a tube: told with its own sigma, by poses that may err."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pipelines.unknown_target.hull_planes import HullPlanes, hull_rows
from pipelines.unknown_target.observation_rows import Placed
from pipelines.unknown_target.unknowns import PLACE, SHARED, TURN
from tests.pipelines.unknown_target.test_silhouettes import (
    AWAY_M,
    CAMERA,
    PIXEL_M,
    met_m,
    outlined,
    views,
)

EDGE_RAD = 0.7 / CAMERA.fx
RANGE_SIGMA_M = 0.01
REACH = np.full((4, 3), 3.0 / np.sqrt(3.0))  # points at the ends of what is looked through
DRAWS = 400


@pytest.fixture(scope="module")
def tube():
    """Return the frames of a turning tube with derivatives, its planes, and its true ranges.

    The derivatives are made up: each frame turns and moves by numbers of its own kind.
    """
    seen = views()
    count = len(seen.t_cam_from_target)
    rng = np.random.default_rng(5)
    placed = Placed(
        seen.R_cam_from_target,
        seen.t_cam_from_target,
        np.zeros((count, 6)),
        np.zeros((count, 3)),
        rng.normal(size=(count, 3, 6)),
        np.zeros((count, 6, 6)),
        rng.normal(size=(count, 3, 8)),
        np.zeros((count, 3, 8)),
    )
    return placed, outlined(seen).planes(placed, np.arange(count), REACH), met_m(seen)


def placed_views(count: int) -> Placed:
    """Return so many frames of the turning tube, without derivatives."""
    seen = views(360.0, count)
    return Placed(seen.R_cam_from_target, seen.t_cam_from_target, *np.zeros((6, count, 1)))


def rows_of(placed: Placed, planes: HullPlanes, range_m: np.ndarray):
    sigma_m = np.full(len(range_m), RANGE_SIGMA_M)
    return hull_rows(
        placed.take(np.maximum(planes.view, 0)), placed, planes, range_m, sigma_m, EDGE_RAD
    )


def test_true_ranges_end_on_the_planes_within_what_is_stated(tube):
    """Two thirds of them within one sigma, nearly all within three."""
    placed, planes, range_m = tube
    rows, told_m = rows_of(placed, planes, range_m)
    sizes = np.abs(rows.error[planes.known, 0])
    assert planes.known.mean() > 0.9
    assert np.mean(sizes < 1.0) > 0.6
    assert np.mean(sizes < 3.0) > 0.95
    assert np.median(told_m) < 4.0 * PIXEL_M


def test_slopes_are_those_of_the_errors(tube):
    placed, planes, range_m = tube
    rows, _ = rows_of(placed, planes, range_m)
    for number in range(SHARED):
        change = np.zeros(SHARED)
        change[number] = 1e-6
        more, less = (
            rows_of(placed.moved(sign * change), planes, range_m)[0].error[:, 0]
            for sign in (1.0, -1.0)
        )
        slope = -(more - less)[planes.known] / 2e-6
        np.testing.assert_allclose(
            slope, rows.by_shared[planes.known, 0, number], rtol=1e-2, atol=0.5
        )


def test_a_pose_that_errs_moves_the_end_by_what_the_row_says(tube):
    """Poses drawn from a covariance: the errors spread as its propagation by the rows says."""
    placed, planes, range_m = tube
    rows, _ = rows_of(placed, planes, range_m)
    spread = np.zeros(SHARED)
    spread[PLACE], spread[TURN] = 0.02, 0.003
    rng = np.random.default_rng(7)
    errors = np.array(
        [
            rows_of(placed.moved(spread * rng.normal(size=SHARED)), planes, range_m)[0].error[:, 0]
            for _ in range(DRAWS)
        ]
    )
    drawn = np.std(errors, axis=0)[planes.known]
    said = np.linalg.norm(rows.by_shared[planes.known, 0] * spread, axis=1)
    np.testing.assert_allclose(drawn / said, 1.0, atol=4.0 / np.sqrt(2.0 * DRAWS))


def test_a_border_that_errs_moves_the_end_by_what_is_stated(tube):
    """Monte Carlo over the plane: where the beam meets it spreads as is told along the beam."""
    placed, planes, range_m = tube
    sure = replace(planes, spread_m=np.zeros(len(range_m)))
    nothing = np.full(len(range_m), 1e-9)
    view = placed.take(np.maximum(planes.view, 0))
    _, told_m = hull_rows(view, placed, sure, range_m, nothing, EDGE_RAD)
    rng, ends = np.random.default_rng(11), []
    for _ in range(DRAWS):
        moved = sure.normal.copy()
        moved[:, 2] += EDGE_RAD * rng.normal(size=len(moved))
        eye = -np.einsum("mji,mj->mi", placed.R_cam_from_target, placed.t_cam_from_target)
        from_view = np.einsum("mij,mj->mi", view.R_cam_from_target, eye) + view.t_cam_from_target
        along = np.einsum("mij,mj->mi", view.R_cam_from_target, placed.R_cam_from_target[:, 2])
        ends.append(-np.sum(moved * from_view, axis=1) / np.sum(moved * along, axis=1))
    steep = planes.known & (told_m < 3.0 * np.nanmedian(told_m[planes.known]))
    ratio = np.std(ends, axis=0)[steep] / told_m[steep]
    np.testing.assert_allclose(ratio, 1.0, atol=0.2)


def test_a_beam_that_grazes_is_told_to_know_little(tube):
    """Beside a plane along the beam a range says nothing of its end."""
    placed, _, _ = tube
    one = placed.take(np.array([0]))
    across = HullPlanes(np.array([0]), np.array([[0.0, 0.05, -1e-4]]), np.zeros(1), np.zeros(1))
    other = replace(
        one, R_cam_from_target=Rotation.from_euler("x", 60.0, True).as_matrix() @
        one.R_cam_from_target,
    )  # fmt: skip
    grazing = HullPlanes(np.array([0]), np.array([[0.0, 1.0, 0.0]]), np.zeros(1), np.zeros(1))
    sigma, range_m = np.array([RANGE_SIGMA_M]), np.array([AWAY_M])
    _, steep_m = hull_rows(other, one, grazing, range_m, sigma, EDGE_RAD)
    _, flat_m = hull_rows(one, one, across, range_m, sigma, EDGE_RAD)
    assert flat_m[0] > 10.0 * steep_m[0]


def test_where_the_hull_is_not_known_nothing_is_told(tube):
    placed, _, range_m = tube
    rows, told_m = rows_of(placed, HullPlanes.none(len(range_m)), range_m)
    assert np.isinf(told_m).all()
    assert np.isinf(rows.sizes).all()


def test_the_hull_is_set_back_to_where_the_tube_is():
    """By the gap of the views that carve: nearer to the surface in the median than as carved."""
    placed, range_m = placed_views(60), met_m(views(360.0, 60))
    tube = outlined(views(360.0, 60))
    planes = tube.planes(placed, np.arange(60), REACH)
    before = range_m - tube.entries(placed, placed, 3.0)
    after = (before - planes.behind_m)[planes.known & np.isfinite(range_m)]
    assert abs(np.median(after)) < 0.5 * PIXEL_M
    assert (planes.behind_m >= 0.0).all()


def test_an_outline_that_is_doubted_carves_nothing():
    """One of thirty all dark: it carves the target away, until it is doubted."""
    placed, count = placed_views(30), 30
    torn = outlined(views(360.0, count))
    torn.packed[7] = np.zeros_like(torn.packed[7])
    whole = outlined(views(360.0, count)).planes(placed, np.arange(count), REACH)
    carved = torn.planes(placed, np.arange(count), REACH)
    doubting = torn.planes(placed, np.arange(count), REACH, frozenset({7}))
    assert not carved.known.any()
    assert doubting.known.mean() > 0.9 * whole.known.mean()
    assert 7 not in doubting.view
