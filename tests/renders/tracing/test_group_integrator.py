"""One pass for all lights must be as many passes, bit for bit, and its samples well spread."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from models.arrays import AnyArray, Radiance
from models.camera import Camera
from models.lights.led_beam import LAMPS_800, LAMPS_850
from models.lights.sun import sun_direction
from models.materials import MATERIALS
from models.pose import RigidTransform
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.tracing import group_integrator
from renders.tracing.group_integrator import MOST_LANES, lanes_per_pixel, trace_groups
from renders.tracing.light_groups import NIR800, NIR850, LampGroup, LightGroup, SunGroup
from renders.tracing.surface_table import SurfaceTable
from tests.support.small_scenes import LAMBERT, camera_at, discs, needs_jit, plate, rendered

CAMERA = Camera.from_fov(24, 16, 40.0)
EVERYWHERE = np.arange(24 * 16, dtype=np.uint32)
FOUR_SIGMA = 4.0  # once in 16,000 by chance; fixed seeds, so it never flickers
LITTLE_NOISE = 1.05  # in variance: what faint light left to chance may cost


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    needs_jit()


def sun(name: str, channel: int = 0) -> SunGroup:
    x, y, z = sun_direction(name)
    return SunGroup(f"sun_{name}_{channel}", (x, y, z), channel=channel)


LAMPS = LampGroup("lamps_850", LAMPS_850, NIR850)
OTHERS: list[LightGroup] = [sun("S1"), LampGroup("lamps_800", LAMPS_800, NIR800), sun("S7")]


@cache
def corner() -> tuple[Any, SurfaceTable, RigidTransform]:
    """Return a scene where light goes round: a plate, a wall, a rough mirror, two markers."""
    from renders.tracing.scene import build_geometry

    markers = discs(np.array([[0.3, 0.2, 0.01], [-0.2, -0.1, 0.01]]), 0.1)
    wall = trimesh.creation.box((0.1, 3.0, 2.0)).apply_translation([-1.0, 0.0, 1.0])
    mirror = trimesh.creation.icosphere(2, 0.3).apply_translation([0.5, -0.5, 0.3])
    floor = plate(LAMBERT, markers=markers)
    parts = (*floor.parts, Part("wall", wall, "mli_gold"), Part("ball", mirror, "bare_aluminium"))
    craft = Spacecraft("corner", parts, markers, np.zeros(3))
    geometry = build_geometry(craft, None, RetroreflectorOptics())
    return geometry.scene(), geometry.surfaces, camera_at(np.array([0.4, 0.1, 4.0]))


def traced(
    groups: list[LightGroup],
    pixels: AnyArray = EVERYWHERE,
    samples: int = 16,
    seed: int = 5,
    max_depth: int = 4,
) -> dict[str, Radiance]:
    scene, surfaces, pose = corner()
    return trace_groups(scene, surfaces, CAMERA, pose, groups, pixels, samples, max_depth, seed)


# Faint light


@cache
def frames(faint: float) -> AnyArray:
    """Return what three lights give under many seeds, (seeds, lights, pixels), W m-2 sr-1."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(group_integrator, "FAINT", faint)
        found = [traced([sun("S1"), sun("S6"), LAMPS], seed=seed) for seed in range(48)]
    return np.stack([np.stack(list(images.values())) for images in found]).astype(np.float64)


@pytest.mark.parametrize("faint", [group_integrator.FAINT, 10.0])
def test_faint_light_left_to_chance_is_right_on_average(faint: float) -> None:
    """Beside every shadow ray cast; a tenfold threshold leaves nearly all of them to chance."""
    certain, by_chance = frames(0.0), frames(faint)
    difference = (by_chance - certain).mean(axis=2)
    spread = difference.std(axis=0, ddof=1) / np.sqrt(len(difference))
    assert (spread > 0.0).all()
    assert (spread < 0.005 * certain.mean(axis=(0, 2))).all()
    assert (np.abs(difference.mean(axis=0)) < FOUR_SIGMA * spread).all()


def test_faint_light_left_to_chance_adds_little_noise() -> None:
    certain, by_chance = (
        frames(faint).var(axis=0, ddof=1) for faint in (0.0, group_integrator.FAINT)
    )
    ratio = by_chance.sum(axis=1) / certain.sum(axis=1)
    assert (ratio < LITTLE_NOISE).all()


# Independence


def test_a_group_does_not_depend_on_its_company() -> None:
    together = traced([OTHERS[0], sun("S2"), *OTHERS[1:], LAMPS])
    for group in (sun("S2"), LAMPS, *OTHERS):
        alone = traced([group])[group.name]
        assert alone.max() > 0.0
        np.testing.assert_array_equal(alone, together[group.name])


@pytest.mark.parametrize("samples", [4, 9, 16, 64, 256])
def test_a_pixel_does_not_depend_on_the_others_that_are_traced(samples: int) -> None:
    whole = traced([sun("S2"), LAMPS], samples=samples)
    some = np.random.default_rng(1).permutation(EVERYWHERE)[:60]
    part = traced([sun("S2"), LAMPS], pixels=some, samples=samples)
    for name, image in whole.items():
        np.testing.assert_array_equal(image[some], part[name])


def test_the_same_seed_gives_the_same_bits_and_another_does_not() -> None:
    first, again, other = (traced([sun("S2")], seed=seed)["sun_S2_0"] for seed in (5, 5, 6))
    np.testing.assert_array_equal(first, again)
    noisy = first > 0.0
    # Where no bounce returns and nothing is cut, light does not depend on the sample.
    assert (first[noisy] != other[noisy]).mean() > 0.5


