"""An arm in a scenario: how it stands, what is keyed, told and sealed of it, what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from models.arm.hand_camera import hand_from_chaser
from models.arm.house_arm import ROWS, house_arm
from models.arm.kinematics import chaser_from_links
from models.arm.onboard_arm import ARM_FILE, ARM_JOINTS, OnboardArm
from models.camera import camera_preset
from models.errors import ScenarioError
from models.frame import IMAGE
from models.motion.approach import Approach
from models.motion.prior import draw_prior
from models.pose import RigidTransform, pose_error
from models.sky.sun_ephemeris import epoch_of, right_ascension_over, sun_dir_in_inertial
from models.spacecraft.stance import BODY_ALONE
from renders.scenario.scenario import (
    RenderRequest,
    Scenario,
    check_scenario,
    read_scenario,
    resolve,
)
from renders.store.light_keys import LightKeys
from renders.truth.arm_truth import ARM_TRUTH, arm_truth_lines, read_arm_truths
from renders.world.arm_clear import clear_of_everything
from renders.world.arm_told import FirstPoseByArm
from renders.world.build import world_of
from renders.world.onboard import PRIOR_DRAW
from renders.world.world import World

EXACT = 1e-12
TOLD = {
    "joints_deg": {"offset": 0.01, "sigma": 0.02},
    "mount_turn_deg": {"sigma": 0.05},
    "mount_place_m": {"sigma": 0.001},
}
HAND: dict[str, Any] = {
    "arm": {"camera": "hand"},
    "frame": {"kind": "single"},
    "camera": {"preset": "eye_in_hand"},
    "exposure": {"mode": "fixed"},
    "motion": {"start_s": 282.3, "rate_hz": 0.1},
}


def scenario_of(**tables: Any) -> Scenario:
    return check_scenario(Scenario(**{"name": "armed", "arm": {}, **tables}), "armed")


def world(**tables: Any) -> World:
    return world_of(scenario_of(**tables))


# How it stands


@pytest.mark.parametrize("time_s", [0.0, 250.0, 300.0, 330.0])
def test_links_stand_where_the_joints_put_them(time_s):
    armed = world()
    assert armed.arm is not None
    angles = np.deg2rad(armed.arm.motion.angles_at(time_s))
    stance = armed.stance(time_s)
    body, *links = stance.cam_from_frames
    np.testing.assert_array_equal(body.matrix(), np.eye(4))
    for stands, link in zip(links, chaser_from_links(house_arm(), angles)[1:], strict=True):
        np.testing.assert_allclose(stands.matrix(), link.matrix(), atol=EXACT)
    assert armed.stance(time_s) is stance


def test_the_hand_camera_is_carried_and_sees_the_chaser_behind_it():
    armed = world(**HAND)
    assert armed.arm is not None
    truth, approach = armed.trajectory.cam_from_target(300.0), Approach()
    body, *links = armed.stance(300.0).cam_from_frames
    np.testing.assert_allclose(
        (body.inverse() @ truth).matrix(), approach.cam_from_target(300.0).matrix(), atol=EXACT
    )
    assert body.translation[2] < -0.5, "the chaser's camera stands behind the hand's"
    tool = links[-1] @ house_arm().last_from_tool
    np.testing.assert_allclose(tool.translation, [0.0, 0.2, 0.4], atol=1e-9)
    assert armed.camera == camera_preset("eye_in_hand")
    assert [stream.name for stream in armed.sensor.streams] == [IMAGE]


def test_another_frame_of_the_target_moves_nothing_but_the_numbers():
    shifted = {**HAND, "motion": {**HAND["motion"], "ring_in_target_m": [0.0, -0.83, 0.0]}}
    shifted["arm"] = {"camera": "hand", "grasp_in_target_m": [0.0, 0.0, 0.0]}
    here, there = world(**HAND), world(**shifted)
    to_ring = RigidTransform(np.eye(3), np.array([0.0, -0.83, 0.0]))
    np.testing.assert_allclose(
        there.trajectory.cam_from_target(310.0).matrix() @ to_ring.matrix(),
        here.trajectory.cam_from_target(310.0).matrix(),
        atol=1e-8,
    )


# Keys


def keys_at(armed: World, time_s: float) -> set[str]:
    keys, exposure = LightKeys(armed, "jit"), armed.sensor.exposures(0, time_s)[-1]
    pose = armed.trajectory.cam_from_target(time_s)
    named = [keys.group(exposure, pose, group) for group in armed.groups(exposure)]
    return {*named, keys.geometry(exposure, pose)}


def test_the_joints_are_part_of_every_key_and_a_chaser_without_any_has_none():
    plain, armed, other = world(arm=None), world(), world(arm={"extends_s": 230.0})
    assert not keys_at(plain, 250.0) & keys_at(armed, 250.0)
    assert not keys_at(other, 250.0) & keys_at(armed, 250.0), "the same pose, other joints"
    assert keys_at(other, 100.0) == keys_at(armed, 100.0), "the same joints, still stowed"
    assert plain.stance(250.0) is BODY_ALONE


# What is told


def test_the_pipeline_is_told_the_joints_as_read_and_never_as_they_are():
    armed = world(told={"arm": TOLD})
    assert armed.arm is not None
    (sensor,) = armed.tables
    true = armed.arm.motion.angles_at(300.0)
    read = np.array([sensor.reading(3, 300.0, 0.0, run).rows[0] for run in range(200)])
    wrong = read - true
    assert sensor.name == ARM_JOINTS
    assert wrong.mean() == pytest.approx(0.01, abs=5 * 0.02 / np.sqrt(wrong.size))
    assert wrong.std() == pytest.approx(0.02, rel=0.1)
    later = sensor.reading(4, 310.0, 300.0, 5).rows[0] - armed.arm.motion.angles_at(310.0)
    np.testing.assert_allclose(later, wrong[5], atol=EXACT)  # a constant of the run
    onboard = armed.onboard(5)
    assert onboard.sigmas["arm.joints_deg"] == 0.02
    told = OnboardArm.of_table(onboard.tables[ARM_FILE])
    turned = pose_error(told.hand_from_tool, armed.arm.hand_from_tool)
    assert 0.0 < turned.attitude_deg < 0.5
    assert 0.0 < np.linalg.norm(turned.position_m) < 0.01


def test_without_errors_the_told_arm_is_the_true_one():
    armed = world()
    assert armed.arm is not None
    told = OnboardArm.of_table(armed.onboard(0).tables[ARM_FILE])
    read = armed.tables[0].reading(0, 300.0, 0.0, 0).rows[0]
    np.testing.assert_allclose(
        told.hand_from_chaser(read).matrix(), armed.arm.hand_from_chaser(300.0).matrix(), atol=EXACT
    )


def test_the_first_pose_by_way_of_the_arm_is_the_chasers_chained():
    armed = world(**HAND, told={"arm": TOLD})
    assert armed.arm is not None
    table = armed.scenario.prior.model_copy(update={"by": "arm"})
    told = armed.before_flight.arm
    assert told is not None
    prior = FirstPoseByArm(told, 282.3, table).drawn(7, PRIOR_DRAW)
    rng = np.random.default_rng([7, PRIOR_DRAW])
    chaser = draw_prior(
        Approach().cam_from_target(282.3), table.sigma_t_m, table.sigma_euler_deg, rng
    )
    expected = (
        hand_from_chaser(house_arm(), told.joints_deg(282.3, 7), told.hand_from_tool(7)) @ chaser
    )
    np.testing.assert_allclose(prior.cam_from_target.matrix(), expected.matrix(), atol=1e-9)
    assert (prior.sigma_m > np.array(table.sigma_t_m).min()).all()


# What is sealed


def test_truth_of_both_cameras_is_written_and_read_back(tmp_path: Path):
    armed = world(**HAND)
    text = arm_truth_lines(armed)
    assert text is not None
    (tmp_path / "truth").mkdir()
    (tmp_path / ARM_TRUTH).write_text(text)
    truths = read_arm_truths(tmp_path)
    assert len(truths) == len(armed.exposures)
    for exposure in armed.exposures:
        truth = truths[exposure.frame, exposure.band]
        seen = armed.trajectory.cam_from_target(exposure.time_s)
        np.testing.assert_allclose(truth.hand_from_target.matrix(), seen.matrix(), atol=1e-9)
        chained = hand_from_chaser(house_arm(), truth.joints_deg) @ truth.chaser_from_target
        np.testing.assert_allclose(chained.matrix(), seen.matrix(), atol=1e-9)
    assert arm_truth_lines(world(arm=None)) is None


# What is refused

REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "out of reach": ({"arm": {"grasp_in_target_m": [0.0, 3.0, 0.0]}}, "set-point 2, camera on the"),
    "times": ({"arm": {"looks_s": 200.0}}, "arm.extends_s before arm.looks_s"),
    "pairs by hand": ({"arm": {"camera": "hand"}}, "with single images"),
    "a posture of another arm": ({"arm": {"near_deg": [1.0, 2.0]}}, "arm.near_deg of 7 angles"),
    "prior by no hand": ({"prior": {"by": "arm"}}, 'prior.by = "arm" with arm.camera = "hand"'),
    "prior by no arm": ({"arm": None, "prior": {"by": "arm"}}, "a table [arm] for prior.by"),
    "told of no arm": ({"arm": None, "told": {"arm": TOLD}}, "told.arm to be left out"),
    "a file beside nothing": ({"arm": {"file": "arm.toml"}}, "beside which it lies"),
    "lines of no kind": ({"arm": {"lines": ["x"]}}, "arm.lines with arm.kind"),
    "a bad file": ({"arm": {"lines": ["x = 1"], "kind": "toml"}}, "expected the keys"),
    "longitude of no date": (
        {"motion": {"longitude_deg": 19.2}},
        "with an approach and motion.epoch",
    ),
}


@pytest.mark.parametrize("why", REFUSED)
def test_what_cannot_be_is_refused_in_one_line(why):
    tables, said = REFUSED[why]
    with pytest.raises(ScenarioError) as raised:
        world(**tables)
    assert said in str(raised.value)
    assert "\n" not in str(raised.value)


def test_an_arm_goes_with_no_tumble():
    table = read_scenario(Path("bench/cases/xmm-tumble.toml")).model_dump()
    with pytest.raises(ScenarioError, match=r"expected \[arm\] with an approach"):
        check_scenario(Scenario(**{**table, "arm": {}}), "armed")


@pytest.mark.slow
def test_an_arm_that_touches_the_chaser_is_refused_with_a_clear_posture():
    """Its elbow folds through the chaser's wing; another posture would be clear."""
    armed = world(arm={"near_deg": [25.0, 108.0, -20.0, 101.0, 70.0, 22.0, -145.0]})
    clear_of_everything(armed)  # found near there, and clear
    low = world(arm={"ready_in_chaser_m": [-0.45, -0.5, 0.02]})
    with pytest.raises(
        ScenarioError, match=r"expected the arm 0\.03 m clear of itself, the chaser"
    ):
        clear_of_everything(low)


