"""Spacecraft as geometry: discs where the markers are, a label a part, a chaser that moves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import trimesh

from models.arrays import Floats
from models.markers import MarkerPattern
from models.pose import RigidTransform, rotation_from_euler_321
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from tests.support.small_scenes import LAMBERT, activate_best, camera_at, discs, plate

A_MICROMETRE = 1e-6  # of single precision on a few metres


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    activate_best()


def box(size_m: float, at: tuple[float, float, float]) -> trimesh.Trimesh:
    return trimesh.creation.box((size_m, size_m, size_m)).apply_translation(at)


CRAFT = Spacecraft(
    "craft",
    (
        Part("bus", box(1.0, (0.0, 0.0, 0.0)), LAMBERT),
        Part("wing", box(0.5, (2.0, 0.0, 0.0)), "solar_cell"),
        Part("wing", box(0.5, (-2.0, 0.0, 0.0)), "solar_cell"),
        Part("wing", box(0.2, (-3.0, 0.0, 0.0)), LAMBERT),
        Part("dish", trimesh.creation.icosphere(2, 0.4), "white_paint", smooth=True),
    ),
    discs(np.array([[0.0, 0.0, 0.6]]), 0.05),
    np.zeros(3),
)
CHASER = Spacecraft(
    "chaser", (Part("body", box(0.5, (0.0, 0.0, -0.5)), LAMBERT),), None, np.zeros(3)
)


def built(chaser: Spacecraft | None = None, installed: MarkerPattern | None = None) -> Any:
    from renders.tracing.scene import build_geometry

    return build_geometry(CRAFT, chaser, RetroreflectorOptics(), installed)


def hit(scene: Any, origin: Floats, towards: Floats) -> Any:
    """Return what one ray meets."""
    import mitsuba as mi

    ray = mi.Ray3f(mi.Point3f(*map(float, origin)), mi.Vector3f(*map(float, towards)))
    return scene.ray_intersect(ray)


def number(value: Any) -> Floats:
    return np.array(value, dtype=np.float64).ravel()


def test_one_label_a_name_and_one_shape_a_name_and_material() -> None:
    geometry = built(CHASER)
    assert geometry.labels == ("bus", "wing", "dish", "retroreflectors", "chaser")
    assert sorted(geometry.label_of_shape.values()) == [1, 2, 2, 3, 4, 5]
    wings = [key for key, label in geometry.label_of_shape.items() if label == 2]
    faces = {geometry.shapes[key].face_count() for key in wings}
    assert faces == {12, 24}  # the two wings of one material are one shape


@pytest.mark.parametrize(
    ("origin", "name"),
    [
        ((0.45, 0.45, 3.0), "bus"),
        ((2.0, 0.0, 3.0), "wing"),
        ((-2.0, 0.0, 3.0), "wing"),
        ((-3.0, 0.0, 3.0), "wing"),
        ((0.0, 0.0, 3.0), "retroreflectors"),
    ],
)
def test_a_ray_finds_the_part_that_is_there(origin: tuple[float, float, float], name: str) -> None:
    geometry = built()
    scene = geometry.scene()
    met = hit(scene, np.array(origin), np.array([0.0, 0.0, -1.0]))
    shapes = {shape.id(): geometry.label_of_shape[shape.id()] for shape in scene.shapes()}
    shape = met.shape if not hasattr(met.shape, "__len__") else met.shape[0]
    assert geometry.labels[shapes[shape.id()] - 1] == name


@pytest.mark.parametrize(
    "normal", [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.6, -0.3, 0.5]]
)
def test_a_marker_is_a_disc_of_its_radius_facing_its_normal(normal: list[float]) -> None:
    from renders.tracing.scene import marker_transform

    unit = np.array(normal) / np.linalg.norm(normal)
    point, radius = np.array([0.3, -1.1, 0.2]), 0.0127
    matrix = marker_transform(point, unit, radius)
    np.testing.assert_allclose(matrix[:3, 3], point, atol=A_MICROMETRE)
    rotation = matrix[:3, :3] / radius
    np.testing.assert_allclose(rotation[:, 2], unit, atol=A_MICROMETRE)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=A_MICROMETRE)
    assert np.linalg.det(rotation) == pytest.approx(1.0)  # no mirror: its front is outside


def test_the_polygon_of_a_marker_has_its_area_centre_and_normal() -> None:
    from renders.tracing.scene import disc_mesh

    point, radius = np.array([0.3, -1.1, 0.2]), 0.0127
    unit = np.array([0.6, 0.0, 0.8])
    mesh = disc_mesh(point, unit, radius)
    assert mesh.area == pytest.approx(np.pi * radius**2, rel=1e-9)
    np.testing.assert_allclose(mesh.triangles_center.mean(axis=0), point, atol=1e-9)
    np.testing.assert_allclose(mesh.face_normals, np.tile(unit, (len(mesh.faces), 1)), atol=1e-6)
    off_rim = np.abs(np.linalg.norm(mesh.vertices[1:] - point, axis=1) - radius)
    assert off_rim.max() < A_MICROMETRE


def test_markers_may_be_installed_elsewhere_than_surveyed() -> None:
    moved = discs(np.array([[0.2, 0.1, 0.7]]), 0.05)
    scene = built(installed=moved).scene()
    down = np.array([0.0, 0.0, -1.0])
    assert number(hit(scene, np.array([0.2, 0.1, 3.0]), down).t) == pytest.approx(2.3)
    assert number(hit(scene, np.array([0.0, 0.0, 3.0]), down).t) == pytest.approx(2.5)  # the bus


def test_flat_parts_have_flat_normals_and_curved_ones_round_normals() -> None:
    import mitsuba as mi

    from renders.tracing.scene import mitsuba_mesh

    scene = built().scene()
    towards = np.array([0.0, 0.0, -1.0])
    flat = hit(scene, np.array([0.47, 0.49, 3.0]), towards)
    np.testing.assert_allclose(number(flat.sh_frame.n), [0.0, 0.0, 1.0], atol=1e-6)
    ball = mitsuba_mesh(
        "ball", trimesh.creation.icosphere(2, 1.0), mi.load_dict({"type": "diffuse"}), smooth=True
    )
    scene = mi.load_dict({"type": "scene", "ball": ball})
    met = hit(scene, np.array([0.31, 0.17, 3.0]), towards)
    place = number(met.p)
    one_degree = np.cos(np.deg2rad(1.0))
    assert number(met.sh_frame.n) @ place / np.linalg.norm(place) > one_degree


def test_the_chaser_stands_where_the_camera_is_and_moving_it_twice_adds_nothing() -> None:
    import mitsuba as mi

    from renders.tracing.scene import place_chaser

    geometry = built(CHASER)
    scene = geometry.scene()
    far = camera_at(np.array([9.0, 9.0, 9.0]))
    turned = RigidTransform(rotation_from_euler_321([170.0, 10.0, 30.0]), np.array([0.1, 0.2, 5.0]))
    for pose in (far, turned, turned):
        place_chaser(scene, geometry, pose)
    (key,) = geometry.chaser_in_cam
    placed = number(mi.traverse(scene)[f"{key}.vertex_positions"]).reshape(-1, 3)
    expected = turned.inverse() @ CHASER.parts[0].mesh.vertices
    np.testing.assert_allclose(placed, expected, atol=1e-5)
    np.testing.assert_allclose((turned @ placed).mean(axis=0), [0.0, 0.0, -0.5], atol=1e-5)


def test_a_moved_chaser_is_met_where_it_is_and_not_where_it_was() -> None:
    from renders.tracing.scene import place_chaser

    geometry = built(CHASER)
    scene = geometry.scene()
    for height in (8.0, 4.0):
        place_chaser(scene, geometry, camera_at(np.array([5.0, 0.0, height])))
        met = hit(scene, np.array([5.0, 0.0, 20.0]), np.array([0.0, 0.0, -1.0]))
        # The body reaches from 0.25 to 0.75 m behind the lens, which looks down.
        assert 20.0 - number(met.t) == pytest.approx(height + 0.75, abs=1e-4)


def test_without_a_chaser_there_is_nothing_to_place() -> None:
    from renders.tracing.scene import place_chaser

    geometry = built()
    place_chaser(geometry.scene(), geometry, camera_at(np.array([0.0, 0.0, 5.0])))
    assert not geometry.chaser_in_cam


def test_a_target_without_markers_is_geometry_too() -> None:
    from renders.tracing.scene import build_geometry

    geometry = build_geometry(plate(LAMBERT), None, RetroreflectorOptics())
    assert list(geometry.label_of_shape.values()) == [1]
