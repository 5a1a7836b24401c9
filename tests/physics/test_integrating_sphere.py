"""Light that goes round: in a hollow sphere every bounce is even, and the sum is a series.

Whatever a matt sphere's first light, what each bounce sends on falls evenly on all of it, so after
the direct light come ``rho Phi / A`` and its powers of ``rho`` (Ulbricht 1900).
"""

import numpy as np
import pytest
import trimesh

from models.camera import Camera
from models.lights.led_beam import LAMPS_850
from models.materials import MATERIALS
from models.spacecraft.part import Part, Spacecraft
from renders.tracing.light_groups import NIR850, LampGroup
from tests.support.small_scenes import LAMBERT, activate_best, camera_at, rendered

ONE_PERCENT = 0.01  # facets instead of a sphere, and 16 x 16 pixels of 1024 paths
RADIUS_M = 1.0


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    activate_best()


def mean_radiance(depth: int) -> float:
    shell = trimesh.creation.icosphere(4, RADIUS_M)
    hollow = Spacecraft("hollow", (Part("shell", shell, LAMBERT),), None, np.zeros(3))
    camera = Camera.from_fov(16, 16, 60.0)
    lamps = LampGroup("lamps", LAMPS_850, NIR850)
    pose = camera_at(np.array([0.1, 0.0, 0.2]))
    return float(rendered(hollow, camera, pose, [lamps], 1024, depth)["lamps"].mean())


@pytest.mark.parametrize("depth", [2, 4])
def test_bounces_add_up_to_the_integrating_sphere(depth: int) -> None:
    rho = MATERIALS[LAMBERT].diffuse.nir850
    flux_w = LAMPS_850.intensity_w_sr * 2.0 * np.pi / (LAMPS_850.exponent + 1.0)
    even = rho * flux_w / (4.0 * np.pi * RADIUS_M**2) / np.pi
    expected = even * sum(rho**bounce for bounce in range(1, depth))
    bounced = mean_radiance(depth) - mean_radiance(1)
    assert bounced == pytest.approx(expected, rel=ONE_PERCENT)
