"""A tumble through the Earth's shadow: its lights go out by the share of the Sun that is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.errors import ScenarioError
from models.lights.earth import EARTH_RADIUS_KM
from renders.batches.render_case import shadow_note
from renders.detector.compose import compose, rates_of
from renders.scenario.scenario import Scenario
from renders.tracing.light_groups import EarthGroup, LightGroup, SunGroup
from renders.world.build import world_of
from renders.world.checks import is_dark
from renders.world.exposure import Exposure
from renders.world.world import World
from tests.support.tumble_scenario import tumble_table

INTO_SHADOW = "0.8376,0.0704,-0.5417"  # of the scenario's orbit: umbra from 240 s to 840 s
ROUNDING = 1e-5  # of float32 radiance


def passing(start_s: float, end_s: float, rate_hz: float, **changes: object) -> World:
    motion = {"start_s": start_s, "end_s": end_s, "rate_hz": rate_hz}
    table = tumble_table(motion=motion, sun={"default": INTO_SHADOW}, **changes)
    return world_of(Scenario.model_validate(table))


def lit_evenly(world: World, exposure: Exposure) -> dict[LightGroup, np.ndarray]:
    shape = (world.camera.height, world.camera.width)
    return {group: np.full(shape, 2.0, np.float32) for group in world.lit_by(exposure)}


def test_a_pass_goes_from_light_through_penumbra_to_umbra_and_back() -> None:
    world = passing(0.0, 1080.0, 0.05)
    shares = np.array([world.sunlit_share(each.time_s) for each in world.exposures])
    assert shares[0] == shares[-1] == 1.0
    dark = np.flatnonzero(shares == 0.0)
    assert (np.diff(dark) == 1).all()
    assert (np.diff(shares[: dark[0] + 1]) <= 0.0).all()
    assert (np.diff(shares[dark[-1] :]) >= 0.0).all()
    assert 570.0 <= 20.0 * len(dark) <= 630.0
    assert 0.0 < shares[dark[0] - 1] < 1.0


def test_half_the_sun_is_left_where_its_middle_stands_on_the_limb() -> None:
    """The chord of the ray to the Sun's middle grazes the ball at the instant of half light."""
    world = passing(150.0, 250.0, 1.0)
    times = [each.time_s for each in world.exposures]
    shares = np.array([world.sunlit_share(each) for each in times])
    half = times[int(np.argmin(np.abs(shares - 0.5)))]
    assert world.absolute is not None
    position_km = 1e-3 * world.absolute.chaser_state(half).position_in_inertial
    sun = np.array([float(x) for x in INTO_SHADOW.split(",")])
    sun /= np.linalg.norm(sun)
    miss_km = np.linalg.norm(np.cross(position_km, sun)) - EARTH_RADIUS_KM
    one_second_km = 2.0  # of a grazing pass, whose penumbra of 30 km lasts 50 s
    assert abs(miss_km) < one_second_km


def test_in_the_umbra_nothing_shines_and_lamps_still_do() -> None:
    world = passing(190.0, 500.0, 1.0 / 310.0)
    before, within = world.exposures
    assert [type(group) for group in world.lit_by(before)] == [SunGroup, EarthGroup]
    assert world.lit_by(within) == world.groups(within) == []
    assert not world.shows_earth(within, world.trajectory.cam_from_target(within.time_s))
    lamp = passing(190.0, 500.0, 1.0 / 310.0, floodlight={"intensity_w_sr": 100.0})
    assert [group.name for group in lamp.lit_by(lamp.exposures[1])] == ["floodlight"]


def test_the_penumbra_scales_sunlight_and_leaves_the_earths_as_it_is() -> None:
    world = passing(200.0, 230.0, 0.1)
    dim = world.exposures[1]
    groups = lit_evenly(world, dim)
    bright = replace(world, sky=replace(world.sky, eclipses=False))
    share = world.sunlit_share(dim.time_s)
    assert 0.1 < share < 0.9
    for group, radiance in groups.items():
        (alone,) = rates_of(world, {group: radiance}, dim)
        (full,) = rates_of(bright, {group: radiance}, dim)
        expected = share if isinstance(group, SunGroup) else 1.0
        np.testing.assert_allclose(alone, expected * full, rtol=ROUNDING)


def test_the_penumbra_lies_in_no_key_of_light() -> None:
    """What is traced is the whole Sun's light: groups are the same as if nothing were hidden."""
    world = passing(200.0, 230.0, 0.1)
    bright = replace(world, sky=replace(world.sky, eclipses=False))
    for exposure in world.exposures:
        assert world.groups(exposure) == bright.groups(exposure)


def test_an_image_of_the_umbra_is_the_cameras_own_noise() -> None:
    world = passing(190.0, 500.0, 1.0 / 310.0)
    image = compose(world, {}, world.exposures[1], 4.0, 0)
    detector = world.scenario.simulated_detector
    noise_dn = detector.noise_dn(np.array([float(detector.bias_dn)]))[0]
    assert abs(image.mean() - detector.bias_dn) < 5.0 * noise_dn / np.sqrt(image.size) + 0.5
    assert image.max() < detector.bias_dn + 7.0 * noise_dn + 1.0


def test_a_motion_all_in_the_dark_is_refused_and_one_in_part_is_told() -> None:
    with pytest.raises(ScenarioError, match="in all 3 images, from 300 to 320 s"):
        passing(300.0, 320.0, 0.1).check_poses()
    world = passing(0.0, 1080.0, 0.05)
    world.check_poses()
    shares = [world.sunlit_share(each.time_s) for each in world.exposures]
    dark, dim = sum(x == 0.0 for x in shares), sum(0.0 < x < 1.0 for x in shares)
    assert f"{dark} of {len(shares)} images" in shadow_note(world)
    assert f"{dim} in the penumbra" in shadow_note(world)
    assert shadow_note(passing(0.0, 100.0, 0.02)) == ""


def test_a_sweep_leaves_out_a_sun_that_is_hidden_whole() -> None:
    assert is_dark(passing(500.0, 500.0, 1.0))
    assert not is_dark(passing(215.0, 215.0, 1.0))  # the penumbra
    assert not is_dark(passing(0.0, 0.0, 1.0))


def test_a_typed_sun_of_an_approach_is_never_hidden() -> None:
    world = world_of(Scenario(name="x"))
    for exposure in world.exposures[:2]:
        assert world.sunlit_share(exposure.time_s) == 1.0
