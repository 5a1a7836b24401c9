"""Shadows of what is thin, far from the origin, where 32 bits are few; no surface shades itself.

A solar cell's cover is a millimetre high and a wing's tip 14 m off. In ``scalar_rgb`` Mitsuba's own
path tracer starts its shadow rays up to 1.3 mm off the surface there, so this is for the JIT.
"""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from models.camera import Camera
from models.lights.sun import PASSBAND_IRRADIANCE_W_M2
from models.materials import MATERIALS
from models.spacecraft.part import Part, Spacecraft
from renders.tracing.light_groups import SunGroup
from tests.support.small_scenes import LAMBERT, camera_at, needs_jit, rendered

HALF_A_PERCENT = 5e-3
A_TENTH_OF_A_MILLIMETRE = 1e-4
FAR = np.array([-3.0, 13.5, 4.0])  # near a wing's tip


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    needs_jit()


def lit(sine: float) -> float:
    return MATERIALS[LAMBERT].diffuse.sunlight * PASSBAND_IRRADIANCE_W_M2 * sine / np.pi


def part(name: str, size: tuple[float, float, float], centre: tuple[float, float, float]) -> Part:
    mesh = trimesh.creation.box(size).apply_translation(FAR + np.array(centre))
    return Part(name, mesh, LAMBERT)


@pytest.mark.parametrize("height_m", [5e-4, 1e-3, 2e-3])
def test_a_step_of_a_millimetre_throws_its_shadow(height_m: float) -> None:
    """The Sun at 45 degrees: the shadow is as long as the step is high."""
    floor = part("floor", (1.0, 1.0, 0.02), (0.0, 0.0, -0.01))
    step = part("step", (0.5, 1.0, height_m), (-0.25, 0.0, 0.5 * height_m))
    scene = Spacecraft("step", (floor, step), None, np.zeros(3))
    camera = Camera(width=128, height=8, fx=2500.0, fy=2500.0, cx=31.5, cy=3.5)  # 0.08 mm a pixel
    pose = camera_at(FAR + np.array([0.0, 0.0, 0.2]))
    sun = SunGroup("sun", (-np.sqrt(0.5), 0.0, np.sqrt(0.5)), angular_diameter_deg=1e-3)
    image = rendered(scene, camera, pose, [sun], 64)["sun"].mean(axis=0, dtype=np.float64)
    dark_m = (1.0 - image[31:] / lit(np.sqrt(0.5))).sum() * 0.2 / camera.fx
    assert dark_m == pytest.approx(height_m, abs=A_TENTH_OF_A_MILLIMETRE)


@pytest.mark.parametrize("elevation_deg", [90.0, 30.0, 5.0, 1.0])
def test_a_flat_surface_far_off_does_not_shade_itself(elevation_deg: float) -> None:
    """Tilted, so that no coordinate is exact; every pixel is lit as the closed form says."""
    turn = trimesh.transformations.rotation_matrix(0.7, [0.6, -0.5, 0.3])
    mesh = trimesh.creation.box((2.0, 2.0, 0.02)).apply_translation([0.0, 0.0, -0.01])
    mesh.apply_transform(turn)
    mesh.apply_translation(FAR)
    scene = Spacecraft("plate", (Part("plate", mesh, LAMBERT),), None, np.zeros(3))
    tilt = turn[:3, :3]
    facing = tilt @ np.diag([1.0, -1.0, -1.0])
    pose = camera_at(FAR + tilt @ np.array([0.0, 0.0, 3.0]), facing.T)
    camera = Camera(width=48, height=48, fx=90.0, fy=90.0, cx=23.5, cy=23.5)
    elevation = np.deg2rad(elevation_deg)
    x, y, z = (tilt @ np.array([np.cos(elevation), 0.0, np.sin(elevation)])).tolist()
    image = rendered(
        scene, camera, pose, [SunGroup("sun", (x, y, z), angular_diameter_deg=1e-3)], 16
    )
    np.testing.assert_allclose(image["sun"], lit(np.sin(elevation)), rtol=HALF_A_PERCENT)
