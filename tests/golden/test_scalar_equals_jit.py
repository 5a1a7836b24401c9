"""One light, two renderers: Mitsuba's own emitters in ``scalar_rgb``, and our one-pass integrator.

They share the scene and nothing else: one is a C++ path tracer with directional and spot lights,
rendered one by one; the other our own loop over light groups, compiled. The view is the real
Maxar-1300 with the chaser in place, 150 s into the approach.

Calibrated by the null (16 seeds of the JIT variant against 16 others, 16 samples): no pixel and no
block beyond Sidak's bound, heavy tails only make Student's t more careful; so none is allowed.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from models.arrays import Radiance
from renders.scenario.scenario import RenderRequest, resolve
from renders.tracing.light_groups import LightGroup
from renders.world.build import world_of
from renders.world.world import World
from tests.support.image_statistics import same_image
from tests.support.small_scenes import needs_jit, run_python

TIME_S, WIDTH, SAMPLES, SEEDS = 150.0, 64, 9, 8
SCALAR_PROGRAM = """
import sys
import numpy as np
from renders.variant.choice import activate
activate("scalar_rgb")
from tests.golden.test_scalar_equals_jit import renderings
np.save("scalar.npy", renderings(0))
"""


def lights(world: World) -> list[LightGroup]:
    return [world.sun, world.lamps(850)]


def renderings(first_seed: int) -> Radiance:
    """Return (group, seed, height, width) radiance from the variant that is active."""
    from renders.tracing.radiance import Sampling, render_radiance
    from renders.tracing.scene import build_geometry, place_chaser

    request = RenderRequest("maxar-approach", Path("unused"), sun="S2", width=WIDTH)
    world = world_of(resolve(request))
    geometry = build_geometry(world.target, world.chaser, world.optics)
    scene = geometry.scene()
    pose = world.trajectory.cam_from_target(TIME_S)
    place_chaser(scene, geometry, pose)
    groups = lights(world)
    images = []
    for seed in range(first_seed, first_seed + SEEDS):
        # The scalar renderer walks over the Sun's disc in passes, each with a seed of its own.
        sampling = Sampling(SAMPLES, SAMPLES, world.scenario.render.max_depth, seed=1000 * seed)
        rendered = render_radiance(scene, geometry, world.camera, pose, groups, None, sampling)
        images.append([rendered[group.name] for group in groups])
    return np.moveaxis(np.array(images), 1, 0)


@pytest.fixture(scope="module")
def jit() -> Radiance:
    needs_jit()
    return renderings(100)


@pytest.fixture(scope="module")
def scalar(tmp_path_factory: pytest.TempPathFactory) -> Radiance:
    needs_jit()
    folder = tmp_path_factory.mktemp("scalar")
    done = run_python(SCALAR_PROGRAM, folder)
    assert done.returncode == 0, done.stderr
    return np.asarray(np.load(folder / "scalar.npy"))


@pytest.mark.parametrize("group", [0, 1], ids=["sun_S2", "lamps_850"])
def test_scalar_and_jit_render_the_same_light(group: int, jit: Radiance, scalar: Radiance) -> None:
    verdict = same_image(jit[group], scalar[group])
    assert verdict, str(verdict)


@pytest.mark.parametrize("group", [0, 1], ids=["sun_S2", "lamps_850"])
def test_the_null_raises_no_alarm(group: int, jit: Radiance) -> None:
    """Seeds of one renderer against others of its own: what the verdicts above stand on."""
    verdict = same_image(jit[group, ::2], jit[group, 1::2])
    assert verdict, str(verdict)


@pytest.mark.parametrize(("group", "gain"), [(0, 1.03), (1, 1.1)], ids=["sun_S2", "lamps_850"])
def test_a_wrong_gain_would_be_seen(
    group: int, gain: float, jit: Radiance, scalar: Radiance
) -> None:
    assert not same_image(jit[group], gain * scalar[group])


def test_a_sun_without_its_shadows_would_be_seen(jit: Radiance, scalar: Radiance) -> None:
    """Light where the other renderer has shadow: a tenth of the lit level in dark pixels."""
    lit = float(np.percentile(scalar[0], 90))
    dark = scalar[0].mean(axis=0) < 0.01 * lit
    assert dark.any()
    assert not same_image(jit[0], scalar[0] + np.float32(0.1 * lit) * dark)
