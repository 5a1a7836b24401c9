"""Light of the Earth: a closed form on a plate, a picture behind it, glossy and matt alike."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import dblquad

from models.arrays import Radiance
from models.camera import Camera
from models.lights.earth import ALBEDO, GEO_RADIUS_KM, Earth, facing_share
from models.lights.sun import PASSBAND_IRRADIANCE_W_M2
from renders.tracing.light_groups import EarthGroup
from tests.support.image_statistics import same_image
from tests.support.small_scenes import (
    FACING,
    LAMBERT,
    activate_best,
    camera_at,
    needs_jit,
    plate,
    rendered,
    run_python,
)

CAMERA = Camera(width=24, height=24, fx=60.0, fy=60.0, cx=11.5, cy=11.5)
HALF_PERCENT = 0.005
"""The closed form's promise; 1024 samples over 16 pixels leave 0.1 %."""
GIBBOUS = Earth((0.0, 0.0, 1.0), (0.0, 0.6, -0.8), GEO_RADIUS_KM, ALBEDO, PASSBAND_IRRADIANCE_W_M2)
LEO = replace(GIBBOUS, orbit_radius_km=6878.0)


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    activate_best()


def overhead(earth: Earth, material: str, samples: int = 1024) -> Radiance:
    """Return what a plate below the Earth sends to a camera above it; the Earth is behind that."""
    group = EarthGroup("earth", earth)
    pose = camera_at(np.array([0.0, 0.0, 5.0]))
    return rendered(plate(material, 40.0), CAMERA, pose, [group], samples)["earth"]


def irradiance_w_m2(earth: Earth) -> float:
    """Integrate the Earth's radiance over its disc, by quadrature, for a plate that faces it."""

    def integrand(polar: float, azimuth: float) -> float:
        sine, cosine = np.sin(polar), np.cos(polar)
        direction = np.array([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine])
        return float(earth.radiance(direction)) * cosine * sine

    edge = np.arcsin(earth.sine_of_radius)
    return float(dblquad(integrand, 0.0, 2.0 * np.pi, 0.0, edge, epsabs=1e-6)[0])


@pytest.mark.parametrize("earth", [GIBBOUS, LEO], ids=["geo", "leo"])
def test_a_matt_plate_under_the_earth(earth: Earth) -> None:
    grey = 0.5
    middle = overhead(earth, LAMBERT)[10:14, 10:14].mean()
    assert middle == pytest.approx(grey * irradiance_w_m2(earth) / np.pi, rel=HALF_PERCENT)


@pytest.mark.parametrize("earth", [GIBBOUS, LEO], ids=["geo", "leo"])
def test_what_is_told_on_board_of_its_light_is_what_falls_on_a_plate(earth: Earth) -> None:
    """The Earth is straight above, the Sun's rays come over it at a cosine of 0.8."""
    told = PASSBAND_IRRADIANCE_W_M2 * facing_share(0.8, earth.orbit_radius_km)
    assert told == pytest.approx(irradiance_w_m2(earth), rel=HALF_PERCENT)


def test_the_full_earth_far_off_is_a_lambert_sphere() -> None:
    """At phase zero its irradiance is 2/3 albedo E (R / r)^2 (Lambert 1760; Russell 1916)."""
    far = Earth((0.0, 0.0, 1.0), (0.0, 0.0, -1.0), 1e6, ALBEDO, PASSBAND_IRRADIANCE_W_M2)
    law = 2.0 / 3.0 * ALBEDO * PASSBAND_IRRADIANCE_W_M2 * far.sine_of_radius**2
    assert irradiance_w_m2(far) == pytest.approx(law, rel=HALF_PERCENT)


def test_a_mirror_shows_the_earth_as_the_sky_does() -> None:
    """What a nearly smooth mirror returns of a wide, even source is its reflectance."""
    from models.materials import MATERIALS

    full = replace(LEO, sun_dir_in_target=(0.0, 0.0, -1.0))
    middle = overhead(full, "optical_solar_reflector")[11:13, 11:13].mean()
    material = MATERIALS["optical_solar_reflector"]
    matt = material.diffuse.sunlight * irradiance_w_m2(full) / np.pi
    zenith = float(full.radiance(np.array([0.0, 0.0, 1.0])))
    two_percent = 0.02  # the lobe sees the Earth dim towards its limb, and loses little at 0.05
    assert middle == pytest.approx(matt + material.specular.sunlight * zenith, rel=two_percent)


