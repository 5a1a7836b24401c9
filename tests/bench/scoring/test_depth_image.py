"""Depth by our own rays: against trimesh's, closed forms, and the depth of a rendered dataset."""

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from bench.scoring.depth_image import PixelGrid, depth_image, grid_within
from models.camera import Camera
from models.pose import RigidTransform

BARE = Camera(width=40, height=30, fx=45.0, fy=44.0, cx=19.2, cy=14.7)
BENT = Camera(width=40, height=30, fx=45.0, fy=44.0, cx=19.2, cy=14.7, k1=-0.25, p1=0.002)
ROUNDING_M = 1e-9  # doubles at 10 m, through a handful of products
OUTLINE_SHARE = 0.01  # rays that graze an edge may fall to either side


def shape() -> trimesh.Trimesh:
    """Return a body with an appendage that hides part of it, and a hole to look through."""
    bus, arm = trimesh.creation.box((2.0, 1.5, 1.0)), trimesh.creation.box((4.0, 0.2, 0.3))
    arm.apply_translation((1.0, 0.9, 0.4))
    ring = trimesh.creation.annulus(0.5, 0.9, 0.4)
    ring.apply_translation((0.0, 0.0, 0.9))
    return trimesh.util.concatenate([bus, arm, ring])


def cast(mesh: trimesh.Trimesh, grid: PixelGrid, pose: RigidTransform) -> np.ndarray:
    """Return depth by a loop over triangles: each one's plane, then three side tests."""
    triangles = (pose @ mesh.triangles.reshape(-1, 3)).reshape(-1, 3, 3)
    depth = np.full(grid.shape, np.inf)
    for place in np.ndindex(grid.shape):
        ray = grid.directions[place]
        for a, b, c in triangles:
            normal = np.cross(b - a, c - a)
            along = normal @ ray
            if abs(along) < 1e-12:
                continue
            at = (normal @ a) / along
            hit = at * ray
            inside = all(
                np.cross(end - start, hit - start) @ normal >= 0.0
                for start, end in ((a, b), (b, c), (c, a))
            )
            if inside and 0.0 < at < depth[place]:
                depth[place] = at
    return np.where(np.isfinite(depth), depth, 0.0)


@pytest.mark.parametrize("camera", [BARE, BENT], ids=["pinhole", "distorted"])
def test_depth_is_that_of_a_ray_through_each_pixel(camera):
    mesh, grid = shape(), PixelGrid(camera, 3)
    turn = Rotation.random(rng=np.random.default_rng(0)).as_matrix()
    pose = RigidTransform(turn, np.array([0.2, -0.1, 4.0]))
    own = depth_image(mesh.vertices, mesh.faces, grid, pose)
    wanted = cast(mesh, grid, pose)
    assert (wanted > 0).sum() > 30
    differ = (own > 0) != (wanted > 0)
    assert differ.mean() <= OUTLINE_SHARE
    both = (own > 0) & (wanted > 0)
    assert np.percentile(np.abs(own - wanted)[both], 98) < ROUNDING_M


def test_a_plate_has_its_depth_and_a_stride_only_leaves_pixels_out():
    plate = trimesh.creation.box((1.0, 1.0, 0.02))
    pose = RigidTransform(np.eye(3), np.array([0.0, 0.0, 3.01]))
    whole = depth_image(plate.vertices, plate.faces, PixelGrid(BARE), pose)
    assert whole[15, 19] == pytest.approx(3.0, abs=ROUNDING_M)
    sparse = depth_image(plate.vertices, plate.faces, PixelGrid(BARE, 3), pose)
    np.testing.assert_array_equal(sparse, whole[::3, ::3])


def test_a_grid_holds_no_more_than_asked():
    assert grid_within(BARE, 40).stride == 1
    assert grid_within(BARE, 39).stride == 2
    assert max(grid_within(BARE, 7).shape) <= 7


def test_what_is_behind_or_beside_is_not_seen():
    mesh = shape()
    for place in ([0.0, 0.0, -5.0], [50.0, 0.0, 5.0]):
        pose = RigidTransform(np.eye(3), np.array(place))
        assert not depth_image(mesh.vertices, mesh.faces, PixelGrid(BARE), pose).any()
