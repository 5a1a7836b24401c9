"""Lambert's phase law: how the light of a matt sphere falls as less of its lit side is seen.

``I(a) = (2/3) rho E R^2 (sin a + (pi - a) cos a) / pi`` at phase angle a (Lambert 1760; Russell
1916, Astrophys. J. 43, 173): 1 at full phase, 1/pi at half. It holds geometry, shading at the
terminator, and the Sun's and the camera's radiometry at once.
"""

import numpy as np
import pytest

from models.arrays import Floats
from models.camera import Camera
from models.lights.sun import PASSBAND_IRRADIANCE_W_M2
from models.materials import MATERIALS
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.solids import mesh_of
from renders.tracing.light_groups import LightGroup, SunGroup
from tests.support.small_scenes import LAMBERT, activate_best, camera_at, rendered

RADIUS_M, RANGE_M = 1.0, 4000.0  # so far that its near side is no larger for it
PHASES_DEG = (0.0, 20.0, 45.0, 70.0, 90.0, 110.0, 130.0, 150.0)
HALF_A_PERCENT = 5e-3  # the bench's promise for closed forms
THIN_CRESCENT = 1e-2  # past 140 degrees, for facets of 1 degree and a Sun half as wide


def sphere(smooth: bool) -> Spacecraft:
    import trimesh

    ball = trimesh.creation.icosphere(6, RADIUS_M)
    mesh = mesh_of(ball.vertices, ball.faces)
    if smooth:
        mesh.vertex_normals = ball.vertices / RADIUS_M
    return Spacecraft("moon", (Part("moon", mesh, LAMBERT, smooth),), None, np.zeros(3))


@pytest.fixture(scope="module", params=[True, False], ids=["smooth", "faceted"])
def intensities(request: pytest.FixtureRequest) -> Floats:
    """Return the intensity at each phase angle, W/sr, one render for all Suns."""
    activate_best()
    camera = Camera.from_fov(64, 64, 2.2 * np.rad2deg(np.arctan(RADIUS_M / RANGE_M)))
    angles = np.deg2rad(PHASES_DEG)
    suns: list[LightGroup] = [
        SunGroup(f"sun_{number}", (0.6 * np.sin(a), -0.8 * np.sin(a), np.cos(a)))
        for number, a in enumerate(angles)
    ]
    pose = camera_at(np.array([0.0, 0.0, RANGE_M]))
    images = rendered(sphere(request.param), camera, pose, suns, samples=36)
    pixel_sr = 1.0 / (camera.fx * camera.fy)
    return np.array(
        [images[sun.name].sum(dtype=np.float64) * pixel_sr * RANGE_M**2 for sun in suns]
    )


def test_follows_lamberts_law(intensities: Floats) -> None:
    angle = np.deg2rad(PHASES_DEG)
    law = (np.sin(angle) + (np.pi - angle) * np.cos(angle)) / np.pi
    rho = MATERIALS[LAMBERT].diffuse.sunlight
    expected = 2.0 / 3.0 * rho * PASSBAND_IRRADIANCE_W_M2 * RADIUS_M**2 * law
    ratio = intensities / expected
    thin = angle > np.deg2rad(140.0)
    np.testing.assert_allclose(ratio[~thin], 1.0, atol=HALF_A_PERCENT)
    np.testing.assert_allclose(ratio[thin], 1.0, atol=THIN_CRESCENT)


def test_new_moon_is_dark_but_for_the_suns_limb() -> None:
    activate_best()
    camera = Camera.from_fov(32, 32, 2.2 * np.rad2deg(np.arctan(RADIUS_M / RANGE_M)))
    behind = SunGroup("sun", (0.0, 0.0, -1.0))
    pose = camera_at(np.array([0.0, 0.0, RANGE_M]))
    image = rendered(sphere(False), camera, pose, [behind], samples=16)["sun"]
    full = MATERIALS[LAMBERT].diffuse.sunlight * PASSBAND_IRRADIANCE_W_M2 / np.pi
    # The disc reaches 0.27 degrees round the limb and is seen at a cosine of less than 0.005.
    assert image.max() < 5e-3 * full
