"""Welding, edges, lines, symmetry and simplification of meshes that can be counted by hand."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.spacecraft.own import all_around, found_wireframe, sharp_edges, simplify, symmetry
from models.spacecraft.own.shading import shading_of
from models.spacecraft.own.sharp_edges import SharpEdges, corners_of
from models.spacecraft.own.symmetry import symmetries_of
from models.spacecraft.own.welded import EdgeTable, Welded, welded
from models.wireframe.wireframe import Wireframe

BOX = np.asarray(trimesh.creation.box(extents=(2.0, 3.0, 5.0)).triangles)


def faceted(steps_deg: list[float], wide: float = 1.0, tall: float = 0.3) -> Floats:
    """Return a strip of quads that turns by so much from one to the next."""
    turns = np.deg2rad(np.cumsum([0.0, *steps_deg]))
    x = np.concatenate([[0.0], np.cumsum(tall * np.cos(turns))])
    z = np.concatenate([[0.0], np.cumsum(tall * np.sin(turns))])
    rows = [[[x[k], y, z[k]] for y in (0.0, wide)] for k in range(len(x))]
    faces = []
    for (a, b), (d, c) in pairwise(rows):
        faces += [[a, d, c], [a, c, b]]
    return np.array(faces)


def test_a_box_welds_to_8_points_and_18_edges_each_with_two_faces() -> None:
    body = welded(BOX)
    assert (len(body.points), len(body.faces)) == (8, 12)
    assert (body.degenerate, body.twice) == (0, 0)
    assert body.source.tolist() == list(range(12))
    edges = body.edges
    assert len(edges.ends) == 18
    assert (edges.count == 2).all()
    assert edges.against.all()
    assert (edges.ends[:, 0] < edges.ends[:, 1]).all()
    for (a, b), first, second in zip(edges.ends, edges.first, edges.second, strict=True):
        assert first != second
        for face in (first, second):
            assert {a, b} <= set(body.faces[face])
    outward = (body.normals * body.points[body.faces].mean(axis=1)).sum(axis=1)
    assert (outward > 0.0).all()
    np.testing.assert_allclose(np.linalg.norm(body.normals, axis=1), 1.0)
    assert set(body.bodies.tolist()) == {0}
    two = welded(np.concatenate([BOX, BOX + 9.0]))
    assert np.bincount(two.bodies).tolist() == [12, 12]


def test_an_edge_table_tells_rims_fans_and_faces_that_disagree() -> None:
    table = EdgeTable.of(np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4], [5, 6, 7], [5, 6, 8]]))
    by_ends = {tuple(e): k for k, e in enumerate(table.ends.tolist())}
    fan, same_way, rim = by_ends[(0, 1)], by_ends[(5, 6)], by_ends[(2, 0)[::-1]]
    assert table.count[[fan, same_way, rim]].tolist() == [3, 2, 1]
    assert (table.first[fan], table.second[fan]) == (0, 1)
    assert table.against[[fan, same_way, rim]].tolist() == [True, False, False]
    assert (table.first[rim], table.second[rim]) == (0, -1)
    assert {tuple(pair) for pair in table.pairs.tolist()} == {(0, 1), (3, 4)}


@pytest.mark.parametrize(("apart", "points"), [(0.9, 8), (3.0, 36)])
def test_corners_within_two_millionths_of_the_size_are_one(apart: float, points: int) -> None:
    """Wherever they lie: with a grid of such cells, some would lie on both sides of a border."""
    for seed in range(8):
        rng = np.random.default_rng([1, seed])
        size = 2e-6 * float(np.linalg.norm([2.0, 3.0, 5.0]))
        way = rng.standard_normal((36, 3))
        if points == 36:  # each corner's copies in a line, so far apart
            _, number = np.unique(BOX.reshape(-1, 3), axis=0, return_inverse=True)
            copy = [int((number[:k] == number[k]).sum()) for k in range(36)]
            moved = BOX.reshape(-1, 3) + apart * size * np.outer(copy, [0.6, 0.8, 0.0])
        else:
            away = 0.5 * apart * size * way / np.linalg.norm(way, axis=1, keepdims=True)
            moved = BOX.reshape(-1, 3) + away
        assert len(welded(moved.reshape(-1, 3, 3)).points) == points


def test_faces_without_area_and_those_that_lie_on_another_are_left_out() -> None:
    line = np.array([[[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]]])
    point = np.array([[[0.0, 0, 0], [0.0, 0, 0], [2.0, 0, 0]]])
    again = BOX[[3]][:, [1, 2, 0]]
    body = welded(np.concatenate([line, BOX, point, again, BOX[[5]][:, ::-1]]))
    assert (body.degenerate, body.twice) == (2, 2)
    assert body.source.tolist() == list(range(1, 13))
    assert len(body.faces) == 12


@pytest.mark.parametrize("inside_out", [False, True])
def test_an_edge_is_sharp_by_the_angle_of_its_faces_whichever_way_they_look(inside_out) -> None:
    strip = faceted([10.0, 19.0, 21.0, 40.0])
    if inside_out:
        strip[4:] = strip[4:, ::-1]  # the third face and all beyond
    body = welded(strip)
    sharp = sharp_edges._sharp(body, 20.0)
    inner = body.edges.count == 2
    across = np.ptp(body.points[body.edges.ends], axis=1)
    folds = inner & (across[:, 1] > 0.9) & (across[:, [0, 2]] < 1e-9).all(axis=1)
    x = body.points[body.edges.ends[:, 0], 0]
    found = sharp[folds][np.argsort(x[folds])]
    assert found.tolist() == [False, False, True, True]
    assert sharp[~inner].all()  # rims


def test_pieces_in_a_line_are_one_edge_to_six_degrees() -> None:
    """From the first piece's own direction on: a bow of small turns is several edges."""
    for turn_deg, lines in ((0.0, 1), (5.0, 1), (7.0, 2)):
        turn = np.deg2rad(turn_deg)
        points = np.array([[0.0, 0, 0], [1.0, 0, 0], [1.0 + np.cos(turn), np.sin(turn), 0]])
        found = sharp_edges._joined(points, np.array([[0, 1], [2, 1]]))
        assert len(found) == lines
    turns = np.deg2rad(4.0 * np.arange(9))
    points = np.concatenate([[[0.0, 0.0]], np.cumsum(
        np.stack([np.cos(turns), np.sin(turns)], axis=1), axis=0)])  # fmt: skip
    points = np.column_stack([points, np.zeros(10)])
    bow = sharp_edges._joined(points, np.stack([np.arange(9), np.arange(1, 10)], axis=1))
    assert 3 <= len(bow) <= 6
    ring = np.stack([np.arange(36), np.roll(np.arange(36), -1)], axis=1)
    angle = np.deg2rad(10.0 * np.arange(36))
    circle = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(36)])
    assert len(sharp_edges._joined(circle, ring)) == 36  # turns by ten degrees: none go on


