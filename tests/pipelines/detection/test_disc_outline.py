"""Outlines of discs against polygons of known moments and the conic of a circle in perspective."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from pipelines.detection import disc_outline
from pipelines.detection.disc_outline import disc_outlines

CAMERA = replace(Camera.from_fov(800, 600, 50.0), fy=900.0)
# 48 straight sides of the circle's area: the second moment of their polygon is 1e-5 too small.
POLYGON = 3e-5


def test_moments_of_a_rectangle_and_of_a_triangle() -> None:
    """b^2 / 12 and h^2 / 12; of a triangle 1/36 of its sides', with the sign of its lean."""
    rectangle = np.array([[2.0, 1.0], [8.0, 1.0], [8.0, 3.0], [2.0, 3.0]])
    triangle = np.array([[0.0, 0.0], [6.0, 0.0], [0.0, 3.0], [0.0, 0.0]])
    for outline in (rectangle, rectangle[::-1]):
        centres, moments = disc_outline._polygon_moments(np.stack([outline, triangle]))
        np.testing.assert_allclose(centres, [[5.0, 2.0], [2.0, 1.0]])
        np.testing.assert_allclose(moments[0], np.diag([3.0, 1.0 / 3.0]), atol=1e-12)
        np.testing.assert_allclose(moments[1], [[2.0, -0.5], [-0.5, 0.5]], atol=1e-12)


def test_plane_axes_are_square_to_normals_and_to_each_other() -> None:
    normals = Rotation.random(20, random_state=1).as_matrix()[:, 0]
    normals = np.concatenate([normals, np.eye(3), -np.eye(3)])
    first, second = disc_outline._plane_axes(normals)
    triads = np.stack([first, second, normals], axis=1)
    np.testing.assert_allclose(triads @ triads.transpose(0, 2, 1), np.tile(np.eye(3), (26, 1, 1)),
                               atol=1e-12)  # fmt: skip


@pytest.mark.parametrize("tilt_deg", [0.0, 35.0, 70.0])
def test_an_outline_is_the_conic_of_its_circle(tilt_deg: float) -> None:
    """A circle's cone cut by the image: C = P^-T diag(1, 1, -1) P^-1 with P from the disc."""
    turn = Rotation.from_euler("xyz", [180.0 - tilt_deg, 10.0, 30.0], degrees=True).as_matrix()
    pose = RigidTransform(turn, np.array([0.15, -0.1, 0.9]))
    markers = MarkerPattern(("1",), np.array([[0.02, 0.01, 0.0]]), np.array([[0.0, 0, 1.0]]), 0.05)
    found = disc_outlines(CAMERA, pose, markers)
    centre = pose @ markers.points_in_target[0]
    plane = np.stack([0.05 * turn[:, 0], 0.05 * turn[:, 1], centre], axis=1)
    inverse = np.linalg.inv(CAMERA.matrix @ plane)
    conic = inverse.T @ np.diag([1.0, 1.0, -1.0]) @ inverse
    middle = -np.linalg.solve(conic[:2, :2], conic[:2, 2])
    height = conic[2, 2] + conic[:2, 2] @ middle
    shape = np.linalg.inv(conic[:2, :2] / -height)
    np.testing.assert_allclose(found.area_centres_px[0], middle, atol=1e-3)
    np.testing.assert_allclose(found.shapes_px2[0], shape, rtol=2e-3, atol=POLYGON * shape.max())
    np.testing.assert_allclose(found.centres_px[0], CAMERA.project(centre))
    assert found.radii_px[0] == pytest.approx(np.linalg.det(shape) ** 0.25, rel=POLYGON * 10)
    np.testing.assert_allclose(found.half_extents_px[0], np.sqrt(np.diag(shape)), rtol=1e-3)


def test_a_disc_is_told_that_faces_away_is_seen_from_aside_or_touches_the_lens() -> None:
    normal = np.array([[0.0, 0.0, 1.0]])
    markers = MarkerPattern(("1",), np.zeros((1, 3)), normal, 0.02)

    def faces(aside_deg: float, range_m: float = 1.0) -> bool:
        turn = Rotation.from_euler("x", 180.0 - aside_deg, degrees=True).as_matrix()
        pose = RigidTransform(turn, np.array([0.0, 0.0, range_m]))
        return bool(disc_outlines(CAMERA, pose, markers).facing[0])

    assert faces(0.0)
    assert faces(86.9)  # the cosine is 0.054
    assert not faces(87.4)
    assert not faces(180.0)
    assert faces(0.0, 0.0401)  # two radii
    assert not faces(0.0, 0.0399)


def test_discs_in_sight_do_not_mind_those_that_are_not() -> None:
    both = MarkerPattern(
        ("1", "2"),
        np.array([[0.0, 0, 0], [0.1, 0, 0]]),
        np.array([[0.0, 0, 1], [0.0, 0, -1]]),
        0.02,
    )
    pose = RigidTransform(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 1.0]))
    found = disc_outlines(CAMERA, pose, both)
    assert found.facing.tolist() == [True, False]
    assert np.isfinite(found.shapes_px2[0]).all()
    assert np.isnan(found.centres_px[1]).all()
    assert np.isnan(found.area_centres_px[1]).all()
