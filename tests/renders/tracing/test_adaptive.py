"""Samples where the noise is: as noisy as asked, unbiased, and the same in any company."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import trimesh

from models.arrays import AnyArray, Radiance
from models.camera import Camera
from models.lights.sun import sun_direction
from models.pose import RigidTransform
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.tracing.light_groups import LightGroup, SunGroup
from renders.tracing.noise_limit import LEAST, Moments, NoiseLimit
from tests.support.small_scenes import LAMBERT, camera_at, needs_jit, plate

CAMERA = Camera.from_fov(40, 40, 40.0)
EVERYWHERE = np.arange(1600, dtype=np.uint32)
ELECTRONS = 300.0  # per W m-2 sr-1: sunlit grey is some 3000 e
READ_E, FULL_E = 12.0, 100_000.0
SEEDS = 24
NOISIER = 1.6  # than asked: half of this scene is outlines, of which four samples miss some
FOUR_SIGMA = 4.0


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    needs_jit()


def limit(share: float) -> NoiseLimit:
    return NoiseLimit(share, ELECTRONS, READ_E, FULL_E)


def sun(name: str) -> SunGroup:
    x, y, z = sun_direction(name)
    return SunGroup(name, (x, y, z))


@cache
def scene() -> tuple[Any, Any, RigidTransform]:
    """Return a plate with bars over it: outlines and shadows."""
    from renders.tracing.scene import build_geometry

    bars = [
        Part(
            f"bar{k}",
            trimesh.creation.box((0.13, 2.0, 0.1)).apply_translation([x, 0, 0.3]),
            LAMBERT,
        )
        for k, x in enumerate((-0.71, -0.13, 0.47))
    ]
    floor = plate(LAMBERT, 2.0)
    craft = Spacecraft("bars", (*floor.parts, *bars), None, np.zeros(3))
    geometry = build_geometry(craft, None, RetroreflectorOptics())
    return geometry.scene(), geometry.surfaces, camera_at(np.array([0.1, 0.05, 4.0]))


def traced(
    groups: list[LightGroup], share: float, seed: int, pixels: AnyArray = EVERYWHERE
) -> dict[str, Radiance]:
    from renders.tracing.adaptive import trace_to_noise
    from renders.tracing.group_integrator import Walk

    loaded, surfaces, pose = scene()
    walk = Walk(loaded, surfaces, CAMERA, pose, groups, 1)
    limits = {group.name: limit(share) for group in groups}
    return trace_to_noise(walk, pixels, (40, 40), limits, seed)


def converged() -> Radiance:
    from renders.tracing.group_integrator import trace_groups

    loaded, surfaces, pose = scene()
    group = sun("S2")
    return trace_groups(loaded, surfaces, CAMERA, pose, [group], EVERYWHERE, 4096, 1, 99)["S2"]


@pytest.mark.parametrize("share", [0.35, 1.0])
def test_pixels_are_as_noisy_as_asked_and_no_mean_is_off(share: float) -> None:
    images = np.stack([traced([sun("S2")], share, seed)["S2"] for seed in range(SEEDS)])
    truth = converged()
    signal = truth * ELECTRONS
    sigma = np.sqrt(signal + READ_E**2 + (0.01 * signal) ** 2)
    noise = (images - truth) * ELECTRONS / sigma
    assert np.sqrt((noise**2).mean()) < NOISIER * share
    whole = noise.mean(axis=1)
    assert abs(whole.mean()) < FOUR_SIGMA * whole.std(ddof=1) / np.sqrt(SEEDS)


def test_less_noise_costs_more_samples() -> None:
    some = np.array([0.5, 3.0, 0.0])
    pilot = Moments(np.array([10.0, 10.0, 0.0]), some, some)
    fine, coarse = limit(0.3).wanted(pilot), limit(1.0).wanted(pilot)
    assert (fine >= coarse).all()
    assert fine[1] > coarse[1] > coarse[0]
    assert fine[2] == LEAST


def test_what_is_far_beyond_the_full_well_is_left_alone() -> None:
    bright = np.array([10.0 * FULL_E / ELECTRONS])
    assert limit(0.3).wanted(Moments(bright, 0.1 * bright, bright)) == LEAST


def test_equal_bits_in_any_company() -> None:
    alone = traced([sun("S2")], 0.5, 7)["S2"]
    company = traced([sun("S5"), sun("S2"), sun("S7")], 0.5, 7)["S2"]
    assert np.array_equal(alone, company)


def test_equal_bits_however_many_lanes_are_walked_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    from renders.tracing import adaptive

    whole = traced([sun("S2")], 0.5, 7)["S2"]
    monkeypatch.setattr(adaptive, "LANES", 1 << 10)
    assert np.array_equal(whole, traced([sun("S2")], 0.5, 7)["S2"])