def test_at_a_cross_the_straightest_go_on() -> None:
    points = np.array([[0.0, 0, 0], [-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [1, 1, 0]])
    pieces = np.array([[1, 0], [0, 2], [3, 0], [4, 0], [0, 5]])
    found = {tuple(sorted(line)) for line in sharp_edges._joined(points, pieces).tolist()}
    assert found == {(1, 2), (3, 4), (0, 5)}


def corner_of(ways: list[list[float]], size: float = 10.0) -> tuple[list[int], list[float]]:
    ends = np.array([[0, k + 1] for k in range(len(ways))])
    points = np.array([[0.0, 0.0, 0.0], *ways, [size, 0, 0], [0, 0, 0]])
    lengths = np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1)
    corners, sizes = corners_of(points, SharpEdges(ends, lengths))
    return corners.tolist(), sizes.tolist()


def test_a_corner_is_where_three_lines_meet_and_as_large_as_its_three_longest() -> None:
    corners, sizes = corner_of([[1.0, 0, 0], [0, 2.0, 0], [0, 0, 3.0], [0, 0, -0.5]])
    assert corners == [0]
    assert sizes == [6.0]
    assert corner_of([[1.0, 0, 0]])[0] == []


@pytest.mark.parametrize(("length", "turn_deg", "is_corner"), [
    (0.9, 24.0, False), (0.9, 26.0, True), (1.1, 7.0, False), (1.1, 9.0, True), (1.1, 160.0, True),
])  # fmt: skip
def test_two_lines_make_a_corner_if_they_turn_enough(length, turn_deg, is_corner) -> None:
    """By 25 deg, and by 8 if both are longer than a tenth of the mesh."""
    turn = np.deg2rad(turn_deg)
    on = [-2.0, 0.0, 0.0]
    aside = [length * np.cos(turn), length * np.sin(turn), 0.0]
    assert (corner_of([on, aside], 8.0)[0] == [0]) == is_corner


