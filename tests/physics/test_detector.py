"""In the marker windows the renderer's noise must drown in the detector's own.

Otherwise a centroid's scatter would tell of samples, not of the camera. Only the windows' pixels
are rendered here, at the full 2048 x 2048 and with the samples of the case.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.arrays import Floats
from models.markers import MarkerPattern
from models.pose import RigidTransform
from renders.detector.expose import electron_rate, mean_electrons
from renders.scenario.scenario import RenderRequest, resolve
from renders.tracing.light_groups import LightGroup
from renders.world.build import world_of
from renders.world.world import World
from tests.support.small_scenes import needs_jit

ALLOWED = 0.3  # of the detector's noise, rms over a window


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    needs_jit()


@pytest.fixture(scope="module")
def world() -> World:
    return world_of(resolve(RenderRequest("maxar-approach", Path("unused"), sun="S2")))


@pytest.fixture(scope="module")
def geometry(world: World) -> Any:
    from renders.tracing.scene import build_geometry

    return build_geometry(world.target, world.chaser, world.optics)


@pytest.fixture(scope="module")
def scene(geometry: Any) -> Any:
    return geometry.scene()


def chosen(world: World, names: tuple[str, ...]) -> MarkerPattern:
    markers = world.target.markers
    assert markers is not None
    rows = [markers.names.index(name) for name in names]
    return MarkerPattern(
        names, markers.points_in_target[rows], markers.normals_in_target[rows], markers.radius_m
    )


def window_charge(
    world: World,
    scene: Any,
    surfaces: Any,
    markers: MarkerPattern,
    pose: RigidTransform,
    time_s: float,
    seed: int,
) -> Floats:
    """Return the mean charge, e, of an 850 nm exposure lit in these markers' windows alone.

    They get the samples that ``renders.tracing.radiance`` gives them.
    """
    from renders.tracing.group_integrator import trace_groups
    from renders.tracing.radiance import NEAR_SAMPLES, marker_pixels, marker_windows

    camera, render = world.camera, world.scenario.render
    groups: list[LightGroup] = [world.sun, world.lamps(850)]
    images = {group.name: np.zeros(camera.width * camera.height, np.float32) for group in groups}
    near, edge = marker_pixels(markers, camera, pose, marker_windows(markers, camera, pose))
    for pixels, samples, lit in (
        (near, NEAR_SAMPLES, groups),
        (edge, render.marker_samples, groups[1:]),
    ):
        depth = render.max_depth
        traced = trace_groups(scene, surfaces, camera, pose, lit, pixels, samples, depth, seed)
        for name, light in traced.items():
            images[name][pixels] = light
    light = {group: images[group.name].reshape(camera.height, -1) for group in groups}
    optics, detector = world.scenario.simulated_optics, world.scenario.simulated_detector
    exposure_ms = world.plan.before_any_image(time_s, world.onboard(0).prior)
    rate = electron_rate(light, optics, detector)
    return mean_electrons(rate, exposure_ms, camera, optics, detector)


@pytest.mark.parametrize(
    ("time_s", "names"),
    [
        pytest.param(0.0, ("1", "4", "8", "10"), id="far"),
        pytest.param(320.0, ("8", "10"), id="near", marks=pytest.mark.slow),
    ],
)
def test_monte_carlo_noise_is_below_a_third_of_the_detectors(
    world: World, geometry: Any, scene: Any, time_s: float, names: tuple[str, ...]
) -> None:
    """Two seeds differ by sqrt(2) times the noise of one; each window is judged on its own.

    Near the end #8 and #10 have most of it, of the eight markers that are left.
    """
    from renders.tracing.radiance import marker_windows
    from renders.tracing.scene import place_chaser

    pose = world.trajectory.cam_from_target(time_s)
    place_chaser(scene, geometry, pose)
    markers = chosen(world, names)
    first, second = (
        window_charge(world, scene, geometry.surfaces, markers, pose, time_s, seed)
        for seed in (1, 2)
    )
    rendered = (first - second) / np.sqrt(2.0)
    own = np.sqrt(first + world.scenario.detector.read_noise_e**2)
    windows = marker_windows(markers, world.camera, pose)
    assert len(windows) == len(names)
    for left, top, width, height in windows:
        window = np.s_[top : top + height, left : left + width]
        assert first[window].max() > 0.2 * world.scenario.detector.full_well_e  # it is lit
        ratio = np.sqrt((rendered[window] ** 2).mean() / (own[window] ** 2).mean())
        assert 0.0 < ratio < ALLOWED
