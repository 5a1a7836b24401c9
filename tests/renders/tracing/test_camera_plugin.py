"""A lit dot must be found where ``Camera.project`` says.

This one test pins the calibration matrix, handedness, pixel origin and principal point.
"""

from dataclasses import replace

import cv2
import numpy as np
import pytest
import trimesh

from models.camera import Camera
from models.pose import RigidTransform
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.tracing.light_groups import SunGroup
from renders.truth.pixel_truth import outline_centres_px
from tests.support.small_scenes import FACING, LAMBERT, activate_best, camera_at, discs, rendered

TWO_HUNDREDTHS_PX = 0.02  # the bench's promise over the whole image
# 200 whole pixels in a disc, in or out by their centres: the 50 on the rim move its centroid by
# 0.06 px, 1 sigma. A half-pixel mistake is eight of those.
A_QUARTER_PX = 0.25
STRAIGHT = Camera(192, 160, 300.0, 300.0, 100.3, 75.8)
OBLONG = replace(STRAIGHT, fy=285.0)
BENT = replace(OBLONG, k1=-0.22, k2=0.11, p1=1e-3, p2=-8e-4, k3=-0.02)
STRONG = Camera(192, 160, 96.0, 96.0, 95.5, 79.5, k1=0.2)  # 90 deg across


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    activate_best()


def dots(camera: Camera, cam_from_target: RigidTransform) -> np.ndarray:
    """Return dot centres on the plane z = 0 that fill the image, its corners too."""
    u = np.linspace(9, camera.width - 10, 6)
    v = np.linspace(9, camera.height - 10, 5)
    pixels = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    target_from_cam = cam_from_target.inverse()
    rays = target_from_cam.rotate(camera.rays(pixels))
    lens = target_from_cam.translation
    return lens - rays * (lens[2] / rays[:, 2])[:, None]


def dotted(points: np.ndarray, radius_m: float) -> Spacecraft:
    """Return matt white discs that face +z: under one Sun all have one radiance."""
    disc = trimesh.creation.cylinder(radius_m, 1e-4, sections=96)
    disc.apply_translation([0.0, 0.0, -0.5e-4])
    parts = tuple(Part("dots", disc.copy().apply_translation(p), LAMBERT) for p in points)
    return Spacecraft("dots", parts, None, np.zeros(3))


def area_centroid(image: np.ndarray, around: np.ndarray, reach: int) -> np.ndarray:
    """Return the centroid of light in a window about a pixel."""
    column, row = np.rint(around).astype(int)
    left, top = max(column - reach, 0), max(row - reach, 0)
    patch = image[top : row + reach + 1, left : column + reach + 1]
    v, u = np.mgrid[0 : patch.shape[0], 0 : patch.shape[1]]
    return np.array([left + (u * patch).sum() / patch.sum(), top + (v * patch).sum() / patch.sum()])


@pytest.mark.parametrize(
    "camera", [STRAIGHT, OBLONG, BENT, STRONG], ids=["straight", "oblong", "bent", "strong"]
)
def test_a_lit_dot_lands_where_project_says(camera: Camera) -> None:
    turn = RigidTransform(FACING, np.zeros(3)).perturbed([0.05, -0.04, 0.3], np.zeros(3)).rotation
    cam_from_target = camera_at([0.1, -0.2, 3.0], turn)
    points = dots(camera, cam_from_target)
    radius_m = 4.0 * 3.0 / camera.fx  # 4 px: a smaller disc's centroid is drawn to whole pixels
    light = SunGroup("sun", (0.0, 0.0, 1.0))
    image = rendered(dotted(points, radius_m), camera, cam_from_target, [light], 1024)["sun"]
    expected = outline_centres_px(discs(points, radius_m), camera, cam_from_target)
    found = np.array([area_centroid(image, pixel, reach=8) for pixel in expected])
    assert np.abs(found - expected).max() < TWO_HUNDREDTHS_PX


def test_a_lens_that_nearly_folds_gets_the_steps_it_needs() -> None:
    """Newton's method slows down towards the fold: one step count for all is wrong there."""
    from renders.tracing.camera_plugin import ray_direction_in_cam, undistort_steps

    corner = float(np.hypot(96.0, 80.0)) / STRAIGHT.fx
    share = 1.0 + 1e-9  # of the corner's distance at which the lens folds, two thirds of it undone
    nearly = replace(STRAIGHT, cx=95.5, cy=79.5, k1=-4.0 / 27.0 / (share * corner) ** 2)
    assert undistort_steps(BENT) == undistort_steps(STRONG) == 8
    assert undistort_steps(nearly) > 8
    pixels = nearly.spread_px()
    rays = np.array(
        [np.array(ray_direction_in_cam(nearly, u, v)).ravel() for u, v in pixels.tolist()]
    )
    at_the_fold = 2e-3  # there the way back has half the seven digits of single precision
    np.testing.assert_allclose(rays, nearly.rays(pixels), atol=at_the_fold)


def test_mitsuba_own_integrator_sees_the_same_dots_through_the_sensor() -> None:
    """The sensor plugin serves bare Mitsuba renders and the pixel truth: same pixels again."""
    from renders.tracing.scene import build_geometry
    from renders.truth.pixel_truth import pixel_truth

    for camera in (STRAIGHT, BENT):
        cam_from_target = camera_at([0.0, 0.0, 3.0])
        points = dots(camera, cam_from_target)[[7, 8, 13, 22]]
        target = dotted(points, 8.0 * 3.0 / camera.fx)
        geometry = build_geometry(target, None, RetroreflectorOptics())
        truth = pixel_truth(geometry.scene(), geometry, camera, cam_from_target)
        lit = (truth.labels == geometry.labels.index("dots") + 1).astype(float)
        expected = camera.project(cam_from_target @ points)
        found = np.array([area_centroid(lit, pixel, reach=12) for pixel in expected])
        assert np.abs(found - expected).max() < A_QUARTER_PX
        depths = truth.depth_m[lit > 0]
        np.testing.assert_allclose(depths, 3.0, atol=1e-4)


def test_outline_centres_agree_with_opencv_moments() -> None:
    turn = RigidTransform(FACING, np.zeros(3)).perturbed([0.4, -0.3, 0.3], np.zeros(3)).rotation
    cam_from_target = camera_at([0.1, -0.2, 3.0], turn)
    markers = discs(np.array([[0.1, -0.2, 0.0], [0.3, 0.3, 0.0]]), 0.15)
    ours = outline_centres_px(markers, STRAIGHT, cam_from_target)
    angle = np.linspace(0.0, 2.0 * np.pi, 4096, endpoint=False)
    rim = 0.15 * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    for centre, point in zip(ours, markers.points_in_target, strict=True):
        outline = STRAIGHT.project(cam_from_target @ (point + rim)).astype(np.float32)
        moments = cv2.moments(outline[:, None, :])
        theirs = np.array([moments["m10"], moments["m01"]]) / moments["m00"]
        single_precision_px = 2e-3  # OpenCV takes the outline as float32
        np.testing.assert_allclose(centre, theirs, atol=single_precision_px)
        assert np.linalg.norm(centre - STRAIGHT.project(cam_from_target @ point)) > 0.1