def frame_of(points: Floats, edges: list[tuple[int, int]]) -> Wireframe:
    names = tuple(str(k) for k in range(len(points)))
    return Wireframe(
        "", names, points, np.zeros(len(points), bool), np.array(edges), np.zeros((0, 3, 3))
    )


def prism(sides: int, height: float, turn: Rotation, along: float = 1.0) -> Wireframe:
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.column_stack([along * np.cos(angle), np.sin(angle), np.zeros(sides)])
    up = np.array([0.0, 0.0, height])
    points = np.concatenate([ring - up, ring + up])
    k = np.arange(sides)
    edges = [(i, (i + 1) % sides) for i in k] + [(sides + i, sides + (i + 1) % sides) for i in k]
    edges += [(i, sides + i) for i in k]
    return frame_of(turn.apply(points), edges)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("sides", "height", "along", "count"), [
    (3, 2.0, 1.0, 5), (4, 2.0, 1.0, 7), (6, 0.4, 1.0, 11), (8, 3.0, 1.0, 15), (4, 2.0, 1.5, 3),
    (5, 0.6, 1.0, 9),
])  # fmt: skip
def test_a_prism_has_the_turns_of_its_dihedral_group(sides, height, along, count, turned) -> None:
    """2 n - 1 beside none, but a rhombus's but three; whichever way it stands."""
    turn = Rotation.from_rotvec([0.4, -0.7, 1.1]) if turned else Rotation.identity()
    frame = prism(sides, height, turn, along)
    found = symmetries_of(frame)
    for each in found:
        np.testing.assert_allclose(each @ each.T, np.eye(3), atol=1e-9)
        moved = frame.points_in_target @ each.T
        away = np.linalg.norm(moved[:, None] - frame.points_in_target, axis=2).min(axis=1)
        # A hundredth of the radius, and half the way between samples.
        assert away.max() < (0.01 + 0.5 / 24) * 1.2 * frame.radius_m
    about_axis = sides - 1 if along == 1.0 else 1
    assert len(found) >= about_axis
    assert len(found) <= count


def test_edges_are_sampled_by_their_length() -> None:
    points = np.array([[0.0, 0, 0], [4.0, 0, 0], [0, 1.0, 0], [0, 0, 0.01]])
    frame = frame_of(points, [(0, 1), (0, 2), (0, 3)])
    samples = symmetry._samples(frame)
    per_radius = 24.0 / frame.radius_m
    counts = [np.ceil(4.0 * per_radius), np.ceil(1.0 * per_radius), 2]
    assert len(samples) == sum(counts)
    np.testing.assert_allclose(samples[0], points[0])
    np.testing.assert_allclose(samples[int(counts[0]) - 1], points[1])