def test_the_case_that_ships_is_clear():
    clear_of_everything(world_of(resolve(RenderRequest("maxar-arm", Path("unused")))))


# An arm by file


def test_an_arm_by_file_is_read_into_the_scenario(tmp_path: Path):
    rows = [
        {
            "name": row.name,
            "a_m": row.a_m,
            "alpha_deg": row.alpha_deg,
            "d_m": row.d_m,
            "lower_deg": row.lower_deg,
            "upper_deg": row.upper_deg,
        }
        for row in ROWS
    ]
    (tmp_path / "mine.toml").write_text(tomli_w.dumps({"name": "mine", "joint": rows}))
    near = [143.0, -36.0, -81.0, -101.0, 36.0, 103.0, -53.0]
    arm = {"file": "mine.toml", "base_in_chaser_m": [0.32, -0.46, -0.03], "near_deg": near}
    case = tmp_path / "case.toml"
    case.write_text(tomli_w.dumps({"name": "armed", "arm": arm}))
    scenario = read_scenario(case)
    again = tmp_path / "resolved.toml"
    again.write_text(scenario.to_toml())
    assert read_scenario(again).fingerprint() == scenario.fingerprint()
    theirs, ours = world_of(scenario).arm, world().arm
    assert theirs is not None
    assert ours is not None
    np.testing.assert_allclose(theirs.motion.angles_deg, ours.motion.angles_deg, atol=2e-6)
    assert theirs.motion.arm.name == "mine"


