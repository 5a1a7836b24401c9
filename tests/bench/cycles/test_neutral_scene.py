"""The neutral scene: what is written is what is read, and it is the house's spacecraft."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from bench.cycles.neutral_scene import read_scene
from bench.cycles.scene_export import (
    DISC_LIFT_M,
    marker_discs,
    neutral_material,
    neutral_meshes,
    neutral_scene,
    neutral_sun,
)
from models.camera import Camera
from models.markers import MarkerPattern
from models.materials import MATERIALS
from models.pose import RigidTransform
from models.spacecraft.part import Part, Spacecraft

FLOAT32 = 1e-6  # m, of vertices within a few metres


def markers() -> MarkerPattern:
    tilted = np.array([1.0, 2.0, 2.0]) / 3.0
    return MarkerPattern(
        names=("1", "2"),
        points_in_target=np.array([[0.0, 0.0, 0.1], [0.5, -0.2, 0.3]]),
        normals_in_target=np.array([[0.0, 0.0, 1.0], tilted]),
        radius_m=0.02,
    )


def small_craft() -> Spacecraft:
    box = trimesh.creation.box((1.0, 1.0, 0.1))
    ball = trimesh.creation.icosphere(subdivisions=1, radius=0.2)
    return Spacecraft(
        "small",
        (
            Part("deck", box, "white_paint"),
            Part("tank", ball, "mli_gold", smooth=True),
            Part("deck", box.copy().apply_translation([2.0, 0.0, 0.0]), "white_paint"),
        ),
        markers(),
        np.zeros(3),
    )


def small_scene():
    turned = trimesh.transformations.rotation_matrix(0.3, [1.0, 2.0, 3.0])[:3, :3]
    return neutral_scene(
        small_craft(),
        None,
        Camera(64, 48, 70.0, 70.0, 30.0, 25.0),
        RigidTransform(turned, np.array([0.1, 0.2, 4.0])),
        (neutral_sun("S2", np.array([0.6, 0.0, 0.8])),),
    )


def test_a_scene_written_is_the_scene_read(tmp_path):
    scene = small_scene()
    scene.write(tmp_path / "scene")
    read = read_scene(tmp_path / "scene")
    assert (read.camera, read.suns, read.materials) == (scene.camera, scene.suns, scene.materials)
    assert read.regions == scene.regions
    back = read.cam_from_target @ scene.cam_from_target.inverse()
    np.testing.assert_allclose(back.rotation, np.eye(3), rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(back.translation, 0.0, rtol=0.0, atol=1e-14)
    for mesh, same in zip(scene.meshes, read.meshes, strict=True):
        assert (mesh.label, mesh.material) == (same.label, same.material)
        np.testing.assert_array_equal(mesh.vertices, same.vertices)
        np.testing.assert_array_equal(mesh.faces, same.faces)
        assert (mesh.normals is None) == (same.normals is None)


def test_parts_of_one_name_material_and_shading_are_one_region():
    scene = small_scene()
    assert scene.regions == (
        "deck, white_paint",
        "tank, mli_gold",
        "retroreflectors, corner_cube_face",
    )
    assert len(scene.meshes[0].faces) == 24
    assert [mesh.normals is not None for mesh in scene.meshes] == [False, True, False]


def test_a_lens_that_distorts_is_refused(tmp_path):
    scene = small_scene()
    bent = replace(scene, camera=replace(scene.camera, k1=0.1))
    with pytest.raises(ValueError, match="expected a pinhole camera"):
        bent.write(tmp_path / "scene")


def test_materials_keep_their_sunlight_reflectances():
    for name, material in MATERIALS.items():
        simple = neutral_material(name)
        assert simple.diffuse == material.diffuse.sunlight
        assert simple.specular == material.specular.sunlight
        assert simple.alpha == material.roughness


def test_discs_have_their_area_place_and_outward_normal():
    pattern = markers()
    discs = marker_discs(pattern)
    corners = 64
    polygon = 0.5 * corners * np.sin(2.0 * np.pi / corners) * pattern.radius_m**2
    assert discs.area == pytest.approx(2.0 * polygon, rel=1e-9)
    first = discs.face_normals[:corners]
    second = discs.face_normals[corners:]
    np.testing.assert_allclose(
        first, np.tile(pattern.normals_in_target[0], (corners, 1)), atol=1e-9
    )
    np.testing.assert_allclose(
        second, np.tile(pattern.normals_in_target[1], (corners, 1)), atol=1e-9
    )
    centre = discs.triangles_center[corners:].mean(axis=0)
    expected = pattern.points_in_target[1] + DISC_LIFT_M * pattern.normals_in_target[1]
    np.testing.assert_allclose(centre, expected, atol=1e-9)


def test_a_chaser_goes_with_its_camera():
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    target_from_body = RigidTransform(quarter, np.array([0.0, 0.0, 5.0]))
    part = Part("tank", trimesh.creation.icosphere(1, 0.2), "mli_gold", smooth=True)
    (mesh,) = neutral_meshes((part,), target_from_body)
    place = np.asarray(part.mesh.vertices)
    np.testing.assert_allclose(
        mesh.vertices,
        np.stack([-place[:, 1], place[:, 0], place[:, 2] + 5.0], axis=1),
        atol=FLOAT32,
    )
    outward = mesh.vertices - [0.0, 0.0, 5.0]
    assert (np.einsum("ij,ij->i", mesh.normals, outward) > 0.0).all()


def test_the_file_is_plain_json_without_infinities(tmp_path):
    small_scene().write(tmp_path)
    table = json.loads((tmp_path / "scene.json").read_text(), parse_constant=pytest.fail)
    assert set(table) == {"camera", "target_from_cam", "suns", "materials", "meshes"}
