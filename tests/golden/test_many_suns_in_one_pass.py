"""Thirty-six Suns in one pass are thirty-six renderings: the same light, and the same bits.

The view is the real Maxar-1300. Renderings of other seeds, one Sun at a time, agree by the
golden-image statistic for each pixel, block and whole frame; those of the same seed are identical,
because a pixel's random numbers do not depend on the lights.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from models.arrays import Radiance
from renders.scenario.scenario import RenderRequest, resolve
from renders.tracing.light_groups import SunGroup
from renders.world.build import world_of
from tests.support.image_statistics import same_image
from tests.support.small_scenes import needs_jit

TIME_S, WIDTH, SAMPLES, SEEDS = 150.0, 64, 16, 8
SOME = (0, 5, 9, 14)
"""Of the 36, from the front: statistics for each would take a minute and tell no more."""


def suns() -> list[SunGroup]:
    """Return 36 directions spread over the sphere by the golden angle."""
    number = np.arange(36)
    height = 1.0 - (2.0 * number + 1.0) / 36.0
    angle = number * np.pi * (3.0 - np.sqrt(5.0))
    flat = np.sqrt(1.0 - height**2)
    directions = np.stack([flat * np.cos(angle), flat * np.sin(angle), height], axis=1)
    return [SunGroup(f"sun_{n}", (x, y, z)) for n, (x, y, z) in enumerate(directions.tolist())]


@pytest.fixture(scope="module")
def renderings() -> tuple[dict[str, Radiance], dict[str, Radiance], dict[str, Radiance]]:
    """Return (seed, height, width) radiance by Sun: all in one pass, alone, alone otherwise."""
    needs_jit()
    from renders.tracing.radiance import Sampling, render_radiance
    from renders.tracing.scene import build_geometry, place_chaser

    world = world_of(resolve(RenderRequest("maxar-approach", Path("unused"), width=WIDTH)))
    geometry = build_geometry(world.target, world.chaser, world.optics)
    scene, pose = geometry.scene(), world.trajectory.cam_from_target(TIME_S)
    place_chaser(scene, geometry, pose)

    def rendered(groups: list[SunGroup], seed: int) -> dict[str, Radiance]:
        depth = world.scenario.render.max_depth
        sampling = Sampling(SAMPLES, SAMPLES, depth, seed)
        return render_radiance(scene, geometry, world.camera, pose, groups, None, sampling)

    every = suns()
    together = [rendered(every, seed) for seed in range(SEEDS)]
    chosen = [every[number] for number in SOME]
    alone, otherwise = (
        [
            {name: image for sun in chosen for name, image in rendered([sun], seed).items()}
            for seed in seeds
        ]
        for seeds in (range(1), range(100, 100 + SEEDS))
    )
    return tuple(  # type: ignore[return-value]
        {name: np.array([images[name] for images in runs]) for name in runs[0]}
        for runs in (together, alone, otherwise)
    )


@pytest.mark.parametrize("number", SOME)
def test_a_sun_in_company_is_the_sun_alone(
    number: int,
    renderings: tuple[dict[str, Radiance], dict[str, Radiance], dict[str, Radiance]],
) -> None:
    together, alone, otherwise = (run[f"sun_{number}"] for run in renderings)
    np.testing.assert_array_equal(together[0], alone[0])
    verdict = same_image(together, otherwise)
    assert verdict, str(verdict)
    assert not same_image(together, 1.1 * otherwise)


def test_all_thirty_six_differ(
    renderings: tuple[dict[str, Radiance], dict[str, Radiance], dict[str, Radiance]],
) -> None:
    together, _, _ = renderings
    assert len(together) == 36
    means = np.array([image.mean() for image in together.values()])
    assert len(np.unique(means)) == 36
