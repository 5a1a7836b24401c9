"""A Lambertian plate has radiance rho E / pi, whatever the renderer.

Every other light in the bench is built on these two: the Sun's and a lamp's inverse square.
"""

import numpy as np
import pytest

from models.arrays import AnyArray
from models.camera import Camera
from models.lights.led_beam import LAMPS_800, LAMPS_850
from models.lights.sun import PASSBAND_IRRADIANCE_W_M2, direction_from_azimuth
from models.materials import MATERIALS
from renders.tracing.light_groups import NIR800, NIR850, LampGroup, LightGroup, SunGroup
from tests.support.small_scenes import LAMBERT, activate_best, camera_at, plate, rendered

HALF_A_PERCENT = 5e-3  # the bench's promise for closed forms


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    activate_best()


def blocks(image: AnyArray) -> AnyArray:
    """Return means over blocks of 8 x 8 pixels."""
    return np.asarray(image.reshape(4, 8, 4, 8).mean(axis=(1, 3)))


def sun(azimuth_deg: float, elevation_deg: float) -> SunGroup:
    x, y, z = direction_from_azimuth(azimuth_deg, elevation_deg)
    return SunGroup("sun", (x, y, z))


@pytest.mark.parametrize("elevation_deg", [90.0, 45.0, 10.0])
def test_sunlit_plate_has_the_closed_form_radiance(elevation_deg: float) -> None:
    camera = Camera.from_fov(32, 32, 20.0)
    light = sun(270.0, elevation_deg)
    image = rendered(plate(LAMBERT), camera, camera_at([0, 0, 3.0]), [light], samples=4)["sun"]
    rho = MATERIALS[LAMBERT].diffuse.sunlight
    expected = rho * PASSBAND_IRRADIANCE_W_M2 * np.sin(np.deg2rad(elevation_deg)) / np.pi
    # At grazing incidence a sample's place on the Sun's disc matters to it; blocks average that.
    np.testing.assert_allclose(blocks(image), expected, rtol=HALF_A_PERCENT)


def test_sun_below_the_plate_leaves_it_black() -> None:
    camera = Camera.from_fov(16, 16, 20.0)
    image = rendered(plate(LAMBERT), camera, camera_at([0, 0, 3.0]), [sun(270.0, -60.0)], 4)["sun"]
    assert (image == 0.0).all()


@pytest.mark.parametrize("range_m", [1.8, 6.7])
@pytest.mark.parametrize("band", [800, 850])
def test_lamplit_plate_has_the_closed_form_radiance(range_m: float, band: int) -> None:
    camera = Camera.from_fov(32, 32, 30.0)
    ring, channel = (LAMPS_800, NIR800) if band == 800 else (LAMPS_850, NIR850)
    groups: list[LightGroup] = [LampGroup("lamps", ring, channel)]
    pose = camera_at([0, 0, range_m])
    image = rendered(plate(LAMBERT, 20.0), camera, pose, groups, samples=256)["lamps"]
    v, u = np.mgrid[0:32, 0:32].reshape(2, -1)
    rays = camera.rays(np.stack([u, v], axis=1))
    points_in_cam = rays * (range_m / rays[:, 2:])
    irradiance = ring.irradiance(points_in_cam, np.tile([0.0, 0.0, -1.0], (len(rays), 1)))
    reflectance = MATERIALS[LAMBERT].diffuse
    rho = reflectance.nir800 if band == 800 else reflectance.nir850
    expected = (rho * irradiance / np.pi).reshape(32, 32)
    # Each pixel chooses among eight LEDs; over blocks that noise is far below the promise.
    np.testing.assert_allclose(blocks(image / expected), 1.0, atol=HALF_A_PERCENT)
