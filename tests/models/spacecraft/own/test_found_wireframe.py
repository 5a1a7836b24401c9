"""Corners, edges, hiding faces and symmetries found on meshes whose shape is known."""

import numpy as np
import pytest
import trimesh

from models.pose import RigidTransform
from models.spacecraft.own.build import read_own_target
from models.spacecraft.own.description import WireframeWish
from models.spacecraft.own.found_wireframe import found_wireframe
from models.spacecraft.own.sharp_edges import corners_of, sharp_edges
from models.spacecraft.own.simplify import simplified
from models.spacecraft.own.welded import welded
from models.wireframe.visibility import visible_landmarks
from tests.support.own_meshes import boxes, millimetre_stl, toml_of


def of(mesh, **wish):
    triangles = np.asarray(mesh.triangles, dtype=np.float64)
    part = np.zeros(len(triangles), dtype=np.int64)
    return found_wireframe("x", triangles, part, ("body",), WireframeWish(**wish))


def test_a_box_has_eight_corners_and_twelve_edges():
    frame = of(trimesh.creation.box((1.0, 2.0, 3.0)))
    assert len(frame) == 8
    assert len(frame.edges) == 12
    assert set(map(tuple, np.abs(frame.points_in_target).round(9))) == {(0.5, 1.0, 1.5)}


def test_an_edge_of_many_pieces_is_one():
    box = trimesh.creation.box((1.0, 2.0, 3.0)).subdivide().subdivide().subdivide()
    frame = of(box)
    assert len(frame) == 8
    assert len(frame.edges) == 12
    assert len(simplified(np.asarray(box.triangles), 12)) == 12


def test_the_rim_of_a_round_body_has_no_corners():
    body = welded(np.asarray(trimesh.creation.cylinder(1.0, 2.0, sections=48).triangles))
    corners, _ = corners_of(body.points, sharp_edges(body, 25.0))
    assert len(corners) == 0


@pytest.mark.parametrize("body", ["icosphere", "capsule", "cylinder", "torus"])
def test_a_round_body_has_a_wireframe_all_the_same(body):
    settings = {"torus": (1.0, 0.3), "cylinder": (1.0, 2.0)}.get(body, ())
    frame = of(getattr(trimesh.creation, body)(*settings))
    assert len(frame) >= 4
    assert len(frame.edges) >= 1


def test_what_is_hidden_in_a_body_is_no_landmark():
    inner = trimesh.creation.box((0.5, 0.5, 0.5))
    frame = of(trimesh.util.concatenate([trimesh.creation.box((2.0, 2.0, 2.0)), inner]))
    assert len(frame) == 8
    assert np.abs(frame.points_in_target).min() == pytest.approx(1.0)


def test_open_sheets_have_their_rims():
    sheet = trimesh.Trimesh([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0.0]], [[0, 1, 2], [0, 2, 3]])
    frame = of(sheet)
    assert len(frame) == 4
    assert len(frame.edges) == 4


def test_symmetries_are_found_and_only_those():
    assert len(of(trimesh.creation.box((1.0, 2.0, 3.0))).symmetries) == 3
    assert len(of(trimesh.creation.box((2.0, 2.0, 3.0))).symmetries) == 7
    assert len(of(trimesh.creation.box((2.0, 2.0, 2.0))).symmetries) == 23
    assert of(trimesh.util.concatenate([*boxes().values()])).symmetries == ()
    assert of(trimesh.creation.box((1.0, 2.0, 3.0)), symmetries=False).symmetries == ()


def test_the_satellites_corners_are_those_of_its_boxes(tmp_path):
    built = read_own_target(
        toml_of(millimetre_stl(tmp_path / "a.stl"), 'unit = "mm"', 'origin = "mesh"')
    )
    corners = np.concatenate([mesh.vertices for mesh in boxes().values()])
    away = np.linalg.norm(built.known_wireframe.points_in_target[:, None] - corners, axis=2).min(
        axis=1
    )
    assert away.max() < 0.0151  # half of the panel's thickness
    assert len(built.known_wireframe) >= 14
    assert len(built.known_wireframe.edges) >= 16


def test_landmarks_typed_are_joined_by_edges_found(tmp_path):
    x, y, z = 0.6, 0.45, 0.75
    lines = ["[wireframe]", "find = true", "[wireframe.landmarks]", f"foot = [{x}, {y}, {-z}]"]
    toml = toml_of(millimetre_stl(tmp_path / "a.stl"), 'unit = "mm"', 'origin = "mesh"', *lines)
    frame = read_own_target(toml).known_wireframe
    assert frame.landmark_names[0] == "foot"
    assert (frame.edges == 0).any()
    assert (np.linalg.norm(frame.points_in_target[1:] - [x, y, -z], axis=1) > 0.03).all()


def test_a_wireframe_typed_is_taken_as_it_is(tmp_path):
    lines = [
        "[wireframe]",
        'edges = [["a", "b", "c", "d", "a"]]',
        "[wireframe.landmarks]",
        "a = [1, 0, 0]",
        "b = [0, 1, 0]",
        "c = [-1, 0, 0]",
        "d = [0, -1, 0.2]",
    ]
    frame = read_own_target(toml_of(millimetre_stl(tmp_path / "a.stl"), 'unit = "mm"', *lines))
    assert frame.known_wireframe.landmark_names == ("a", "b", "c", "d")
    assert len(frame.known_wireframe.edges) == 4


def test_the_coarse_surface_hides_what_the_fine_one_hides():
    ball = trimesh.creation.icosphere(4, 1.0)
    coarse = simplified(np.asarray(ball.triangles), 200)
    assert len(coarse) <= 200
    radius = np.linalg.norm(coarse.reshape(-1, 3), axis=1)
    np.testing.assert_allclose(radius, 1.0, atol=1e-9)  # no corner where the mesh has none
    volume = np.einsum("fi,fi->f", coarse[:, 0], np.cross(coarse[:, 1], coarse[:, 2])).sum() / 6
    assert volume == pytest.approx(4 / 3 * np.pi, rel=0.08)


def test_a_small_target_hides_its_own_corners():
    box = trimesh.creation.box((0.02, 0.03, 0.04))
    frame = of(box)
    pose = RigidTransform(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 1.0]))
    seen = visible_landmarks(frame, pose)
    np.testing.assert_array_equal(seen, frame.points_in_target[:, 2] > 0)


def test_the_corners_of_a_sheet_are_seen_from_both_sides():
    frame = of(trimesh.creation.box((4.0, 3.0, 0.03)))
    assert len(frame) == 4
    for turn in (np.eye(3), np.diag([1.0, -1.0, -1.0])):
        pose = RigidTransform(turn, np.array([0.0, 0.0, 20.0]))
        assert visible_landmarks(frame, pose).all()