def test_axes_of_edges_are_the_longest_and_the_longest_square_to_it() -> None:
    points = np.array([[0.0, 0, 0], [5.0, 0, 0], [3.0, 3.0, 0], [0, 0, 2.0], [0.0, 1.0, 0]])
    axes = symmetry._edge_axes(frame_of(points, [(0, 1), (0, 2), (0, 3), (0, 4)]))
    np.testing.assert_allclose(axes, [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-12)
    aslant = symmetry._edge_axes(frame_of(points, [(0, 1), (0, 2)]))
    np.testing.assert_allclose(aslant, np.eye(3))
    assert len(symmetry._turns_of_a_cube(np.eye(3))) == 23
    turns = symmetry._parts_of_a_turn(np.array([2.0, 2.03, 1.0]), np.eye(3))
    assert len(turns) == 1 + 2 + 3 + 4 + 5 + 7
    assert all(turn[2, 2] == pytest.approx(1.0) for turn in turns)
    assert symmetry._parts_of_a_turn(np.array([2.0, 2.1, 1.0]), np.eye(3)) == []


def test_a_quadric_is_the_squared_distance_from_its_planes() -> None:
    """Of a closed mesh: areas times squared distances of the faces about a corner."""
    body = welded(BOX)
    quadrics = simplify._quadrics(body.points, body.faces)
    place = np.array([0.3, -0.7, 1.9])
    for corner in range(8):
        around = (body.faces == corner).any(axis=1)
        a, b, c = np.moveaxis(body.points[body.faces[around]], 1, 0)
        normals = np.cross(b - a, c - a)
        area = 0.5 * np.linalg.norm(normals, axis=1)
        distance = ((place - a) * normals).sum(axis=1) / (2.0 * area)
        expected = float(area @ distance**2)
        form = quadrics[corner]
        assert np.append(place, 1.0) @ form @ np.append(place, 1.0) == pytest.approx(expected)
        ten = form[simplify.ROW, simplify.COLUMN].tolist()
        assert simplify._cost(ten, tuple(place)) == pytest.approx(expected)


def test_the_rim_of_a_sheet_is_dear_to_move() -> None:
    """Ten times its squared length, times the squared distance from a plane upright on it."""
    sheet = np.array([[[0.0, 0, 0], [2.0, 0, 0], [0, 3.0, 0]]])
    body = welded(sheet)
    quadrics = simplify._quadrics(body.points, body.faces)
    origin = int(np.flatnonzero((body.points == 0.0).all(axis=1))[0])
    place = np.array([0.4, 0.5, 0.7])
    face = 3.0 * 0.7**2
    rims = 10.0 * 4.0 * 0.5**2 + 10.0 * 9.0 * 0.4**2
    found = np.append(place, 1.0) @ quadrics[origin] @ np.append(place, 1.0)
    assert found == pytest.approx(face + rims)


def fine_box(per_side: int) -> Floats:
    """Return a box with every side cut into squares."""
    grid = np.linspace(-1.0, 1.0, per_side + 1)
    faces = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            for i in range(per_side):
                for j in range(per_side):
                    square = np.zeros((4, 3))
                    square[:, axis] = sign
                    square[:, (axis + 1) % 3] = grid[[i, i + 1, i + 1, i]]
                    square[:, (axis + 2) % 3] = grid[[j, j, j + 1, j + 1]]
                    square = square if sign > 0 else square[::-1]
                    faces += [square[[0, 1, 2]], square[[0, 2, 3]]]
    return np.array(faces)


def test_a_cut_up_box_becomes_the_box_again() -> None:
    """Flat collapses cost nothing: at twelve faces its volume, area and corners are whole."""
    coarse = simplify.simplified(fine_box(5), 12)
    assert len(coarse) == 12
    mesh = trimesh.Trimesh(coarse.reshape(-1, 3), np.arange(36).reshape(-1, 3))
    mesh.merge_vertices()
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(8.0)
    assert mesh.area == pytest.approx(24.0)
    few = simplify.simplified(fine_box(2), 500)
    assert len(few) == 48


def test_a_ball_keeps_its_form_as_its_faces_become_few() -> None:
    ball = trimesh.creation.icosphere(subdivisions=3)
    before = np.asarray(ball.triangles)
    coarse = simplify.simplified(before, 200)
    assert 190 <= len(coarse) <= 200
    corners = coarse.reshape(-1, 3)
    given = np.unique(before.reshape(-1, 3).round(9), axis=0)
    away = np.linalg.norm(corners[:, None] - given, axis=2).min(axis=1)
    assert away.max() < 1e-6  # onto one of an edge's ends
    mesh = trimesh.Trimesh(corners, np.arange(3 * len(coarse)).reshape(-1, 3))
    mesh.merge_vertices()
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    # An inscribed polyhedron of 200 faces has a fifteenth less than the ball.
    assert 0.91 < mesh.volume / (4.0 / 3.0 * np.pi) < 0.98


def test_thinning_keeps_the_outermost_of_each_cell() -> None:
    ball = trimesh.creation.icosphere(subdivisions=4)
    body = welded(np.asarray(ball.triangles))
    points, thin = simplify._thinned(body.points, body.faces, 4500)
    assert points is body.points
    assert 2000 < len(thin) <= 4500
    assert (np.diff(np.sort(thin, axis=1)) > 0).all()
    assert len(np.unique(np.sort(thin, axis=1), axis=0)) == len(thin)
    surface = trimesh.Trimesh(points, thin, process=False)
    assert surface.volume == pytest.approx(4.0 / 3.0 * np.pi, rel=0.05)


def test_no_collapse_turns_a_face_over() -> None:
    """A pleat: what would fold it is refused, to a cosine of 0.2."""
    flat = np.array(
        [[0.0, 0, 0], [1.0, 0, 0], [1.0, 1, 0], [0.0, 1, 0], [0.45, 0.5, 0], [2.0, 0.5, 0]]
    )
    faces = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 5, 2]])
    work = simplify._Collapse(flat, faces)
    assert work._may(4, 0)
    assert not work._may(4, 5)
    assert simplify._upright([(0.0, 0, 0), (2.0, 0, 0), (0.0, 3.0, 0)]) == (0.0, 0.0, 6.0)
    assert work._neighbours(4) == {0, 1, 2, 3}
    corners = np.random.default_rng(8).uniform(-1.0, 1.0, (3, 3))
    upright = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    found = simplify._upright([(x, y, z) for x, y, z in corners.tolist()])
    np.testing.assert_allclose(found, upright)