def test_neighbouring_seeds_and_pixels_are_independent() -> None:
    """A correlated generator would lay a pattern over the image, or shift it from seed to seed."""
    stack = np.array([traced([sun("S2")], seed=seed)["sun_S2_0"] for seed in range(16)])
    lively = stack.std(axis=0) > 0.02 * stack.mean()
    scores = (stack[:, lively] - stack[:, lively].mean(axis=0)) / stack[:, lively].std(axis=0)
    assert lively.sum() > 50
    neighbours = (scores[:, 1:] * scores[:, :-1]).mean()
    following = (scores[1:] * scores[:-1]).mean() + 1.0 / len(stack)  # the mean was taken from both
    for correlation in (neighbours, following):
        assert abs(correlation) < 4.0 / np.sqrt(scores.size)


def test_a_few_kernels_serve_all_seeds() -> None:
    """A kernel takes half a second to compile: it must not know the seed as a literal."""
    import drjit as dr

    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        for seed in range(1000, 1012):
            traced([sun("S2")], seed=seed)
        kernels = [one for one in dr.kernel_history() if one["type"] == dr.KernelType.JIT]
    # The same trace may come out in a few orders of its variables; twelve seeds are not twelve.
    assert len({kernel["hash"] for kernel in kernels}) <= 6


# Linearity


def test_light_is_linear_to_the_bit() -> None:
    """Doubling is exact in floating point, so it must be exact here."""
    one = sun("S2")
    two = replace(one, name="two", irradiance_w_m2=2.0 * one.irradiance_w_m2)
    images = traced([one, two])
    np.testing.assert_array_equal(2.0 * images[one.name], images["two"])


def test_each_group_sees_the_reflectance_of_its_own_band() -> None:
    groups: list[LightGroup] = [sun("S1", channel) for channel in range(3)]
    pose = camera_at(np.array([0.0, 0.0, 3.0]))
    images = rendered(plate(LAMBERT), CAMERA, pose, groups, samples=4)
    rho = MATERIALS[LAMBERT].diffuse.bands
    for channel in (1, 2):
        ratio = images[f"sun_S1_{channel}"] / images["sun_S1_0"]
        np.testing.assert_allclose(ratio, rho[channel] / rho[0], rtol=1e-5)


def test_a_light_below_the_floor_gives_nothing() -> None:
    below = SunGroup("below", (0.0, 0.0, -1.0))
    assert (traced([below], max_depth=1)["below"] == 0.0).all()


# Samples


@given(st.integers(1, 80).map(lambda side: side * side), st.sampled_from([1, 16]))
def test_samples_are_shared_evenly_among_lanes(samples: int, least: int) -> None:
    shares = lanes_per_pixel(samples, least)
    assert samples % shares == 0
    assert shares & (shares - 1) == 0  # a power of two
    assert shares == 1 or samples // shares >= least
    more = 2 * shares
    assert samples % more or samples // more < least or more > MOST_LANES  # none idles for nothing


@pytest.mark.parametrize(("samples", "shares"), [(9, 1), (16, 16), (36, 4), (256, 16), (4096, 16)])
def test_lanes_of_the_samples_in_use(samples: int, shares: int) -> None:
    assert lanes_per_pixel(samples) == shares


@pytest.mark.parametrize("samples", [8, 16, 64, 256])
def test_samples_are_stratified_over_the_pixel_however_they_are_shared(samples: int) -> None:
    """An edge through a column of pixels: only the strip that it cuts is left to chance.

    Sobol points, a power of two of them, put one into each of ``samples`` strips, so the share
    covered scatters by ``sqrt(p (1 - p)) / samples``, not by ``sqrt(c (1 - c) / samples)``; one
    strip visited twice or left out would show.
    """
    from renders.tracing.scene import build_geometry

    camera = Camera.from_fov(9, 200, 3.0)
    cut = 0.37  # of a pixel, from its left side
    reach = 10.0
    per_pixel = reach / camera.fx
    left_edge = (4.0 - 0.5 + cut - camera.cx) * per_pixel  # within column 4
    half = trimesh.creation.box((2.0, 20.0, 0.02))
    half.apply_translation([left_edge + 1.0, 0.0, -0.01])
    craft = Spacecraft("half", (Part("half", half, LAMBERT),), None, np.zeros(3))
    geometry = build_geometry(craft, None, RetroreflectorOptics())
    pixels = np.arange(9 * 200, dtype=np.uint32)
    light = SunGroup("sun", (0.0, 0.0, 1.0), angular_diameter_deg=1e-3)
    scene, pose = geometry.scene(), camera_at([0, 0, reach])
    image = trace_groups(scene, geometry.surfaces, camera, pose, [light], pixels, samples, 1, 3)
    covered = (image["sun"] / image["sun"].max()).reshape(200, 9)
    np.testing.assert_array_equal(covered[:, :4], 0.0)
    np.testing.assert_allclose(covered[:, 5:], 1.0, rtol=1e-5)
    within = (cut * samples) % 1.0
    expected = np.sqrt(within * (1.0 - within)) / samples
    four_sigma = 4.0 / np.sqrt(2 * 200)
    assert covered[:, 4].std() == pytest.approx(expected, rel=four_sigma)
    assert covered[:, 4].mean() == pytest.approx(1.0 - cut, abs=4.0 * expected / np.sqrt(200))
