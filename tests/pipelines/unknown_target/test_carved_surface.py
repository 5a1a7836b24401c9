"""Hulls of convex bodies from silhouettes drawn without error: they tend to the bodies."""

import cv2
import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from models.camera import Camera
from pipelines.unknown_target.carved_surface import CarvedSurface, NoSurface, View, carve
from pipelines.unknown_target.cleaned_cloud import Cloud, cleaned_cloud

CAMERA = Camera(width=300, height=300, fx=400.0, fy=400.0, cx=149.5, cy=149.5)
AWAY_M = 20.0
PIXEL_M = AWAY_M / CAMERA.fx
RADIUS_M = 1.5
BOX_HALF_M = np.array([2.0, 1.0, 0.5])
BOX = trimesh.creation.box(2.0 * BOX_HALF_M)
BALL = trimesh.creation.icosphere(3, RADIUS_M)
FINER = 8  # times, at which outlines are drawn


def view_of(body: trimesh.Trimesh, turn: np.ndarray) -> View:
    """Return the silhouette of a convex body, pixels covered at their middle."""
    origin = np.array([0.1, -0.2, AWAY_M])
    pixels = CAMERA.project(np.asarray(body.vertices) @ turn.T + origin)
    outline = pixels[ConvexHull(pixels).vertices]
    size = FINER * CAMERA.height, FINER * CAMERA.width
    corners = np.round(FINER * (outline + 0.5) - 0.5).astype(np.int32)
    drawn = cv2.fillConvexPoly(np.zeros(size, np.uint8), corners[:, None], 1)
    return View(turn, origin, drawn[FINER // 2 :: FINER, FINER // 2 :: FINER] > 0)


def all_round(count: int) -> list[np.ndarray]:
    """Return turns whose boresights are spread evenly over the sphere (a spiral)."""
    up = 1.0 - 2.0 * (np.arange(count) + 0.5) / count
    about = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    along = np.column_stack([np.sqrt(1 - up**2) * np.cos(about), np.sqrt(1 - up**2) * np.sin(about),
                             up])  # fmt: skip
    turns = []
    for way in along:
        across = np.cross(way, np.eye(3)[np.argmin(np.abs(way))])
        across /= np.linalg.norm(across)
        turns.append(np.array([across, np.cross(way, across), way]))
    return turns


def carved(body: trimesh.Trimesh, count: int) -> CarvedSurface:
    """Carve by views all round; the body's corners tell where."""
    views = [view_of(body, turn) for turn in all_round(count)]
    return carve(CAMERA, views, np.asarray(body.vertices))


def outside_box(points: np.ndarray) -> np.ndarray:
    """Return how far points are outside of the box, m: closed form; inside it is negative."""
    beyond = np.abs(points) - BOX_HALF_M
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    return outside + np.minimum(beyond.max(axis=1), 0.0)


def mesh_of(surface: CarvedSurface) -> trimesh.Trimesh:
    """Return it in another library's hands."""
    return trimesh.Trimesh(surface.vertices, surface.faces, process=False)


def test_a_ball_is_left_with_no_more_on_it_than_views_have_gaps():
    surface = carved(BALL, 60)
    mesh = mesh_of(surface)
    away = np.linalg.norm(surface.vertices, axis=1) - RADIUS_M
    grain_m = PIXEL_M + surface.step_m  # half a pixel either way, and lines within a cell
    # Each view touches a circle a right angle from it. A place is off the next circle by half a
    # gap at most, sqrt(4 pi / 60) / 2 = 13 deg, where the cone round it stands off by its secant.
    gap_m = RADIUS_M * (1.0 / np.cos(0.5 * np.sqrt(4.0 * np.pi / 60.0)) - 1.0)
    assert away.min() > -grain_m
    assert away.max() < gap_m + grain_m
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(BALL.volume, rel=3.0 * grain_m / RADIUS_M)
    assert mesh.volume > 0.0  # outside is seen counter-clockwise


def test_more_views_bring_a_box_nearer_to_itself_and_none_cuts_into_it():
    excess = []
    for count in (20, 66):  # of neither is a view let pass
        surface = carved(BOX, count)
        away = outside_box(surface.vertices)
        grain_m = PIXEL_M + surface.step_m
        assert away.min() > -grain_m
        excess.append(mesh_of(surface).volume / BOX.volume - 1.0)
    assert away.max() < grain_m
    assert excess[1] < 0.5 * excess[0]
    assert abs(excess[1]) < BOX.area * grain_m / BOX.volume


def test_a_shadow_that_eats_a_part_of_few_outlines_leaves_no_mark():
    views = [view_of(BALL, turn) for turn in all_round(140)]
    views[70] = View(views[70].R_cam_from_target, views[70].t_cam_from_target,
                     views[70].covered & (np.arange(300) < 150))  # fmt: skip
    surface = carve(CAMERA, views, np.asarray(BALL.vertices))
    away = np.linalg.norm(surface.vertices, axis=1) - RADIUS_M
    assert away.min() > -(PIXEL_M + surface.step_m)


def test_views_from_one_side_or_too_few_say_how_many_are_missing():
    views = [view_of(BALL, turn) for turn in all_round(12)]
    with pytest.raises(NoSurface, match="expected 20 silhouettes or more, got 12; give 8 more"):
        carve(CAMERA, views, np.asarray(BALL.vertices))
    half = [
        view_of(BALL, Rotation.from_rotvec([0.0, np.deg2rad(angle), 0.0]).as_matrix())
        for angle in np.linspace(0.0, 50.0, 30)
    ]
    with pytest.raises(NoSurface, match="102 deg apart or more, got 50 deg by 30 images; give 31"):
        carve(CAMERA, half, np.asarray(BALL.vertices))
    with pytest.raises(NoSurface, match="points of the target, got none"):
        carve(CAMERA, [view_of(BALL, turn) for turn in all_round(30)], np.zeros((0, 3)))


def test_points_outside_of_the_hull_go_unless_they_err_as_much():
    surface = carved(BALL, 60)
    points = np.array([[0.0, 0.0, RADIUS_M], [0.0, 0.0, 2.2], [0.0, 2.2, 0.0], [0.1, 0.0, 0.0]])
    cloud = Cloud(points, np.array([0.01, 0.01, 0.4, 0.01]))
    assert cleaned_cloud(cloud, surface).points.tolist() == points[[0, 2, 3]].tolist()