def test_corners_merge_into_the_largest_near_them_and_stop_at_the_wish() -> None:
    points = np.array([[0.0, 0, 0], [0.09, 0, 0], [1.0, 0, 0], [0.95, 0, 0], [3.0, 0, 0]])
    assert found_wireframe._merged(points, 0.1, 9).tolist() == [0, 0, 2, 2, 4]
    assert found_wireframe._merged(points, 0.1, 2).tolist() == [0, 0, 2, 2, -1]
    assert found_wireframe._merged(points, 0.01, 9).tolist() == [0, 1, 2, 3, 4]
    assert found_wireframe._free("a", ["a", "a_"]) == "a__"


def test_cameras_all_around_look_at_the_origin_from_evenly_spread_places() -> None:
    poses = all_around.poses_all_around(64, 7.0)
    eyes = np.array([pose.inverse().translation for pose in poses])
    np.testing.assert_allclose(np.linalg.norm(eyes, axis=1), 7.0)
    for pose in poses:
        np.testing.assert_allclose(pose @ np.zeros(3), [0.0, 0.0, 7.0], atol=1e-9)
        assert np.linalg.det(pose.rotation) == pytest.approx(1.0)
    ways = eyes / 7.0
    np.testing.assert_allclose(ways.mean(axis=0), 0.0, atol=0.02)
    np.testing.assert_allclose(ways.T @ ways / 64, np.eye(3) / 3.0, atol=0.02)
    apart = np.arccos(np.clip(ways @ ways.T - 2.0 * np.eye(64), -1.0, 1.0)).min(axis=1)
    assert apart.min() > 0.75 * np.sqrt(4.0 * np.pi / 64)
    down = all_around.look_along(np.array([0.0, 0.0, 1.0]), 5.0, np.array([0.0, 1.0, 0.3]))
    np.testing.assert_allclose(down.rotation, np.eye(3), atol=1e-12)


def strip_shading(steps_deg: list[float], smooth_deg: float) -> tuple[Welded, int, bool]:
    body = welded(faceted(steps_deg))
    shading = shading_of(body, smooth_deg)
    return body, len(shading.points), shading.normals is not None


def test_curved_surfaces_share_corners_up_to_the_angle() -> None:
    """Four quads, ten points: a fold that is too sharp has its two points twice."""
    assert strip_shading([10.0, 10.0, 10.0], 15.0)[1:] == (10, True)
    assert strip_shading([10.0, 16.0, 10.0], 15.0)[1:] == (12, True)
    assert strip_shading([0.0, 0.0, 0.0], 15.0)[1:] == (10, False)
    assert strip_shading([20.0, 20.0, 20.0], 15.0)[1:] == (10, False)


def test_a_shared_normal_is_the_mean_by_area() -> None:
    body = welded(faceted([20.0]))
    shading = shading_of(body, 30.0)
    assert shading.normals is not None
    lean = np.rad2deg(np.arctan2(-shading.normals[:, 0], shading.normals[:, 2]))
    at = np.argsort(shading.points[:, 0].round(6), kind="stable")
    sorted_lean = lean[at]
    np.testing.assert_allclose(sorted_lean[[0, 1]], 0.0, atol=1e-9)
    np.testing.assert_allclose(sorted_lean[[4, 5]], 20.0, atol=1e-9)
    # At the fold one face of one side and two of the other meet, all of one area.
    assert sorted(np.round(sorted_lean[[2, 3]], 0)) == [7.0, 13.0]
    whole = shading.mesh_of(np.array([True, True, False, False]))
    assert (len(whole.vertices), len(whole.faces)) == (4, 2)
