"""Solids are closed, face outward, and have the volumes of the closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from models.spacecraft import solids

EXACT = 1e-9  # relative: float64 sums over a few hundred triangles
LENGTH = st.floats(0.01, 5.0)


def polygon_share(sides: int) -> float:
    """Area of a regular polygon over that of its circumscribed circle."""
    return sides / (2.0 * np.pi) * np.sin(2.0 * np.pi / sides)


def welded(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    copy = mesh.copy()
    copy.merge_vertices(digits_vertex=9)
    return copy


@settings(deadline=None, max_examples=40)
@given(bottom=LENGTH, top=LENGTH, height=LENGTH, sides=st.integers(3, 40))
def test_frustum_has_the_volume_of_the_closed_form(
    bottom: float, top: float, height: float, sides: int
) -> None:
    mesh = solids.frustum(bottom, top, -height, 0.0, sides)
    cone = np.pi * height / 3.0 * (bottom**2 + bottom * top + top**2)
    assert mesh.volume == pytest.approx(cone * polygon_share(sides), rel=EXACT)


def test_lathe_turns_a_half_circle_into_a_sphere() -> None:
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 181)
    profile = np.column_stack([np.cos(angle), np.sin(angle)])
    profile[[0, -1], 0] = 0.0
    sphere = welded(solids.lathe(profile, 256))
    assert sphere.is_watertight
    assert sphere.is_winding_consistent
    # An inscribed polyhedron of half-degree by 1.4 degree facets loses less than 3e-4.
    assert sphere.volume == pytest.approx(4.0 / 3.0 * np.pi, rel=3e-4)


def test_lathe_splits_vertices_at_sharp_edges_only() -> None:
    can = solids.cylinder(1.0, 0.0, 1.0, 32)
    rim = can.vertices[
        np.isclose(can.vertices[:, 2], 1.0) & (np.hypot(*can.vertices[:, :2].T) > 0.9)
    ]
    assert len(rim) == 2 * 32  # once for the wall, once for the lid
    wall = solids.lathe([(1.0, 0.0), (1.01, 0.5), (1.0, 1.0)], 32)
    assert len(wall.vertices) == 3 * 32


@pytest.mark.parametrize(
    "mesh",
    [
        solids.box((1.0, 2.0, 3.0)),
        solids.bar((0.0, 0.0, 0.0), (1.0, 2.0, 3.0), 0.1, 0.2),
        solids.cup(0.2, 0.5, 0.0, 1.0, 0.01, 24),
        solids.prism(solids.hexagon(0.2), 0.0, 0.3),
        solids.holed_square(1.0, 0.4, 0.0, 0.1, 32),
        solids.tube([[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]], 0.05, 8),
    ],
    ids=["box", "bar", "cup", "prism", "holed_square", "tube"],
)
def test_solids_are_closed_and_face_outward(mesh: trimesh.Trimesh) -> None:
    whole = welded(mesh)
    assert whole.is_watertight
    assert whole.is_winding_consistent
    assert whole.volume > 0.0
    assert mesh.area_faces.min() > 0.0


def test_bar_has_its_length_and_section() -> None:
    start, end = np.array([0.3, -0.2, 0.1]), np.array([-1.0, 2.0, 0.5])
    mesh = solids.bar(start, end, 0.1, 0.2)
    assert mesh.volume == pytest.approx(0.02 * np.linalg.norm(end - start), rel=EXACT)
    assert np.allclose(mesh.centroid, 0.5 * (start + end), atol=1e-12)


def test_holed_square_has_its_hole() -> None:
    mesh = solids.holed_square(1.0, 0.4, 0.0, 0.1, 64)
    hole = np.pi * 0.4**2 * polygon_share(64)
    assert mesh.volume == pytest.approx(0.1 * (4.0 - hole), rel=EXACT)


def test_tiles_face_up_and_have_their_size() -> None:
    mesh = solids.tiles([[0.0, 0.0, 0.5], [3.0, 0.0, 0.5]], (0.4, 0.2))
    assert np.allclose(mesh.face_normals, [0.0, 0.0, 1.0])
    assert mesh.area == pytest.approx(2 * 0.08, rel=EXACT)


@settings(deadline=None, max_examples=40)
@given(axis=st.tuples(LENGTH, st.floats(-5, 5), st.floats(-5, 5)))
def test_standing_points_z_along_the_axis(axis: tuple[float, float, float]) -> None:
    at = solids.standing((1.0, 2.0, 3.0), axis)
    along = np.asarray(axis) / np.linalg.norm(axis)
    assert np.allclose(at.rotate(np.array([0.0, 0.0, 1.0])), along, atol=1e-9)
    assert np.linalg.det(at.rotation) == pytest.approx(1.0, abs=1e-9)


def test_standing_has_a_side_even_along_x() -> None:
    at = solids.standing((0.0, 0.0, 0.0), (-1.0, 0.0, 0.0))
    assert np.allclose(at.rotation @ at.rotation.T, np.eye(3))


def test_creased_splits_vertices_at_sharp_turns_only() -> None:
    # Two bends along a strip: 5 degrees stays smooth, 20 degrees becomes a crease.
    turns = np.deg2rad([0.0, 5.0, 25.0])
    x = np.concatenate([[0.0], np.cumsum(np.cos(turns))])
    z = np.concatenate([[0.0], np.cumsum(np.sin(turns))])
    vertices = np.array([[x[k], y, z[k]] for k in range(4) for y in (0.0, 1.0)])
    quads = [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(3)]
    faces = [tri for a, b, c, d in quads for tri in ((a, b, c), (a, c, d))]
    strip = solids.mesh_of(vertices, faces)
    split = solids.creased(strip, 12.0)
    assert len(split.vertices) == 8 + 2  # the two ends of the sharp bend, twice
    assert np.allclose(split.triangles, strip.triangles)
    bend = np.isclose(split.vertices[:, 0], x[1])
    middle = split.vertex_normals[bend]
    assert np.allclose(np.rad2deg(np.arctan2(-middle[:, 0], middle[:, 2])), 2.5, atol=2.5)
    assert not np.allclose(middle[:, 0], 0.0)


def test_cropped_tiles_lose_two_corners() -> None:
    mesh = solids.cropped_tiles([[0.0, 0.0, 0.5], [3.0, 0.0, 0.5]], (0.4, 0.2), 0.05)
    assert np.allclose(mesh.face_normals, [0.0, 0.0, 1.0])
    assert mesh.area == pytest.approx(2 * (0.08 - 0.05**2), rel=EXACT)
    assert len(mesh.vertices) == 12


def test_tilted_tiles_turn_about_their_middles_and_stay_flat() -> None:
    rng = np.random.default_rng(1)
    level = solids.tiles(np.column_stack([rng.uniform(-9, 9, (500, 2)), np.ones(500)]), (0.1, 0.2))
    uneven = solids.tilted(level, 4, 0.5, seed=2)
    assert np.allclose(uneven.vertices[:, :2], level.vertices[:, :2])
    assert np.allclose(uneven.vertices[:, 2].reshape(-1, 4).mean(axis=1), 1.0)
    first, second = uneven.face_normals.reshape(2, 500, 3)
    assert np.allclose(first, second, atol=1e-9)
    lean_deg = np.rad2deg(np.arctan2(first[:, :2], first[:, 2:]))
    # 500 draws know their standard deviation to 3 %; the cut at 2.5 takes another 4 % off.
    assert lean_deg.std() == pytest.approx(0.5, rel=0.12)
