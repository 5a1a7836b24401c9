"""A store key changes with all that shapes the light, and with nothing that does not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.markers import MarkerPattern
from models.materials import MATERIALS, BandReflectance
from models.pose import RigidTransform
from models.spacecraft.part import Spacecraft
from renders.scenario.scenario import RenderRequest, Scenario, resolve
from renders.store import light_keys
from renders.store import radiance_store as store
from renders.store.light_keys import LightKeys, spacecraft_hash
from renders.tracing.light_groups import LampGroup, SunGroup
from renders.world.build import world_of
from renders.world.exposure import Exposure
from renders.world.world import World

EXPOSURE = Exposure(frame=2, band=850, time_s=100.0)


@cache
def plain() -> World:
    return world_of(resolve(RenderRequest("maxar-demo", Path("unused"))))


def world_with(**tables: Any) -> World:
    table = plain().scenario.model_dump()
    for name, values in tables.items():
        table[name] = table[name] | values if isinstance(values, dict) else values
    return world_of(Scenario(**table))


def keys_of(world: World, family: str = "jit", exposure: Exposure = EXPOSURE) -> dict[str, str]:
    """Return the keys of one exposure: each group's and the geometry's."""
    keys = LightKeys(world, family)
    pose = world.trajectory.cam_from_target(exposure.time_s)
    named = {group.name: keys.group(exposure, pose, group) for group in world.groups(exposure)}
    return {**named, "geometry": keys.geometry(exposure, pose)}


def test_the_same_light_has_the_same_key_in_any_process() -> None:
    assert keys_of(plain()) == keys_of(world_of(plain().scenario))
    assert len(set(keys_of(plain()).values())) == len(keys_of(plain()))


CHANGED: dict[str, dict[str, Any]] = {
    "samples": {"render": {"samples": 25}},
    "marker samples": {"render": {"marker_samples": 16}},
    "depth of paths": {"render": {"max_depth": 2}},
    "seed": {"render": {"seed": 2}},
    "columns": {"camera": {"width": 512}},
    "distortion": {"camera": {"k1": -1e-6}},
    "another camera": {"camera": {"preset": "eye_in_hand"}},
    "return lobe": {"retroreflector": {"half_angle_deg": 2.5}},
    "returned light": {"retroreflector": {"returned_850": 0.59}},
    "sway of the target": {"motion": {"target_wobble": False}},
}


@pytest.mark.parametrize("tables", CHANGED.values(), ids=CHANGED.keys())
def test_what_shapes_all_light_changes_every_key(tables: dict[str, Any]) -> None:
    before, after = keys_of(plain()), keys_of(world_with(**tables))
    assert before.keys() == after.keys()
    assert all(before[name] != after[name] for name in before)


UNCHANGED: dict[str, dict[str, Any]] = {
    "name": {"name": "other"},
    "description": {"description": "other words"},
    "lens": {"optics": {"f_number": 8.0, "psf_sigma_px": 1.0, "vignetting": False}},
    "chip": {"detector": {"read_noise_e": 5.0, "bits": 14, "blooming": 0.5}},
    "defocus and glare": {"optics": {"focus_m": 2.0, "veiling_glare": 0.05}},
    "scattered sunlight": {"lens_scatter": {"peak_1_sr": 10.0}},
    "particles": {"radiation": {"flux_cm2_s": 5.0}},
    "exposure": {"exposure": {"marker_fill": 0.5}},
    "metered exposure": {"exposure": {"mode": "auto"}},
    "prior": {"prior": {"sigma_t_m": (0.1, 0.1, 0.1)}},
    "calibration": {"calibration": {"sigma_focal_px": 1.0}},
    "clock": {"motion": {"rate_hz": 0.1, "start_s": 0.0, "end_s": 200.0, "pair_gap_ms": 20.0}},
}


@pytest.mark.parametrize("tables", UNCHANGED.values(), ids=UNCHANGED.keys())
def test_what_comes_after_light_changes_no_key(tables: dict[str, Any]) -> None:
    """Exposure, detector, noise and knowledge are chosen after rendering: nothing is traced anew.

    So is the clock, for an exposure of the same number at the same instant.
    """
    assert keys_of(plain()) == keys_of(world_with(**tables))


def test_the_sun_that_is_asked_for_leaves_the_other_groups_alone() -> None:
    """Seven Suns are one rendering: only what is new is traced."""
    before, after = keys_of(plain()), keys_of(world_with(sun={"default": "S5"}))
    assert before["lamps_850"] == after["lamps_850"]
    assert before["sun_S2"] not in after.values()
    assert after["sun_S5"] not in before.values()
    shared = keys_of(world_with(sun={"shared": ("S1", "S2", "S5")}))
    assert shared["sun_S2"] == before["sun_S2"]
    assert shared["sun_S5"] == after["sun_S5"]


def test_lamps_change_the_key_of_the_lamps_alone() -> None:
    before = keys_of(plain())
    for change in ({"intensity_w_sr": 13.0}, {"count": 9}, {"half_intensity_deg": 20.0}):
        after = keys_of(world_with(lamps=change))
        assert {name for name in before if before[name] != after[name]} == {"lamps_850"}


def test_pose_frame_band_and_family_change_keys() -> None:
    before = keys_of(plain())
    later = keys_of(plain(), exposure=replace(EXPOSURE, time_s=100.001))
    assert all(before[name] != later[name] for name in before)
    other_frame = keys_of(plain(), exposure=replace(EXPOSURE, frame=3))
    assert before["sun_S2"] != other_frame["sun_S2"]  # a frame has its own seed
    other_band = keys_of(plain(), exposure=replace(EXPOSURE, band=800))
    assert before["lamps_850"] not in other_band.values()
    assert before["sun_S2"] == other_band["sun_S2"]  # one pose, one Sun, one seed: one light
    scalar = keys_of(plain(), family="scalar")
    assert all(before[name] != scalar[name] for name in before)


def test_every_number_of_a_group_is_in_its_key() -> None:
    world, pose = plain(), plain().trajectory.cam_from_target(100.0)
    keys = LightKeys(world, "jit")

    def key(group: SunGroup | LampGroup) -> str:
        return keys.group(EXPOSURE, pose, group)

    lamps = world.lamps(850)
    others = [
        world.sun,
        replace(world.sun, name="another"),
        replace(world.sun, direction_in_target=(0.0, 0.0, 1.0)),
        replace(world.sun, irradiance_w_m2=75.0),
        replace(world.sun, angular_diameter_deg=0.5),
        replace(world.sun, channel=1),
        lamps,
        replace(lamps, channel=1),
        replace(lamps, ring=replace(lamps.ring, radius_m=0.031)),
        replace(lamps, ring=replace(lamps.ring, phase_deg=0.0)),
        replace(lamps, ring=replace(lamps.ring, wavelength_nm=851.0)),
    ]
    assert len({key(group) for group in others}) == len(others)


@pytest.mark.parametrize(
    ("module", "name"), [(light_keys, "PHYSICS_VERSION"), (store, "STORE_VERSION")]
)
def test_another_version_of_the_physics_or_the_store_renders_anew(
    module: Any, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = keys_of(plain())
    monkeypatch.setattr(module, name, getattr(module, name) + 1)
    after = keys_of(plain())
    assert all(before[name] != after[name] for name in before)


# Spacecraft


def with_part(craft: Spacecraft, **changes: Any) -> Spacecraft:
    return replace(craft, parts=(replace(craft.parts[0], **changes), *craft.parts[1:]))


def moved(craft: Spacecraft) -> Spacecraft:
    mesh = craft.parts[0].mesh.copy()
    mesh.vertices[0] += [1e-4, 0.0, 0.0]
    return with_part(craft, mesh=mesh)


def flipped(craft: Spacecraft) -> Spacecraft:
    mesh = craft.parts[0].mesh.copy()
    mesh.invert()
    return with_part(craft, mesh=mesh)


SPACECRAFT_CHANGES: dict[str, Callable[[Spacecraft], Spacecraft]] = {
    "a vertex": moved,
    "a face": flipped,
    "a name": lambda craft: with_part(craft, name="another"),
    "shading": lambda craft: with_part(craft, smooth=not craft.parts[0].smooth),
    "a material's name": lambda craft: with_part(craft, material="black_paint"),
    "a part less": lambda craft: replace(craft, parts=craft.parts[1:]),
}


@pytest.mark.parametrize("change", SPACECRAFT_CHANGES.values(), ids=SPACECRAFT_CHANGES.keys())
@pytest.mark.parametrize("which", ["target", "chaser"])
def test_a_spacecraft_is_known_by_every_piece(
    which: str, change: Callable[[Spacecraft], Spacecraft]
) -> None:
    craft: Spacecraft = getattr(plain(), which)
    assert spacecraft_hash(craft) == spacecraft_hash(replace(craft))
    assert spacecraft_hash(change(craft)) != spacecraft_hash(craft)


def test_target_chaser_and_materials_are_in_every_key(monkeypatch: pytest.MonkeyPatch) -> None:
    before = keys_of(plain())
    for which in ("target", "chaser"):
        world, other = plain(), moved(getattr(plain(), which))
        bodies = replace(world.bodies, **{f"make_{which}": lambda other=other: other})
        after = keys_of(replace(world, bodies=bodies))
        assert all(before[name] != after[name] for name in before)
    paint = MATERIALS["black_paint"]
    lighter = replace(paint, diffuse=BandReflectance(*(b + 0.001 for b in paint.diffuse.bands)))
    assert any(part.material == "black_paint" for part in plain().target.parts)
    monkeypatch.setitem(MATERIALS, "black_paint", lighter)
    after = keys_of(world_of(plain().scenario))
    assert all(before[name] != after[name] for name in before)


def test_markers_are_known_by_place_normal_name_and_size() -> None:
    target = plain().target
    markers = target.markers
    assert markers is not None

    def hashed(changed: MarkerPattern | None) -> str:
        return spacecraft_hash(replace(target, markers=changed))

    tilt = RigidTransform.identity().perturbed([1e-3, 0.0, 0.0], np.zeros(3))
    changes = [
        markers,
        replace(markers, points_in_target=markers.points_in_target + 1e-6),
        replace(markers, normals_in_target=tilt.rotate(markers.normals_in_target)),
        replace(markers, names=tuple(f"{name}b" for name in markers.names)),
        replace(markers, radius_m=0.0128),
        None,
    ]
    assert len({hashed(changed) for changed in changes}) == len(changes)
