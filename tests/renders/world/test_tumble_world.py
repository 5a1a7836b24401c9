"""A free target's sky: the Sun stands still in inertial space, and the Earth lies below."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.errors import ScenarioError
from models.frame import TableReading
from models.pose import RigidTransform
from models.spacecraft.wireframes import wireframe_by_name
from renders.batches.public_half import dataset_info, public_files
from renders.scenario.scenario import RenderRequest, Scenario, check_scenario, resolve
from renders.store.light_keys import LightKeys
from renders.tracing.light_groups import EarthGroup, SunGroup
from renders.world.build import world_of
from renders.world.exposure import FILTERED, Exposure
from renders.world.trajectory import FreeMotion
from renders.world.world import World
from tests.support.tumble_scenario import TUMBLE, tumble_table

ROUNDING = 1e-12


def tumbling(**changes: Any) -> World:
    return world_of(Scenario.model_validate(tumble_table(**changes)))


def motion_of(world: World) -> FreeMotion:
    assert world.absolute is not None
    return world.absolute


def test_a_scenario_tells_its_chain_and_streams() -> None:
    pairs, single = dataset_info(world_of(Scenario(name="x"))), dataset_info(tumbling())
    assert (pairs.chain, single.chain) == ("retroreflector_pairs", "tumble_images")
    assert [stream.name for stream in pairs.streams] == ["image_800", "image_850"]
    assert [stream.name for stream in single.streams] == ["image", "chaser_orbit"]
    assert world_of(Scenario(name="x")).absolute is None


def test_one_exposure_a_frame_and_no_lamp() -> None:
    world = tumbling()
    assert [(e.frame, e.band, e.time_s) for e in world.exposures] == [
        (0, FILTERED, 0.0),
        (1, FILTERED, 50.0),
        (2, FILTERED, 100.0),
    ]
    kinds = [type(group) for group in world.lit_by(world.exposures[1])]
    assert kinds == [SunGroup, EarthGroup]
    assert world.chaser is None
    lit = tumbling(floodlight={"intensity_w_sr": 100.0})
    assert [group.name for group in lit.lit_by(lit.exposures[0])][-1] == "floodlight"


def test_the_sun_stands_still_among_the_stars() -> None:
    """Brought back into inertial axes by the attitude, its direction is that typed, at any time."""
    world = tumbling()
    typed = np.array([0.1, 0.2, 1.0]) / np.linalg.norm([0.1, 0.2, 1.0])
    seen = []
    for exposure in world.exposures:
        sun = world.lit_by(exposure)[0]
        assert isinstance(sun, SunGroup)
        seen.append(sun.direction_in_target)
        in_lvlh = motion_of(world).state(exposure.time_s).R_lvlh_from_target @ seen[-1]
        in_inertial = motion_of(world).tumble.orbit.inertial_from_lvlh(exposure.time_s) @ in_lvlh
        np.testing.assert_allclose(in_inertial, typed, atol=ROUNDING)
    assert np.linalg.norm(np.subtract(seen[0], seen[1])) > 0.3  # half a degree a second for 50 s


def test_the_earth_is_below_at_the_chasers_distance() -> None:
    """Below in the image is nadir: y of the camera; its disc is 63 deg wide at 7143 km."""
    world = tumbling()
    for exposure in world.exposures:
        sun, earth = world.lit_by(exposure)
        assert isinstance(sun, SunGroup)
        assert isinstance(earth, EarthGroup)
        pose = world.trajectory.cam_from_target(exposure.time_s)
        down = pose.rotate(earth.earth.direction_in_target)
        np.testing.assert_allclose(down, [0.0, 1.0, 0.0], atol=ROUNDING)
        assert earth.earth.orbit_radius_km == pytest.approx(7143.1 * (1.0 - 1.4e-4), rel=1e-4)
        assert earth.earth.sun_dir_in_target == sun.direction_in_target


def test_suns_rendered_in_one_pass_keep_their_names_and_angles() -> None:
    world = tumbling(sun={"default": "0.1,0.2,1", "shared": ["1,0,0", "0,1,0.5"]})
    first, later = (world.groups(exposure) for exposure in world.exposures[:2])
    assert [g.name for g in first] == [g.name for g in later]
    suns = [
        np.array([g.direction_in_target for g in groups if isinstance(g, SunGroup)])
        for groups in (first, later)
    ]
    assert len(suns[0]) == 3
    np.testing.assert_allclose(suns[0] @ suns[0].T, suns[1] @ suns[1].T, atol=ROUNDING)


def test_each_exposure_has_light_of_its_own_in_the_store() -> None:
    world = tumbling()
    keys = LightKeys(world, "jit")
    pose = RigidTransform(np.eye(3), np.array([0.0, 0.0, 30.0]))
    one, other = world.exposures[:2]
    for name, before in zip(("sun", "earth"), world.lit_by(one), strict=True):
        after = {g.name: g for g in world.lit_by(other)}[before.name]
        assert before.name.startswith(name)
        assert keys.group(one, pose, before) != keys.group(one, pose, after)
    again = LightKeys(tumbling(), "jit")
    assert keys.group(one, pose, world.lit_by(one)[0]) == again.group(
        one, pose, tumbling().lit_by(one)[0]
    )


# On board


def navigation(world: World, exposure: Exposure, run: int) -> TableReading:
    (sensor,) = world.tables
    return sensor.reading(exposure.frame, exposure.time_s, -np.inf, run)


def test_navigation_is_wrong_by_its_sigmas_and_keyed_by_frame_and_run() -> None:
    world = tumbling(motion={"end_s": 200.0, "rate_hz": 1.0})
    off = []
    for exposure in world.exposures:
        truth = motion_of(world).chaser_state(exposure.time_s)
        believed = navigation(world, exposure, run=0)
        assert believed.time_s == [exposure.time_s]
        off.append((believed.rows[0, :3] - truth.position_in_inertial) / 10.0)
    sigma = np.std(off)
    assert sigma == pytest.approx(1.0, abs=4.0 / np.sqrt(2.0 * 603))  # four sigma of a sigma
    again = navigation(tumbling(), world.exposures[0], run=0)
    first = navigation(world, world.exposures[0], run=0)
    np.testing.assert_array_equal(again.rows, first.rows)
    other = navigation(world, world.exposures[0], run=1)
    assert (other.rows != first.rows).all()


def test_what_is_on_board_is_the_drawn_target_and_no_pose() -> None:
    world = tumbling()
    onboard = world.onboard(0)
    assert onboard.wireframe is wireframe_by_name("xmm")
    assert onboard.expectations is not None
    assert onboard.expectations.range_m == (20.0, 40.0)
    np.testing.assert_array_equal(onboard.expectations.inertia_kg_m2, TUMBLE["inertia_kg_m2"])
    blind = tumbling(tumble={**TUMBLE, "onboard": {"knows_inertia": False}})
    expected = blind.onboard(0).expectations
    assert expected is not None
    assert expected.inertia_kg_m2 is None
    assert expected.range_m is None
    assert set(public_files(world)) == {
        "camera.toml",
        "detector.toml",
        "knowledge.toml",
        "wireframe.json",
        "navigation.csv",
    }
    assert onboard.prior is None
    assert onboard.markers is None


def test_a_coarse_look_shows_the_same_levels() -> None:
    """A pixel four times as wide gathers 16 times the light into the same well."""
    fine = tumbling(camera={"width": 256}).frame_entries(None)
    coarse = tumbling(camera={"width": 64}).frame_entries(None)
    assert fine[0].exposure_ms == pytest.approx(16.0 * coarse[0].exposure_ms)
    assert tumbling(camera={"width": 2048}).frame_entries(None)[2].exposure_ms == 4.0
    metered = tumbling(exposure={"mode": "auto", "exposure_ms": 4.0}).frame_entries(None)
    assert len(metered) == 1


@pytest.mark.parametrize("case", ["xmm-tumble", "hispasat-tumble"])
def test_the_cases_are_what_they_say(case: str) -> None:
    """200 frames over a turn of 360 deg; the Sun stands 40 to 60 deg off the camera's side."""
    world = world_of(resolve(RenderRequest(case, Path("unused"))))
    assert len(world.exposures) == 200
    world.check_poses()
    end_s = world.exposures[-1].time_s + 1.0 / world.scenario.motion.rate_hz
    tumble = world.scenario.tumble
    assert tumble is not None
    rate_deg_s = np.linalg.norm(tumble.omega0_deg_s)
    assert rate_deg_s * end_s == pytest.approx(360.0, rel=0.01)
    for exposure in world.exposures[::10]:
        pose = world.trajectory.cam_from_target(exposure.time_s)
        sun = world.lit_by(exposure)[0]
        assert isinstance(sun, SunGroup)
        back = -pose.translation / np.linalg.norm(pose.translation)
        phase_deg = np.rad2deg(np.arccos(pose.rotate(sun.direction_in_target) @ back))
        assert 40.0 < phase_deg < 61.0


