"""The retroreflectors of ``scalar_rgb``: a coverage times a closed form, against the JIT's BSDF."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from models.arrays import Radiance
from models.camera import Camera
from models.lights.led_beam import LAMPS_800, LAMPS_850
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.tracing.light_groups import NIR800, NIR850, LampGroup, LightGroup, SunGroup
from tests.support.small_scenes import LAMBERT, camera_at, discs, needs_jit, plate, run_python

CAMERA = Camera(width=48, height=48, fx=1700.0, fy=1700.0, cx=23.5, cy=23.5)
POSE = camera_at(np.array([0.0, 0.0, 2.0]))
MARKERS = discs(np.array([[0.003, -0.002, 0.004]]), 0.0127)
GROUPS: list[LightGroup] = [
    LampGroup("lamps_800", LAMPS_800, NIR800),
    LampGroup("lamps_850", LAMPS_850, NIR850),
    SunGroup("sun", (0.0, 0.6, 0.8)),
]
SAMPLES = 1024
SUM_RATIO = 1e-3
"""Of two renderings' light over the disc: 1024 stratified samples leave 2e-4 (measured)."""
CENTRE_PX = 6e-3
"""Between their centroids; measured 2.8e-3: scalar variants see a cube at 8 x 8 places a pixel."""
PROGRAM = """
import numpy as np
from renders.variant.choice import activate
activate("scalar_rgb")
from tests.renders.tracing.test_marker_lobes import light
np.savez("scalar.npz", **light())
"""


def light() -> dict[str, Radiance]:
    """Return the groups from the variant that is active."""
    from tests.support.small_scenes import rendered

    craft = plate(LAMBERT, 0.5, MARKERS)
    optics = RetroreflectorOptics()
    return rendered(craft, CAMERA, POSE, GROUPS, 16, optics=optics, marker_samples=SAMPLES)


@pytest.fixture(scope="module")
def jit() -> dict[str, Radiance]:
    needs_jit()
    return light()


@pytest.fixture(scope="module")
def scalar(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Radiance]:
    folder = tmp_path_factory.mktemp("scalar")
    done = run_python(PROGRAM, folder)
    assert done.returncode == 0, done.stderr
    return dict(np.load(folder / "scalar.npz"))


def centroid(image: Radiance) -> np.ndarray:
    v, u = np.mgrid[: image.shape[0], : image.shape[1]]
    return np.array([(image * u).sum(), (image * v).sum()]) / image.sum()


@pytest.mark.parametrize("group", ["lamps_800", "lamps_850", "sun"])
def test_scalar_and_jit_agree_on_a_disc(
    group: str, jit: dict[str, Radiance], scalar: dict[str, Radiance]
) -> None:
    assert scalar[group].sum() == pytest.approx(jit[group].sum(), rel=SUM_RATIO)
    if group != "sun":  # it lights the plate as brightly as the disc: no centre to compare
        assert np.abs(centroid(scalar[group]) - centroid(jit[group])).max() < CENTRE_PX


def test_the_disc_returns_the_link_budget(scalar: dict[str, Radiance]) -> None:
    """On average: rho A I / (pi sin^2 psi d^2), all LEDs 3 cm off at 2 m being in the lobe."""
    optics = RetroreflectorOptics()
    psi = np.deg2rad(optics.half_angle_deg)
    on_axis = optics.returned.nir850 * LAMPS_850.intensity_w_sr / (np.pi * np.sin(psi) ** 2) / 4.0
    obliqueness = 0.02  # and the cube's blurred edges
    light = scalar["lamps_850"] - np.median(scalar["lamps_850"])
    disc_px = np.pi * (MARKERS.radius_m * CAMERA.fx / 1.996) ** 2
    assert light.sum() / disc_px == pytest.approx(on_axis, rel=obliqueness)


def test_a_disc_that_shows_its_back_returns_nothing(tmp_path: Path) -> None:
    program = PROGRAM.replace(
        "from tests.renders.tracing.test_marker_lobes import light",
        "import tests.renders.tracing.test_marker_lobes as t\n"
        "t.MARKERS.normals_in_target[:] *= -1.0\n"
        "t.SAMPLES = 64\n"
        "from tests.renders.tracing.test_marker_lobes import light",
    )
    done = run_python(program, tmp_path)
    assert done.returncode == 0, done.stderr
    assert np.load(tmp_path / "scalar.npz")["lamps_850"].max() < 1.0
