"""Bounced light that is looked up is the light that is traced: between two plates, and bit by bit.

The peer is the path tracer, which holds its own against closed forms in ``tests/physics``.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import trimesh

from models.arrays import Radiance
from models.camera import Camera
from models.pose import RigidTransform
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.tracing.light_groups import LightGroup, SunGroup
from tests.support.small_scenes import LAMBERT, camera_at, needs_jit, plate

CAMERA = Camera.from_fov(32, 32, 30.0)
PATHS = 1 << 18
MEAN_OFF = 0.02  # of a wall's light over the floor: two standard errors of the tracer's, and cells
SUN = SunGroup("sun", (-0.8, 0.0, 0.6))
GRAZING = SunGroup("grazing", (-0.6, 0.64, 0.48))


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    needs_jit()


def corner(wall: str) -> Spacecraft:
    """Return a floor, and a wall on it that throws sunlight down."""
    mesh = trimesh.creation.box((0.02, 2.0, 1.0)).apply_translation([0.6, 0.0, 0.5])
    floor = plate(LAMBERT, 2.4)
    return Spacecraft("corner", (*floor.parts, Part("wall", mesh, wall)), None, np.zeros(3))


@cache
def built(wall: str) -> tuple[Any, Any, Any, RigidTransform]:
    from renders.tracing.bounced.bounced_light import BouncedLight
    from renders.tracing.scene import build_geometry

    pose = camera_at(np.array([0.0, 0.0, 3.0]))
    geometry = build_geometry(corner(wall), None, RetroreflectorOptics())
    bounced = BouncedLight.around(geometry, CAMERA, [pose], max_depth=4)
    return geometry.scene(), geometry, bounced, pose


def image(
    wall: str, groups: list[SunGroup], looked_up: bool, depth: int = 4, samples: int = 64
) -> dict[str, Radiance]:
    from renders.tracing.bounced.field import NO_FIELDS
    from renders.tracing.radiance import Sampling, render_radiance

    scene, geometry, bounced, pose = built(wall)
    fields = NO_FIELDS
    if looked_up:
        lights = {g.name: bounced.loaded(bounced.landed(g, PATHS, 1)) for g in groups}
        fields = bounced.with_chaser(lights, scene, pose, groups, PATHS, 2)
    sampling = Sampling(samples, samples, depth, seed=3, fields=fields)
    lit: list[LightGroup] = list(groups)
    return render_radiance(scene, geometry, CAMERA, pose, lit, None, sampling)


@pytest.mark.parametrize("wall", ["white_paint", "bare_aluminium", "mli_aluminium"])
def test_a_wall_throws_as_much_onto_the_floor_as_is_traced(wall: str) -> None:
    direct = image(wall, [SUN], looked_up=False, depth=1)["sun"]
    traced = image(wall, [SUN], looked_up=False, samples=1024)["sun"] - direct
    found = image(wall, [SUN], looked_up=True)["sun"] - direct
    floor = np.s_[4:28, 4:20]  # left of the wall, away from the image's and the plate's edges
    assert traced[floor].mean() > 0.02 * direct[floor].mean()
    assert found[floor].mean() == pytest.approx(traced[floor].mean(), rel=MEAN_OFF)


def test_no_bounced_light_is_made_where_there_is_none() -> None:
    """A convex body lights itself nowhere."""
    from renders.tracing.bounced.bounced_light import BouncedLight
    from renders.tracing.scene import build_geometry

    geometry = build_geometry(plate(LAMBERT), None, RetroreflectorOptics())
    pose = camera_at(np.array([0.0, 0.0, 3.0]))
    bounced = BouncedLight.around(geometry, CAMERA, [pose], max_depth=4)
    assert len(bounced.landed(SUN, PATHS, 1).cell) == 0


def test_equal_seeds_land_alike_and_others_elsewhere() -> None:
    bounced = built("white_paint")[2]
    one, same, other = (bounced.landed(SUN, 1 << 14, seed) for seed in (1, 1, 2))
    for name in one.CHANNELS:
        assert np.array_equal(getattr(one, name), getattr(same, name))
    assert not np.array_equal(one.direction, other.direction)


def test_a_sun_in_company_is_the_sun_alone() -> None:
    alone = image("bare_aluminium", [SUN], looked_up=True, samples=8)["sun"]
    both = image("bare_aluminium", [GRAZING, SUN], looked_up=True, samples=8)["sun"]
    assert np.array_equal(alone, both)


def test_what_landed_reads_back_from_its_image() -> None:
    from renders.tracing.bounced.photons import Landed

    landed = built("white_paint")[2].landed(SUN, 1 << 14, 1)
    back = Landed.of_channels(landed.channels())
    for name in landed.CHANNELS:
        assert np.array_equal(getattr(landed, name), getattr(back, name))
    nothing = Landed.of_channels(Landed.joined([]).channels())
    assert len(nothing.cell) == 0