# The Sun by date


def test_the_sun_over_an_approach_follows_from_date_and_longitude():
    """At local noon of an equinox the Sun is behind the Earth's far side: over +z, in the orbit."""
    day = {"epoch_utc": "2026-03-20T12:00:00Z", "longitude_deg": 0.0}
    dated = world(arm=None, motion=day, sun={"default": "epoch"})
    at_noon = np.array(dated.sun_at(dated.sun, 0.0).direction_in_target)
    nominal = Approach().wobble.nominal_from_target(0.0).T @ [0.0, 0.0, 1.0]
    assert np.rad2deg(np.arccos(at_noon @ nominal)) < 3.0  # the equation of time is 1.9 deg
    evening = {**day, "longitude_deg": 90.0}  # 18 h there: the Sun is back along the orbit
    dusk = world(arm=None, motion=evening, sun={"default": "epoch"})
    back = np.array(dusk.sun_at(dusk.sun, 0.0).direction_in_target)
    assert back[0] > 0.99  # +x is backward along the orbit


def test_it_turns_by_a_quarter_of_a_degree_a_minute():
    day = {"epoch_utc": "2026-06-21T06:00:00Z", "longitude_deg": 10.0, "target_wobble": False}
    dated = world(arm=None, motion=day, sun={"default": "epoch"})
    first, last = (np.array(dated.sun_at(dated.sun, t).direction_in_target) for t in (0.0, 240.0))
    declination = np.deg2rad(23.4)
    turned = np.rad2deg(np.arccos(np.clip(first @ last, -1.0, 1.0)))
    assert turned == pytest.approx(1.0 * np.cos(declination), abs=0.01)
    assert first[1] == pytest.approx(-np.sin(declination), abs=2e-3)  # north is -y


