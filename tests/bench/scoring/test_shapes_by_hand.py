"""Shapes, depths, clouds and ranges of scores, worked out by hand or by trimesh."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from bench.scoring.depth_image import PixelGrid, depth_image, grid_within
from bench.scoring.pairs.ranges import range_bins
from bench.scoring.target_shape import TargetShape, spread_points
from bench.scoring.unknown.cloud import Surface, cloud_score
from models.camera import Camera
from models.pose import RigidTransform
from models.spacecraft.line_of_sight import distances

BOX = trimesh.creation.box(extents=(2.0, 4.0, 1.0))
SHAPE = TargetShape("box", np.asarray(BOX.vertices), np.asarray(BOX.faces))


def test_points_are_spread_by_area_and_evenly() -> None:
    """Of 4096 on a box of 28 m2, each face its share, in each quarter of it alike."""
    points = SHAPE.spread
    assert points.shape == (4096, 3)
    half = np.array([1.0, 2.0, 0.5])
    on = np.abs(np.abs(points) - half) < 1e-9
    assert (on.sum(axis=1) >= 1).all()
    assert (np.abs(points) <= half + 1e-9).all()
    for axis, area in ((0, 4.0), (1, 2.0), (2, 8.0)):
        for sign in (-1.0, 1.0):
            face = on[:, axis] & (np.sign(points[:, axis]) == sign)
            assert face.mean() == pytest.approx(area / 28.0, abs=0.002)
            others = [k for k in range(3) if k != axis]
            quarters = (points[face][:, others] > 0.0) @ [1, 2]
            share = np.bincount(quarters, minlength=4) / face.sum()
            np.testing.assert_allclose(share, 0.25, atol=0.02)
    np.testing.assert_array_equal(spread_points(SHAPE.vertices[SHAPE.faces], 4096), points)


def test_a_shape_knows_its_corners_and_its_diameter() -> None:
    assert len(SHAPE.corners) == 8
    assert SHAPE.diameter_m == pytest.approx(np.sqrt(21.0))
    assert len(SHAPE.points) == 4096 + 8
    flat = TargetShape(
        "sheet", np.array([[0.0, 0, 0], [3.0, 0, 0], [0, 4.0, 0], [0, 0, 0]]), np.array([[0, 1, 2]])
    )
    assert len(flat.corners) == 3
    assert flat.diameter_m == 5.0


@pytest.mark.parametrize("stride", [1, 3])
@pytest.mark.parametrize("k1", [0.0, -0.15])
def test_depth_is_what_rays_meet(stride: int, k1: float) -> None:
    """Against each ray cast by itself (Möller and Trumbore 1997), distortion and all."""
    camera = Camera(41, 33, 50.0, 48.0, 20.3, 15.8, k1=k1)
    ball = trimesh.creation.icosphere(subdivisions=1, radius=0.7)
    ball.apply_translation([0.9, 0.2, 0.8])
    both = trimesh.util.concatenate([BOX, ball])
    pose = RigidTransform(
        Rotation.from_rotvec([0.5, -0.8, 0.3]).as_matrix(), np.array([0.2, -0.1, 6.0])
    )
    grid = PixelGrid(camera, stride)
    found = depth_image(np.asarray(both.vertices), np.asarray(both.faces), grid, pose)
    assert found.shape == grid.shape == (-(-33 // stride), -(-41 // stride))
    rows, columns = np.mgrid[: grid.shape[0], : grid.shape[1]] * stride
    rays = camera.rays(np.stack([columns, rows], axis=-1).reshape(-1, 2).astype(float))
    moved = (pose @ np.asarray(both.vertices))[both.faces]
    reach = np.array([distances(moved, np.zeros(3), ray).min() for ray in rays])
    expected = np.where(np.isfinite(reach), reach, 0.0) * rays[:, 2]
    away = np.abs(found.ravel() - expected) > 1e-6
    assert away.mean() < 0.005  # rays through an edge
    assert 0.15 < (expected > 0.0).mean() < 0.8
    np.testing.assert_allclose(grid.stretch.ravel(), 1.0 / rays[:, 2])


def test_the_finest_grid_within_a_limit() -> None:
    camera = Camera.from_fov(1000, 700, 40.0)
    assert [grid_within(camera, most).stride for most in (1000, 999, 500, 333)] == [1, 2, 2, 4]


def test_what_is_behind_or_beside_is_not_met() -> None:
    camera = Camera.from_fov(20, 20, 40.0)
    for shift in ([0, 0, -6.0], [9.0, 0, 6.0]):
        pose = RigidTransform(np.eye(3), np.array(shift))
        assert not depth_image(SHAPE.vertices, SHAPE.faces, PixelGrid(camera), pose).any()


def test_distances_to_a_surface_are_trimeshs() -> None:
    rng = np.random.default_rng(1)
    points = rng.uniform(-3.0, 3.0, (60, 3))
    surface = Surface(SHAPE.vertices[SHAPE.faces])
    _, away, _ = trimesh.proximity.closest_point_naive(BOX, points)
    np.testing.assert_allclose(surface.distances(points), away, atol=1e-9)
    assert surface.distances(np.zeros((0, 3))).shape == (0,)


def test_a_cloud_is_scored_by_its_distances_and_by_what_it_covers() -> None:
    """Ten points above a face, 1 cm to 10 cm off it, the last of them 1 m."""
    surface = Surface(SHAPE.vertices[SHAPE.faces])
    off = np.array([0.01, 0.02, 0.03, 0.04, 0.06, 0.07, 0.08, 0.09, 0.10, 1.0])
    points = np.column_stack([np.linspace(-0.5, 0.4, 10), np.zeros(10), 0.5 + off])
    seen = np.array([[-0.5, 0.0, 0.5], [-0.5, 0.3, 0.5], [-0.5, 1.0, 0.5], [-0.4, 0.03, 0.52]])
    score = cloud_score(points, np.array([0.1, 0.3, 0.2]), surface, seen)
    assert score.points == 10
    assert score.rms_m == pytest.approx(np.sqrt((off**2).mean()))
    assert score.inlier_rms_m == pytest.approx(np.sqrt((off[:9] ** 2).mean()))
    assert score.median_m == pytest.approx(0.065)
    assert score.p90_m == pytest.approx(np.quantile(off, 0.9))
    assert score.within_5cm == pytest.approx(0.4)
    assert score.completeness_5cm == 0.5
    assert score.completeness_50cm == 0.75
    assert score.sigma_m == 0.2
    nothing = cloud_score(np.zeros((0, 3)), None, surface, seen)
    assert (nothing.points, nothing.rms_m, nothing.sigma_m) == (0, None, None)
    unseen = cloud_score(points[:1], None, surface, np.zeros((0, 3)))
    assert (unseen.completeness_5cm, unseen.inlier_rms_m) == (None, pytest.approx(0.01))


@pytest.mark.parametrize(("ranges", "edges"), [
    ([1.82, 6.71], (1.5, 7.0, 0.5)), ([1.82, 1.85], (1.8, 1.9, 0.1)),
    ([0.0, 1.15], (0.0, 1.2, 0.1)), ([0.0, 1.2], (0.0, 1.4, 0.2)),
    ([0.3, 0.3], (0.3, 0.4, 0.1)), ([30.0, 120.0], (30.0, 130.0, 10.0)),
])  # fmt: skip
def test_ranges_are_binned_roundly_into_at_most_twelve(ranges, edges) -> None:
    first, last, step = edges
    bins = range_bins(np.array(ranges))
    assert bins[0][0] == pytest.approx(first)
    assert bins[-1][1] == pytest.approx(last)
    assert len(bins) == round((last - first) / step) <= 12
    assert all(high == low for (_, high), (low, _) in pairwise(bins))
    held = [low <= each < high for each in ranges for low, high in bins]
    assert sum(held) == len(ranges)
    assert range_bins(np.zeros(0)) == []
