"""Foil that wraps boxes, panels and tubes leaves their edges where they are."""

from __future__ import annotations

import numpy as np
import pytest

from models.spacecraft.foil import FACES, box_foil, face_corners, on_quad, quad_foil, tube_foil
from models.spacecraft.solids import tiles

LOW, HIGH = np.array([-0.5, -0.4, -0.3]), np.array([0.5, 0.6, 0.7])
RELIEF_M = 0.010
BULGE_M = 1.25 * RELIEF_M  # relief and the soft pillow between seams


@pytest.mark.parametrize("face", FACES)
def test_face_corners_run_counter_clockwise_seen_from_outside(face: str) -> None:
    corners = face_corners(LOW, HIGH, face)
    axis, sign = FACES[face]
    normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
    assert normal[axis] * sign > 0.0
    assert (normal[[a for a in range(3) if a != axis]] == 0.0).all()
    assert (corners[:, axis] == (HIGH if sign > 0.0 else LOW)[axis]).all()
    assert np.allclose(corners[0] + corners[2], corners[1] + corners[3])


def test_box_foil_bulges_from_the_faces_and_keeps_corners_and_edges() -> None:
    vertices = np.asarray(box_foil(LOW, HIGH, 0.05, 7, RELIEF_M).vertices)
    beyond = np.maximum(LOW - vertices, vertices - HIGH).max(axis=1)
    assert (beyond >= -1e-12).all()
    assert (beyond <= BULGE_M).all()
    assert beyond.max() > 0.3 * RELIEF_M
    # Within 1.5 cm of an edge the tape holds the foil down.
    on_faces = np.sort(np.minimum(vertices - LOW, HIGH - vertices), axis=1)
    assert (beyond[on_faces[:, 1] < 0.0149] < 1e-9).all()
    for corner in face_corners(LOW, HIGH, "+x"):
        assert np.linalg.norm(vertices - corner, axis=1).min() < 1e-9


def test_box_foil_leaves_bare_faces_and_holes_out() -> None:
    foil = box_foil(LOW, HIGH, 0.05, 7, RELIEF_M, {"+z": (0.5, 0.5, 0.2)}, ("-x", "-y", "-z"))
    assert (foil.face_normals.min(axis=0) > -0.9).all()
    top = foil.triangles_center[foil.face_normals[:, 2] > 0.9]
    assert np.hypot(top[:, 0] - 0.0, top[:, 1] - 0.1).min() > 0.19


def test_quad_foil_faces_along_the_quads_normal() -> None:
    corners = np.array([[0.0, 0, 0], [1.0, 0, 0], [1.0, 0.6, 0.6], [0.0, 1.0, 1.0]])
    foil = quad_foil(corners, 0.05, 3, RELIEF_M)
    assert (foil.face_normals @ np.array([0.0, -1.0, 1.0]) > 0.0).all()
    height = np.asarray(foil.vertices) @ np.array([0.0, -1.0, 1.0]) / np.sqrt(2.0)
    assert height.min() == pytest.approx(0.0, abs=1e-12)
    assert 0.3 * RELIEF_M < height.max() <= BULGE_M


def test_on_quad_carries_a_rectangle_onto_a_rectangle_rigidly() -> None:
    tile = tiles([[0.5, 1.0, 0.0]], (1.0, 2.0))
    corners = np.array([[0.0, 0, 3], [0, 1.0, 3], [0, 1.0, 5], [0, 0, 5]])
    assert np.allclose(on_quad(tile, (1.0, 2.0), corners).vertices, corners)


def test_tube_foil_closes_round_the_tube_and_bulges_outward() -> None:
    foil = tube_foil(0.8, -1.0, 1.0, 0.06, 5, RELIEF_M, (0.7,))
    points = np.asarray(foil.vertices)
    radius = np.hypot(points[:, 0], points[:, 1])
    assert radius.min() >= 0.8 - 1e-9
    assert radius.max() <= 0.8 + BULGE_M
    assert (points[:, 2].min(), points[:, 2].max()) == (-1.0, 1.0)
    middles = foil.triangles_center
    assert ((foil.face_normals * middles)[:, :2].sum(axis=1) > 0.0).all()
    angles = np.sort(np.arctan2(middles[:, 1], middles[:, 0]))
    assert np.diff(angles).max() < 0.1
