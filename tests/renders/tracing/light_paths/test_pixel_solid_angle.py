"""Places and solid angles of pixels in a kernel are the camera's own."""

from __future__ import annotations

import numpy as np
import pytest

from models.camera import Camera
from tests.support.small_scenes import needs_jit

BENT = Camera(64, 48, 60.0, 57.0, 30.0, 25.0, k1=-0.2, k2=0.03, p1=0.002, p2=-0.001, k3=0.01)
PLACE_PX = 1e-4  # single precision over 64 pixels
ANGLE = 1e-3  # of a solid angle: a pixel here is a degree wide, and not flat


@pytest.mark.parametrize("camera", [BENT, Camera.from_fov(64, 48, 40.0)])
def test_a_pixel_covers_what_its_corners_enclose(camera: Camera) -> None:
    needs_jit()
    import mitsuba as mi

    from renders.tracing.light_paths.pixel_solid_angle import projected_place, solid_angle

    pixels = np.array([[3.0, 4.0], [30.0, 25.0], [60.0, 40.0], [10.0, 44.0]])
    rays = camera.rays(pixels)
    x, y = (mi.Float(rays[:, k] / rays[:, 2]) for k in (0, 1))
    found = np.stack([np.array(each) for each in projected_place(camera, x, y)], axis=1)
    assert np.abs(found - pixels).max() < PLACE_PX
    half = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    corners = camera.rays((pixels[:, None] + half).reshape(-1, 2)).reshape(-1, 4, 3)
    across, along = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    expected = 0.5 * np.linalg.norm(np.cross(across, along), axis=1)
    assert np.array(solid_angle(camera, x, y)) == pytest.approx(expected, rel=ANGLE)
