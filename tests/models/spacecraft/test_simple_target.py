"""The simple target against trimesh: its inertia, and where rays meet it."""

import numpy as np
import pytest
import trimesh

from models.spacecraft.simple_target import (
    BOX_KG,
    BOX_M,
    PANEL_KG,
    PANEL_M,
    TIP_Y_M,
    inertia_kg_m2,
    points_in_target,
    points_on_box,
    range_to_surface_m,
)


def test_the_inertia_is_that_of_its_boxes():
    total = np.zeros((3, 3))
    offset = 0.5 * (BOX_M[1] + PANEL_M[1])
    for size, mass, y in ((BOX_M, BOX_KG, 0.0), (PANEL_M, PANEL_KG, offset),
                          (PANEL_M, PANEL_KG, -offset)):  # fmt: skip
        box = trimesh.creation.box(size)
        box.density = mass / box.volume
        box.apply_translation([0.0, y, 0.0])
        total += box.moment_inertia_frame(np.eye(4))
    np.testing.assert_allclose(inertia_kg_m2(), total, rtol=1e-9, atol=1e-6)


def test_there_are_twelve_corners_on_the_surface():
    points = points_in_target()
    assert points.shape == (12, 3)
    np.testing.assert_allclose(points.mean(axis=0), 0.0, atol=1e-12)
    assert np.abs(points[:, 1]).max() == TIP_Y_M
    for point in points:
        outside = 10.0 * point / np.linalg.norm(point) + [0.0, 0.0, 1e-9]
        ray = (point - outside) / np.linalg.norm(point - outside)
        near = np.linalg.norm(point - outside)
        assert range_to_surface_m(outside, ray) <= near + PANEL_M[2]


def test_rays_meet_faces_where_they_are():
    down = np.array([0.0, 0.0, -1.0])
    assert range_to_surface_m(np.array([0.5, 0.5, 10.0]), down) == pytest.approx(10.0 - 1.2)
    assert range_to_surface_m(np.array([0.0, 3.0, 10.0]), down) == pytest.approx(10.0 - 0.015)
    assert range_to_surface_m(np.array([0.9, 3.0, 10.0]), down) == np.inf
    assert range_to_surface_m(np.array([0.0, 0.0, 10.0]), -down) == np.inf


def test_points_on_the_box_are_on_its_faces():
    points = points_on_box(50)
    assert (np.isclose(np.abs(points), 0.5 * BOX_M).sum(axis=1) >= 1).all()
    np.testing.assert_array_equal(points, points_on_box(50))
