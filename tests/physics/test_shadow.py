"""Shadows fall where geometry says, and are as soft as the Sun is wide."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from models.arrays import Floats
from models.camera import CAMERAS, Camera
from models.lights.sun import ANGULAR_DIAMETER_DEG, PASSBAND_IRRADIANCE_W_M2, sun_direction
from models.materials import MATERIALS
from models.pose import RigidTransform
from models.spacecraft.chaser import chaser
from models.spacecraft.part import Part, Spacecraft
from renders.tracing.light_groups import SunGroup
from tests.support.small_scenes import LAMBERT, activate_best, camera_at, plate, rendered

HALF_A_PERCENT = 5e-3  # the bench's promise for closed forms
FINER = 8  # how much finer than the image the expected shadow is drawn


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    activate_best()


def lit_radiance(elevation_sine: float = 1.0) -> float:
    rho = MATERIALS[LAMBERT].diffuse.sunlight
    return rho * PASSBAND_IRRADIANCE_W_M2 * elevation_sine / np.pi


# Penumbra


def visible_share(offset: Floats) -> Floats:
    """Return the share of a unit disc beyond a straight edge at ``offset`` from its centre."""
    x = np.clip(offset, -1.0, 1.0)
    return np.asarray(0.5 + (x * np.sqrt(1.0 - x**2) + np.arcsin(x)) / np.pi)


@pytest.mark.parametrize("height_m", [5.0, 40.0])
def test_a_penumbra_is_as_wide_as_distance_times_the_suns_diameter(height_m: float) -> None:
    """The Sun overhead, an edge above: from full shadow to full light in h x 0.533 deg."""
    fast = activate_best() != "scalar_rgb"
    width_m = height_m * 2.0 * np.tan(np.deg2rad(0.5 * ANGULAR_DIAMETER_DEG))
    roof = trimesh.creation.box((1000.0, 1000.0, 1e-3)).apply_translation([-500.0, 0.0, height_m])
    floor = plate(LAMBERT, 10.0 * width_m)
    scene = Spacecraft("roof", (*floor.parts, Part("roof", roof, LAMBERT)), None, np.zeros(3))
    range_m = 0.9 * height_m  # the camera hangs below the roof: nothing stands in its way
    camera = Camera.from_fov(64, 64, 2.0 * float(np.rad2deg(np.arctan(width_m / range_m))))
    pose = camera_at(np.array([0.0, 0.0, range_m]))
    sun = SunGroup("sun", (0.0, 0.0, 1.0))
    image = rendered(scene, camera, pose, [sun], samples=64 if fast else 16)["sun"]
    profile = image.mean(axis=0, dtype=np.float64) / lit_radiance()
    x_m = (np.arange(64) - camera.cx) / camera.fx * range_m  # two penumbrae wide
    expected = visible_share(x_m / (0.5 * width_m))
    # 4096 samples of the disc a column scatter by 0.8 % at most; without a JIT the Sun walks
    # over its disc in 16 steps, each a sixteenth of the light.
    tolerance = 4.0 * 0.008 if fast else 1.0 / 16.0
    np.testing.assert_allclose(profile, expected, atol=tolerance)
    assert (profile[x_m < -0.55 * width_m] == 0.0).all()
    np.testing.assert_allclose(profile[x_m > 0.55 * width_m], 1.0, rtol=HALF_A_PERCENT)


# The chaser's shadow


def part_shadows(
    towards: Floats, camera: Camera, cam_from_target: RigidTransform
) -> list[NDArray[np.uint8]]:
    """Draw each part's triangles, thrown on the plane z = 0, by OpenCV, finer than the image."""
    fine = camera.resized(camera.width * FINER)
    target_from_cam = cam_from_target.inverse()
    shadows = []
    for part in chaser().parts:
        shadow = np.zeros((fine.height, fine.width), dtype=np.uint8)
        corners = target_from_cam @ part.mesh.vertices
        thrown = corners - towards * (corners[:, 2:] / towards[2])
        pixels = fine.project(cam_from_target @ thrown)
        for triangle in pixels[part.mesh.faces]:
            cv2.fillConvexPoly(shadow, np.rint(triangle).astype(np.int32), 1)
        shadows.append(shadow)
    return shadows


def tilted_sun(tilt_deg: float) -> Floats:
    return np.array([0.0, -np.sin(np.deg2rad(tilt_deg)), np.cos(np.deg2rad(tilt_deg))])


@pytest.mark.parametrize(
    ("range_m", "tilt_deg"), [(6.0, 0.0), (2.0, 0.0), (6.0, 15.0)], ids=["far", "near", "aside"]
)
def test_the_chaser_throws_its_shadow_where_geometry_says(range_m: float, tilt_deg: float) -> None:
    """With the Sun straight behind (S1), the middle of what the camera sees lies in its shadow."""
    if tilt_deg == 0.0:
        np.testing.assert_allclose(tilted_sun(0.0), sun_direction("S1"), atol=1e-12)
    towards = tilted_sun(tilt_deg)
    camera = CAMERAS["chaser_fixed"].resized(96)
    pose = camera_at(np.array([0.1, -0.2, range_m]))
    sun = SunGroup("sun", (float(towards[0]), float(towards[1]), float(towards[2])))
    craft = chaser()
    image = rendered(plate(LAMBERT, 12.0), camera, pose, [sun], samples=16, chaser=craft)["sun"]
    light = image / lit_radiance(float(towards[2]))
    shadows = part_shadows(towards, camera, pose)
    # Half the penumbra at the far end of the chaser, and half a pixel, to either side.
    soft_m = (range_m + 1.7) / towards[2] * np.deg2rad(0.5 * ANGULAR_DIAMETER_DEG)
    reach = round(FINER * (soft_m * camera.fx / range_m + 0.75))
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
    # Part by part: between two that only touch in the middle of the Sun, its rim may shine.
    middle = np.s_[FINER // 2 :: FINER, FINER // 2 :: FINER]
    dark = np.any([cv2.erode(shadow, kernel)[middle] > 0 for shadow in shadows], axis=0)
    lit = np.all([cv2.dilate(shadow, kernel)[middle] == 0 for shadow in shadows], axis=0)
    assert dark.mean() > 0.01
    assert lit.mean() > 0.05
    assert (dark | lit).mean() > 0.5  # most of the image is decided
    np.testing.assert_array_equal(light[dark], 0.0)
    np.testing.assert_allclose(light[lit], 1.0, rtol=HALF_A_PERCENT)
    assert dark[camera.height // 2, camera.width // 2] == (tilt_deg == 0.0)


def test_the_body_is_1_2_m_wide_in_its_shadow() -> None:
    """Straight behind, at any range: the Sun's rays run side by side."""
    camera = CAMERAS["chaser_fixed"].resized(256)
    for range_m in (4.0, 6.0):
        pose = camera_at(np.array([0.0, 0.0, range_m]))
        craft = chaser()
        sun = SunGroup("sun", (0.0, 0.0, 1.0))
        image = rendered(plate(LAMBERT, 12.0), camera, pose, [sun], 4, chaser=craft)["sun"]
        row = image[round(camera.cy + 0.3 * camera.fx / range_m)]  # beside wings and grapple
        dark_m = (row < 0.5 * lit_radiance()).sum() * range_m / camera.fx
        a_pixel_each_side = 2.0 * range_m / camera.fx
        assert dark_m == pytest.approx(1.2, abs=a_pixel_each_side)
