"""Light found from both ends is the light found from the lens alone: bit by bit less noisy.

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

STRAIGHT = Camera.from_fov(32, 32, 30.0)
BENT = Camera(32, 32, 60.0, 57.0, 15.0, 16.0, k1=-0.2, p1=0.002)
PATHS = 1 << 18
FEW, MANY = 64, 2048
MEAN_OFF = 0.01  # of the floor's bounced light: three standard errors of both together
LESS_NOISE = 0.5  # of the squared error from the lens alone, by a wall of foil
SUN = SunGroup("sun", (-0.8, 0.0, 0.6))
GRAZING = SunGroup("grazing", (-0.6, 0.64, 0.48))
FLOOR = np.s_[4:28, 4:20]  # left of the wall, away from the image's and the plate's edges


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    needs_jit()


def corner(wall: str) -> Spacecraft:
    """Return a floor, and a wall on it that throws sunlight down."""
    mesh = trimesh.creation.box((0.02, 2.0, 1.0)).apply_translation([0.6, 0.0, 0.5])
    floor = plate(LAMBERT, 2.4)
    return Spacecraft("corner", (*floor.parts, Part("wall", mesh, wall)), None, np.zeros(3))


def chaser_beside() -> Spacecraft:
    """Return a mirror beside the lens, in the camera's frame, that faces what the lens sees."""
    mesh = trimesh.creation.box((0.5, 2.0, 0.02)).apply_translation([0.6, 0.0, 0.0])
    return Spacecraft("chaser", (Part("wall", mesh, "white_paint"),), None, np.zeros(3))


@cache
def built(wall: str, camera: Camera, has_chaser: bool) -> tuple[Any, Any, Any, RigidTransform]:
    from renders.tracing.light_paths.sunlit import Sunlit
    from renders.tracing.scene import build_geometry, place_chaser

    pose = camera_at(np.array([0.0, 0.0, 3.0]))
    chaser = chaser_beside() if has_chaser else None
    geometry = build_geometry(corner(wall), chaser, RetroreflectorOptics())
    scene = geometry.scene()
    place_chaser(scene, geometry, pose)
    footprint = 9.0 / (camera.fx * camera.fy)
    return scene, geometry, Sunlit(geometry, camera, 4, footprint), pose


def image(
    wall: str,
    groups: list[SunGroup],
    way: str,
    camera: Camera = STRAIGHT,
    has_chaser: bool = False,
    depth: int = 4,
    samples: int = FEW,
    seed: int = 3,
) -> dict[str, Radiance]:
    from renders.tracing.light_paths.from_sun import NOTHING
    from renders.tracing.light_paths.to_lens import Landings
    from renders.tracing.radiance import Sampling, render_radiance

    scene, geometry, sunlit, pose = built(wall, camera, has_chaser)
    found = NOTHING
    if way == "once":
        once = {g: Landings.load(sunlit.landed(g, PATHS, seed)) for g in groups}
        found = sunlit.found(once, scene, pose, PATHS, seed)
    elif way == "now":
        found = sunlit.found_now(groups, scene, pose, PATHS, seed)
    sampling = Sampling(samples, samples, depth, seed, found=found)
    lit: list[LightGroup] = list(groups)
    return render_radiance(scene, geometry, camera, pose, lit, None, sampling)


@pytest.mark.parametrize(
    ("wall", "camera", "has_chaser", "way"),
    [
        ("white_paint", STRAIGHT, False, "once"),
        ("bare_aluminium", STRAIGHT, False, "now"),
        ("mli_aluminium", BENT, False, "once"),
        ("bare_aluminium", STRAIGHT, True, "once"),
        ("bare_aluminium", BENT, True, "now"),
    ],
)
def test_a_wall_throws_as_much_onto_the_floor_as_is_found_from_the_lens(
    wall: str, camera: Camera, has_chaser: bool, way: str
) -> None:
    common = {"camera": camera, "has_chaser": has_chaser}
    direct = image(wall, [SUN], "lens", **common, depth=1, samples=MANY)["sun"]
    traced = image(wall, [SUN], "lens", **common, samples=MANY)["sun"] - direct
    found = image(wall, [SUN], way, **common, samples=256, seed=4)["sun"] - direct
    assert traced[FLOOR].mean() > 0.02 * direct[FLOOR].mean()
    assert found[FLOOR].mean() == pytest.approx(traced[FLOOR].mean(), rel=MEAN_OFF)


def test_what_a_mirror_throws_is_less_noisy() -> None:
    wall = "mli_aluminium"
    truth = image(wall, [SUN], "once", samples=MANY, seed=9)["sun"]
    squared = {
        way: np.mean((image(wall, [SUN], way)["sun"] - truth)[FLOOR] ** 2)
        for way in ("lens", "once")
    }
    assert squared["once"] < LESS_NOISE * squared["lens"]


def test_nothing_lands_where_nothing_bounces() -> None:
    """A convex body lights itself nowhere."""
    from renders.tracing.light_paths.sunlit import Sunlit
    from renders.tracing.light_paths.to_lens import Landings
    from renders.tracing.scene import build_geometry

    geometry = build_geometry(plate(LAMBERT), None, RetroreflectorOptics())
    sunlit = Sunlit(geometry, STRAIGHT, 4, 1e-3)
    landed = sunlit.landed(SUN, PATHS, 1)
    assert len(landed) == 0
    pose = camera_at(np.array([0.0, 0.0, 3.0]))
    found = sunlit.found({SUN: Landings.load(landed)}, geometry.scene(), pose, PATHS, 1)
    assert not found.images["sun"].any()


def test_equal_seeds_land_alike_and_others_elsewhere() -> None:
    sunlit = built("white_paint", STRAIGHT, False)[2]
    one, same, other = (sunlit.landed(SUN, 1 << 14, seed) for seed in (1, 1, 2))
    assert np.array_equal(one.places, same.places)
    assert np.array_equal(one.power_w, same.power_w)
    assert not np.array_equal(one.places, other.places)


@pytest.mark.parametrize("way", ["once", "now"])
def test_a_sun_in_company_is_the_sun_alone(way: str) -> None:
    alone = image("bare_aluminium", [SUN], way, samples=8)["sun"]
    both = image("bare_aluminium", [GRAZING, SUN], way, samples=8)["sun"]
    assert np.array_equal(alone, both)


def test_what_landed_reads_back_from_its_image() -> None:
    from renders.tracing.light_paths.landed import Landed

    landed = built("white_paint", STRAIGHT, False)[2].landed(SUN, 1 << 14, 1)
    assert len(landed) > 100
    back = Landed.of_channels(landed.channels())
    for name in ("places", "direction", "power_w", "ratio"):
        assert np.array_equal(getattr(landed, name), getattr(back, name))
    assert len(Landed.of_channels(Landed.joined([]).channels())) == 0
