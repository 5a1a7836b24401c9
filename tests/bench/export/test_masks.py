"""Silhouettes, shadows and run lengths, each against another way to find the same."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from bench.export.formats.reading_back import decoded
from bench.export.run_lengths import mask_of, packed, run_lengths
from bench.export.silhouette import box_of, filled, silhouette
from bench.export.sunlight import sunlit
from models.camera import Camera
from models.pose import RigidTransform

CAMERA = Camera(64, 48, 70.0, 70.0, 31.5, 23.5)
masks = arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, max_side=12))


@given(masks)
def test_run_lengths_come_back(mask):
    lengths = run_lengths(mask)
    assert (mask_of(lengths, *mask.shape) == mask).all()
    assert (decoded(packed(lengths), *mask.shape) == mask).all()


@given(st.lists(st.integers(0, 10**7), min_size=1, max_size=6))
def test_packed_lengths_come_back_however_long(lengths):
    total = sum(lengths)
    if 0 < total < 10**7:
        assert run_lengths(decoded(packed(lengths), total, 1)) == run_lengths(
            mask_of(lengths, total, 1)
        )


def test_run_lengths_of_another_size_are_refused():
    with pytest.raises(ValueError, match="add up to 3 x 3"):
        mask_of([4, 4], 3, 3)


def inside(triangles: np.ndarray, width: int, height: int) -> np.ndarray:
    """Tell pixel by pixel, by the signs of three areas."""
    v, u = np.indices((height, width), dtype=np.float64)
    covered = np.zeros((height, width), dtype=bool)
    for a, b, c in triangles:
        areas = [
            (q[0] - p[0]) * (v - p[1]) - (q[1] - p[1]) * (u - p[0])
            for p, q in ((a, b), (b, c), (c, a))
        ]
        covered |= np.all([x >= 0 for x in areas], axis=0) | np.all([x <= 0 for x in areas], axis=0)
    return covered


@pytest.mark.parametrize("spread", [2.0, 20.0, 300.0])
def test_filled_triangles_are_those_of_three_areas(spread):
    rng = np.random.default_rng(int(spread))
    middles = rng.uniform(-10.0, 80.0, (60, 1, 2))
    triangles = middles + rng.normal(0.0, spread, (60, 3, 2))
    for some in (triangles, triangles[:1], triangles[:0]):
        assert (filled(some, 70, 50) == inside(some, 70, 50)).all()


def test_a_triangle_through_pixel_centres_covers_them():
    corner = np.array([[[1.0, 1.0], [4.0, 1.0], [1.0, 4.0]]])
    assert filled(corner, 6, 6).sum() == 10
    assert box_of(filled(corner, 6, 6)) == (1, 1, 4, 4)


def ball(radius: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    mesh = trimesh.creation.icosphere(4, radius)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def test_a_balls_silhouette_is_a_disc():
    found = silhouette(*ball(), CAMERA, RigidTransform(np.eye(3), np.array([0.0, 0.0, 5.0])))
    radius_px = 70.0 / np.sqrt(5.0**2 - 1.0)  # the tangent cone
    assert found.count == pytest.approx(np.pi * radius_px**2, rel=0.02)
    assert found.count == found.inside.sum()
    v, u = np.indices((48, 64))
    rim = np.hypot(u - 31.5, v - 23.5)
    assert not (found.inside & (rim > radius_px)).any()
    assert found.inside[rim < 0.995 * radius_px].all()


def test_what_reaches_out_of_the_image_is_counted():
    pose = RigidTransform(np.eye(3), np.array([5.0 * 31.5 / 70.0, 0.0, 5.0]))
    found = silhouette(*ball(), CAMERA, pose)
    assert found.box is not None
    assert found.box[2] > 64
    assert found.inside.sum() == pytest.approx(found.count / 2, rel=0.15)


def test_what_reaches_behind_the_lens_is_cut():
    plate = np.array([[-1.0, 1.0, -5.0], [1.0, 1.0, -5.0], [1.0, 1.0, 20.0], [-1.0, 1.0, 20.0]])
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    found = silhouette(plate, faces, CAMERA, RigidTransform.identity())
    rows = np.flatnonzero(found.inside.any(axis=1))
    assert rows.min() == np.ceil(23.5 + 70.0 / 20.0)
    assert rows.max() == 47


def test_a_lens_that_distorts_bends_the_silhouette():
    bent = Camera(64, 48, 70.0, 70.0, 31.5, 23.5, k1=-0.3)
    pose = RigidTransform(np.eye(3), np.array([1.5, 1.0, 5.0]))
    vertices, faces = ball()
    found = silhouette(vertices, faces, bent, pose)
    pixels = bent.project(pose @ vertices)
    assert found.box is not None
    edges = np.concatenate([pixels.min(axis=0), pixels.max(axis=0)])
    assert np.abs(np.array(found.box) - edges).max() < 1.5
    straight = silhouette(vertices, faces, CAMERA, pose)
    assert (straight.inside != found.inside).sum() > 20


def test_shadows_are_those_of_rays():
    rng = np.random.default_rng(3)
    mesh = trimesh.util.concatenate(
        [
            trimesh.creation.box((1.0, 1.0, 0.5)),
            trimesh.creation.box((3.0, 0.5, 0.05)).apply_translation([0.0, 0.0, 1.5]),
        ]
    )
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    points = rng.uniform(-1.0, 1.0, (200, 3)) * [2.0, 0.4, 0.8] + [0.0, 0.0, 0.6]
    sun = np.array([0.2, 0.1, 0.97])
    sun /= np.linalg.norm(sun)
    triangles = vertices[faces]
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    slope = normal @ sun
    expected = []
    for point in points:  # where the ray meets each plane, and whether that lies in the triangle
        t = ((triangles[:, 0] - point) * normal).sum(axis=1) / np.where(slope == 0, np.nan, slope)
        places = point + t[:, None] * sun
        sides = [
            (np.cross(triangles[:, (k + 1) % 3] - triangles[:, k], places - triangles[:, k])
             * normal).sum(axis=1) >= 0 for k in range(3)
        ]  # fmt: skip
        expected.append(not (np.all(sides, axis=0) & (t > 0.03)).any())
    assert sunlit(points, vertices, faces, sun).tolist() == expected
    assert 20 < sum(expected) < 180