# Refusals


def refusal(**changes: Any) -> str:
    scenario = Scenario.model_validate(tumble_table(**changes))
    with pytest.raises(ScenarioError) as told:
        check_scenario(scenario, "mine.toml")
    assert str(told.value).startswith("mine.toml: ")
    return str(told.value)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"sun": {"default": "S2"}}, "as a vector x,y,z towards the Sun in the inertial frame"),
        ({"sun": {"default": "1,0,0", "shared": ["S4"]}}, "got 'S4'"),
        ({"exposure": {}}, "expected exposure.mode, with [tumble], as auto or fixed"),
        ({"lamps": {"count": 9}}, "expected lamps.count to be left out with [tumble]"),
        ({"retroreflector": {"returned_800": 0.1}}, "expected retroreflector.returned_800"),
        ({"prior": {"sigma_t_m": [1.0, 1.0, 1.0]}}, "expected prior.sigma_t_m"),
        ({"earth": {"direction": [0.0, 1.0, 0.0]}}, "expected earth.direction"),
        ({"motion": {"pair_gap_ms": 20.0}}, "expected motion.pair_gap_ms"),
        (
            {"stars": {"shine": True, "zenith_right_ascension_deg": 10.0}},
            "expected stars.zenith_right_ascension_deg to be left out with [tumble]",
        ),
        (
            {"exposure": {"schedule_ms": [[0.0, 1.0], [0.0, 2.0]]}},
            "expected exposure.schedule_ms in order of time",
        ),
        (
            {"exposure": {"schedule_ms": [[0.0, 1.0], [9.0, 0.0]]}},
            "expected exposures in exposure.schedule_ms of at least 0.0001 ms",
        ),
        (
            {"exposure": {"mode": "fixed", "schedule_ms": [[0.0, 1.0]]}},
            "expected exposure.mode as 'schedule', or left out, with exposure.schedule_ms",
        ),
        (
            {"tumble": {**TUMBLE, "q_lvlh_from_target_wxyz": [1.0, 1.0, 0.0, 0.0]}},
            "of four numbers and length 1",
        ),
        (
            {"tumble": {**TUMBLE, "inertia_kg_m2": [[1, 0, 0], [0, 1, 0], [0, 0, 3]]}},
            "the largest at most the sum of the others",
        ),
        (
            {"tumble": {**TUMBLE, "onboard": {"range_m": [40.0, 20.0]}}},
            "as nearest and farthest",
        ),
        (
            {
                "motion": {"rate_hz": 10.0},
                "exposure": {"mode": "fixed", "exposure_ms": 200.0},
            },
            "below the time between images, 100 ms",
        ),
    ],
)
def test_what_would_mislead_is_refused(changes: dict[str, Any], said: str) -> None:
    assert said in refusal(**changes)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"sun": {"default": "-0.17,-0.17,0.97"}}, "a Sun that the Earth does not hide"),
        ({"tumble": {**TUMBLE, "rho0_m": [15.0, 30.0, 0.0]}}, "expected the target's centre in"),
        ({"tumble": {**TUMBLE, "rho0_m": [0.0, -30.0, 0.0]}}, "expected the target's centre in"),
        ({"tumble": {**TUMBLE, "rho0_m": [0.0, 0.5, 0.0]}}, "expected the camera outside"),
    ],
    ids=["in shadow", "beside the image", "behind the camera", "inside the target"],
)
def test_a_motion_that_nobody_would_see_is_refused(changes: dict[str, Any], said: str) -> None:
    world = tumbling(**changes)
    if "sun" in changes:  # straight behind the Earth
        position = motion_of(world).chaser_state(0.0).position_in_inertial
        x, y, z = -position / np.linalg.norm(position)
        world = tumbling(sun={"default": f"{x},{y},{z}"})
    with pytest.raises(ScenarioError, match=said):
        world.check_poses()


def test_an_unknown_key_of_the_tumble_is_refused_with_the_nearest(tmp_path: Path) -> None:
    from renders.scenario.scenario import read_scenario

    text = Scenario.model_validate(tumble_table()).to_toml()
    path = tmp_path / "mine.toml"
    path.write_text(text.replace("rho0_m", "rho_0_m"))
    with pytest.raises(ScenarioError, match=r"unknown key tumble\.rho_0_m.*perhaps you meant rho0"):
        read_scenario(path)
