"""The link budget that a lighting engineer would first put on paper must come out of the renderer.

What a retroreflector sends back, how it falls with range, what sunlight does beside it, and where
that puts the detector.
"""

import numpy as np
import pytest

from models.camera import CAMERAS
from models.lights.led_beam import LAMPS_800, LAMPS_850
from models.lights.sun import PASSBAND_IRRADIANCE_W_M2
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector, Optics
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.detector.expose import electrons_per_radiance
from renders.tracing.light_groups import NIR800, NIR850, LampGroup
from tests.support.small_scenes import activate_best, camera_at, discs, plate, rendered

FIVE_PERCENT = 0.05  # the budget on paper ignores the ring's offset from the lens
DISC = discs([[0.0, 0.0, 0.01]], 0.0127)


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    activate_best()


def marker_radiance(range_m: float, band: int = 850) -> float:
    """Mean radiance of a marker's disc on the boresight, rendered; the cube's is not even."""
    camera = CAMERAS["chaser_fixed"].resized(1024)
    small = type(camera)(65, 65, camera.fx, camera.fy, 32.0, 32.0)
    ring, channel = (LAMPS_850, NIR850) if band == 850 else (LAMPS_800, NIR800)
    pose = camera_at([0.0, 0.0, 0.01 + range_m])
    target = plate("black_paint", 1.0, DISC)
    images = rendered(target, small, pose, [LampGroup("lamps", ring, channel)], 64)
    light = images["lamps"] - np.median(images["lamps"])
    return float(light.sum() / (np.pi * (DISC.radius_m * camera.fx / (range_m + 0.01)) ** 2))


@pytest.mark.parametrize(("range_m", "on_paper"), [(6.7, 42.0), (1.8, 580.0)])
def test_marker_radiance_is_what_the_budget_says(range_m: float, on_paper: float) -> None:
    assert LAMPS_850.intensity_w_sr == 12.0
    optics = RetroreflectorOptics()
    assert (optics.half_angle_deg, optics.returned.nir850) == (2.0, 0.6)
    assert marker_radiance(range_m) == pytest.approx(on_paper, rel=FIVE_PERCENT)


def test_marker_falls_as_the_inverse_square_per_pixel() -> None:
    ratio = marker_radiance(2.0) / marker_radiance(4.0)
    assert ratio == pytest.approx(4.0, rel=FIVE_PERCENT)


def test_marker_is_dark_at_800_nm() -> None:
    """The filter leaks 0.3 %; seen square on, the face's mirror part adds F D / 4."""
    optics = RetroreflectorOptics()
    lobe = 1.0 / (np.pi * np.sin(np.deg2rad(optics.half_angle_deg)) ** 2)
    mirror = optics.face.specular.nir800 / (4.0 * np.pi * optics.face.roughness**2)
    matt = optics.face.diffuse.nir800 / np.pi
    expected = (optics.returned.nir800 * lobe + mirror + matt) / (optics.returned.nir850 * lobe)
    ratio = marker_radiance(3.0, band=800) / marker_radiance(3.0, band=850)
    assert ratio < 0.02
    assert ratio == pytest.approx(expected, rel=FIVE_PERCENT)


def test_sunlit_grey_is_a_sixth_of_a_far_marker() -> None:
    grey = 0.3 * PASSBAND_IRRADIANCE_W_M2 / np.pi
    assert grey == pytest.approx(7.0, rel=FIVE_PERCENT)
    assert 4.0 < marker_radiance(6.7) / grey < 8.0


def test_the_exposure_schedule_keeps_a_boresight_marker_at_half_to_seventy_percent() -> None:
    from pathlib import Path

    from renders.scenario.scenario import RenderRequest, resolve
    from renders.world.build import world_of

    world = world_of(resolve(RenderRequest("maxar-approach", Path("unused"), rate_hz=0.02)))
    optics, detector = Optics(), Detector()
    assert world.scenario.simulated_detector == detector
    per_second = electrons_per_radiance(optics, detector, 850.0)
    for run in range(20):
        prior = world.onboard(run).prior
        for time_s in world.scenario.times_s:
            truth: RigidTransform = world.trajectory.cam_from_target(time_s)
            radiance = 0.6 / (np.pi * np.sin(np.deg2rad(2.0)) ** 2) * 12.0
            radiance /= truth.translation[2] ** 2
            charge = radiance * per_second * world.plan.before_any_image(time_s, prior) * 1e-3
            assert 0.5 <= charge / detector.full_well_e <= 0.7