def test_midnight_of_an_equinox_is_an_eclipse():
    day = {"epoch_utc": "2026-03-21T00:00:00Z", "longitude_deg": 0.0}
    with pytest.raises(ScenarioError, match="a date on which the Earth does not hide the Sun"):
        world(arm=None, motion=day, sun={"default": "epoch"}).check_poses()


def test_the_meridian_of_greenwich_at_a_known_hour():
    """18 h 41 min 50.5 s of sidereal time at 2000-01-01 12:00 UT; 24 h later 236.6 s more."""
    first = right_ascension_over(0.0, epoch_of("2000-01-01T12:00:00Z"))
    assert first == pytest.approx(15.0 * (18 + 41 / 60 + 50.5484 / 3600), abs=1e-3)
    later = right_ascension_over(0.0, epoch_of("2000-01-02T12:00:00Z"))
    assert (later - first) * 240.0 == pytest.approx(236.555, abs=0.05)
    noon = epoch_of("2026-06-21T12:00:00Z")
    sun = sun_dir_in_inertial(noon)
    hour_deg = right_ascension_over(0.0, noon) - np.rad2deg(np.arctan2(sun[1], sun[0]))
    assert abs((hour_deg + 180.0) % 360.0 - 180.0) < 1.0  # the equation of time, -1.9 min
