"""A view is placed where the light has it; blur and shadow are told from light."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.pose import RigidTransform
from pipelines.acquisition.image_part import cut_out
from pipelines.acquisition.light_likelihood import OF_SHADE, image_light, regime_of, told_light
from pipelines.acquisition.light_placing import coarse_light, placed
from pipelines.acquisition.lit_edges import LitEdges
from pipelines.acquisition.sunlit_views import seen_views
from pipelines.acquisition.surface_cloud import surface_cloud
from pipelines.acquisition.view_search import Hypothesis
from pipelines.detection.target_region import find_target
from pipelines.tracking.model_edges import ModelEdges
from tests.support.drawn_targets import CAMERA, DETECTOR, drawn, target

WIREFRAME = target()
CLOUD = surface_cloud(WIREFRAME)
RANGE_M = 14.0
FROM_SUN = (0.9, 0.1, -0.42)  # beside the camera: half of what shows is in shadow
SUN = np.array(FROM_SUN)
RADIUS_PX = CAMERA.fx * WIREFRAME.radius_m / RANGE_M
NEAR_PX, NEAR_SHARE = 0.12 * RADIUS_PX, 0.12  # a coarse cell and a half; a step of size


@pytest.mark.parametrize("unlit_dn", [5.0, 1500.0])  # the Sun alone; the Earth as bright as it
@pytest.mark.parametrize("off", [(0.25, 0.8), (-0.2, 1.25)])
def test_a_view_is_placed_where_it_is(unlit_dn: float, off: tuple[float, float]) -> None:
    """From a quarter of a radius beside and a quarter too near or far."""
    seen = seen_views(WIREFRAME, 6.0, 250)
    rotation = seen.rotations[31]
    truth = RigidTransform(rotation, np.array([0.0, 0.0, RANGE_M]))
    image = drawn(WIREFRAME, truth, sun_in_cam=FROM_SUN, seed=3, unlit_dn=unlit_dn)
    cut = cut_out(image, CAMERA, DETECTOR, 1024)
    aside, size = off
    start = RigidTransform(rotation, np.array([aside * WIREFRAME.radius_m, 0.0, RANGE_M * size]))
    light = image_light(cut.target, RADIUS_PX)
    found = placed(
        coarse_light(light, RADIUS_PX),
        cut.camera,
        seen,
        Hypothesis(31, start, 0.0),
        SUN,
        WIREFRAME.radius_m,
    ).cam_from_target
    away = CAMERA.project(found.translation[None]) - CAMERA.project(truth.translation[None])
    assert np.linalg.norm(away) < NEAR_PX
    assert abs(np.log(found.translation[2] / RANGE_M)) < NEAR_SHARE


def test_what_lights_the_shade_is_told_from_the_image() -> None:
    pose = RigidTransform(
        Rotation.from_rotvec([0.4, 0.7, -0.3]).as_matrix(), np.array([0.0, 0.0, RANGE_M])
    )

    def regime(unlit_dn: float) -> int:
        image = drawn(WIREFRAME, pose, sun_in_cam=FROM_SUN, seed=1, unlit_dn=unlit_dn)
        light = image_light(find_target(image, DETECTOR), RADIUS_PX)
        return regime_of(light, told_light(light, CLOUD, CAMERA, pose, SUN))

    assert regime(0.0) == 0
    assert regime(1500.0) == len(OF_SHADE) - 1


def test_what_is_lit_ends_at_a_bright_edge_and_faint_faces_stay() -> None:
    """The blur of a square of half of the well and a face of 4 DN of its own beside it."""
    pixels = np.zeros((128, 128), dtype=np.float32)
    pixels[50:70, 40:60] = 2000.0
    pixels[50:70, 60:90] = 4.0
    rng = np.random.default_rng(2)
    noisy = cv2.GaussianBlur(pixels, (0, 0), 0.5) + rng.normal(0.0, 0.6, pixels.shape)
    image = np.maximum(np.rint(noisy + DETECTOR.bias_dn), 0.0).astype(np.uint16)
    camera = CAMERA.resized(128)
    cut = cut_out(image, camera, DETECTOR, 128)
    first = np.array([camera.cx - cut.camera.cx, camera.cy - cut.camera.cy]).astype(int)
    row, column = np.nonzero(cut.target.lit)
    assert row.min() + first[1] >= 49
    assert column.min() + first[0] >= 39
    faint = cut.target.lit[52 - first[1] : 68 - first[1], 66 - first[0] : 88 - first[0]]
    assert faint.mean() > 0.95


def test_no_step_is_due_inside_a_shadow() -> None:
    """Every edge that is due lies at light: a Sun behind the target leaves none of its front."""
    pose = RigidTransform(
        Rotation.from_rotvec([0.4, 0.7, -0.3]).as_matrix(), np.array([0.0, 0.0, RANGE_M])
    )

    def due(towards: tuple[float, float, float]) -> float:
        sun = np.array(towards) / np.linalg.norm(towards)
        image = drawn(WIREFRAME, pose, sun_in_cam=towards, seed=1, unlit_dn=0.0)
        light = image_light(find_target(image, DETECTOR), RADIUS_PX)
        edges = LitEdges(ModelEdges(WIREFRAME), CLOUD, light, sun)
        samples = edges.edges.shown(CAMERA, pose)
        return len(edges.due(samples, edges.told(CAMERA, pose))) / len(samples)

    assert due((0.15, -0.1, -1.0)) > due((0.95, 0.1, 0.2)) + 0.2