def test_it_is_seen_where_nothing_hides_it_and_black_beside() -> None:
    """A camera that looks past a small plate at the Earth sees each pixel's own radiance."""
    group = EarthGroup(
        "earth",
        replace(GIBBOUS, direction_in_target=(0.0, 0.0, -1.0), sun_dir_in_target=(0.0, 0.6, 0.8)),
    )
    pose = camera_at(np.array([0.0, 0.0, 5.0]))
    image = rendered(plate(LAMBERT, 0.4), CAMERA, pose, [group], 64)["earth"]
    v, u = np.mgrid[0:24, 0:24]
    rays = CAMERA.rays(np.stack([u, v], axis=-1).reshape(-1, 2)) @ FACING
    expected = group.earth.radiance(rays).reshape(24, 24)
    inside = np.hypot(u - 11.5, v - 11.5) < 60.0 * np.tan(np.arcsin(GIBBOUS.sine_of_radius)) - 1.0
    behind = np.maximum(np.abs(u - 11.5), np.abs(v - 11.5)) < 2.0
    shown = inside & ~(np.maximum(np.abs(u - 11.5), np.abs(v - 11.5)) < 4.0)
    beside = np.hypot(u - 11.5, v - 11.5) > 60.0 * np.tan(np.arcsin(GIBBOUS.sine_of_radius)) + 1.0
    a_pixel_is_curved = 0.01 * expected.max()  # most at the terminator
    np.testing.assert_allclose(image[shown], expected[shown], atol=a_pixel_is_curved)
    np.testing.assert_array_equal(image[beside], 0.0)
    np.testing.assert_array_equal(image[behind], 0.0)  # the plate's dark side towards the camera


SCALAR_PROGRAM = """
import numpy as np
from renders.variant.choice import activate
activate("scalar_rgb")
from tests.physics.test_earthshine import glossy
np.save("scalar.npy", glossy(0))
"""


def glossy(first_seed: int) -> Radiance:
    """Return (seed, height, width) radiance of golden foil under the Earth, off to a side."""
    from models.spacecraft.retroreflector_optics import RetroreflectorOptics
    from renders.tracing.radiance import Sampling, render_radiance
    from renders.tracing.scene import build_geometry

    aside = replace(
        GIBBOUS, direction_in_target=(0.6, 0.0, 0.8), sun_dir_in_target=(0.6, 0.48, -0.64)
    )
    geometry = build_geometry(plate("mli_gold", 40.0), None, RetroreflectorOptics())
    scene, pose = geometry.scene(), camera_at(np.array([0.0, 0.0, 5.0]))
    group = EarthGroup("earth", aside)
    return np.array(
        [
            render_radiance(
                scene, geometry, CAMERA, pose, [group], None, Sampling(64, 64, 2, seed)
            )["earth"]
            for seed in range(first_seed, first_seed + 8)
        ]
    )


@pytest.mark.slow
def test_scalar_and_jit_show_the_same_earthshine(tmp_path: Path) -> None:
    needs_jit()
    done = run_python(SCALAR_PROGRAM, tmp_path)
    assert done.returncode == 0, done.stderr
    scalar = np.load(tmp_path / "scalar.npy")
    ours = glossy(100)
    verdict = same_image(ours, scalar)
    assert verdict, str(verdict)
    assert not same_image(ours, 1.02 * scalar)


def test_lobe_and_light_sampling_together_are_quieter_than_light_alone() -> None:
    """A mirror under the wide Earth of a low orbit: what the power heuristic is for."""
    needs_jit()
    few = overhead(LEO, "optical_solar_reflector", 16)[8:16, 8:16]
    tenth = 0.1
    assert few.std() < tenth * few.mean()
