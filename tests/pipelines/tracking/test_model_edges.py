"""Which edges show, on a target whose hidden ones can be counted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe
from pipelines.tracking.edge_fit import normal_jacobian
from pipelines.tracking.model_edges import ModelEdges
from tests.support.drawn_targets import CAMERA, target

STEP = 1e-6  # rad and m: central differences then err by 1e-8 of the slope
SLOPE_TOLERANCE = 1e-4  # relative to the largest


def cube() -> Wireframe:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    pairs = [(a, b) for a in range(8) for b in range(a) if (a ^ b).bit_count() == 1]
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = [[a, b, c] for a, b, c, _ in faces] + [[a, c, d] for a, _, c, d in faces]
    return Wireframe(
        "cube",
        tuple(f"c{k}" for k in range(8)),
        corners,
        np.zeros(8, bool),
        np.array(pairs),
        corners[np.array(triangles)],
    )


def tube(sides: int = 24) -> Wireframe:
    """Return a tube whose sides carry no edge: they show as outlines."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(sides)], axis=1)
    half = np.array([0.0, 0.0, 3.0])
    low, high = ring - half, ring + half
    following = np.roll(np.arange(sides), -1)
    triangles = np.concatenate(
        [
            np.stack([low, low[following], high], axis=1),
            np.stack([low[following], high[following], high], axis=1),
        ]
    )
    return Wireframe(
        "tube", ("a", "b"), high[:2].copy(), np.zeros(2, bool), np.array([[0, 1]]), triangles
    )


def test_a_cube_seen_face_on_shows_four_edges() -> None:
    shown = ModelEdges(cube()).shown(CAMERA, RigidTransform(np.eye(3), np.array([0.0, 0.0, 12.0])))
    assert len(np.unique(shown.edge)) == 4
    assert shown.outline.all()
    assert np.allclose(shown.points_in_target[:, 2], -1.0)
    outward = shown.points_px - [CAMERA.cx, CAMERA.cy]
    assert (np.einsum("ni,ni->n", outward, shown.normals_px) > 0.0).all()


def test_a_cube_seen_corner_on_shows_nine_edges_of_which_six_are_outline() -> None:
    turn = Rotation.align_vectors([[0.0, 0.0, -1.0]], [[1.0, 1.0, 1.0]])[0].as_matrix()
    shown = ModelEdges(cube()).shown(CAMERA, RigidTransform(turn, np.array([0.0, 0.0, 12.0])))
    # At its ends a hidden edge comes nearer to the faces that hide it than they are told from it.
    assert (np.bincount(shown.edge) > 4).sum() == 9
    assert (np.bincount(shown.edge[shown.outline]) > 4).sum() == 6


def test_a_tube_shows_its_outline_where_it_has_no_edge() -> None:
    side_on = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    range_m = 15.0
    shown = ModelEdges(tube()).shown(CAMERA, RigidTransform(side_on, np.array([0.0, 0.0, range_m])))
    sides = shown.subset(np.abs(shown.points_in_target[:, 2]) < 2.5)
    half_width_px = CAMERA.fy / np.sqrt(range_m**2 - 1.0)  # a sphere's or tube's, of radius 1 m
    away = np.abs(sides.points_px[:, 1] - CAMERA.cy)
    polygon_px = half_width_px * (1.0 - np.cos(np.pi / 24))
    assert len(sides) > 20
    assert sides.outline.all()
    assert np.abs(away - half_width_px).max() < 2.0 * polygon_px + 0.1


def test_the_silhouette_covers_what_is_drawn() -> None:
    edges = ModelEdges(cube())
    pose = RigidTransform(np.eye(3), np.array([0.0, 0.0, 12.0]))
    side_px = 2.0 * CAMERA.fx / 11.0
    assert edges.silhouette(CAMERA, pose).sum() == pytest.approx(side_px**2, rel=0.06)  # rims drawn


def test_behind_the_camera_nothing_shows() -> None:
    pose = RigidTransform(np.eye(3), np.array([0.0, 0.0, -12.0]))
    edges = ModelEdges(cube())
    assert len(edges.shown(CAMERA, pose)) == 0
    assert not edges.silhouette(CAMERA, pose).any()


def test_the_jacobian_along_normals_is_that_of_the_projection() -> None:
    pose = RigidTransform(np.eye(3), np.array([0.2, -0.1, 12.0])).perturbed(
        [0.5, -0.8, 0.3], np.zeros(3)
    )
    samples = ModelEdges(target()).shown(CAMERA, pose)
    slopes = normal_jacobian(CAMERA, pose, samples)
    for axis in range(6):
        step = np.zeros(6)
        step[axis] = STEP
        ahead = CAMERA.project(pose.perturbed(step[:3], step[3:]) @ samples.points_in_target)
        behind = CAMERA.project(pose.perturbed(-step[:3], -step[3:]) @ samples.points_in_target)
        along = np.einsum("ni,ni->n", samples.normals_px, ahead - behind) / (2.0 * STEP)
        assert np.abs(along - slopes[:, axis]).max() < SLOPE_TOLERANCE * np.abs(slopes).max()


def test_what_lies_beyond_the_lenss_fold_is_not_shown() -> None:
    """So near that the near face's edges, 53 deg off axis, would fold back into the image."""
    camera = replace(CAMERA, k1=-0.41)
    pose = RigidTransform(np.eye(3), np.array([0.0, 0.0, 1.74]))
    edges = ModelEdges(cube())
    in_cam = pose @ edges.points
    ideal = in_cam[:, :2] / in_cam[:, 2:]
    folded = camera.distort(ideal) * [camera.fx, camera.fy] + [camera.cx, camera.cy]
    beyond = np.linalg.norm(ideal, axis=1) > camera.fold_radius
    assert (beyond & camera.contains(folded)).any()
    shown = pose @ edges.shown(camera, pose).points_in_target
    assert (np.linalg.norm(shown[:, :2], axis=1) < camera.fold_radius * shown[:, 2]).all()
    # The near face has no corner that projects; the far one is drawn.
    assert 0.1 < edges.silhouette(camera, pose).mean() <= 1.0
