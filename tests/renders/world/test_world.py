"""From a scenario to its things: clock, Suns, seeds, priors, exposure times, and poses refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.errors import ScenarioError
from models.lights.sun import sun_direction
from models.motion.approach import Approach
from models.onboard import OnboardKnowledge, PosePrior
from models.pose import RigidTransform
from renders.scenario.case_files import case_names
from renders.scenario.scenario import RenderRequest, Scenario, check_scenario, resolve
from renders.tracing.light_groups import EarthGroup
from renders.world.build import world_of
from renders.world.checks import shown_in_some_image
from renders.world.sky import sun_group
from renders.world.world import World

REQUEST = RenderRequest("maxar-approach", Path("unused"), rate_hz=0.05)


def world(**options: Any) -> World:
    return world_of(resolve(replace(REQUEST, **options)))


def world_with(**tables: dict[str, Any]) -> World:
    table = resolve(REQUEST).model_dump()
    for name, values in tables.items():
        table[name].update(values)
    return world_of(Scenario(**table))


# Clock and poses


def test_the_800_nm_exposure_is_33_ms_before_the_850_nm_one() -> None:
    exposures = world().exposures
    assert len(exposures) == 2 * len(world().scenario.times_s)
    for first, second in zip(exposures[::2], exposures[1::2], strict=True):
        assert (first.band, second.band) == (800, 850)
        assert first.frame == second.frame
        assert second.time_s - first.time_s == pytest.approx(0.033)
    assert [e.time_s for e in exposures[1::2]] == world().scenario.times_s


def test_a_camera_inside_the_target_is_refused_with_the_time() -> None:
    """At 0.015 m/s the ring plane is reached after some 450 s."""
    with pytest.raises(ScenarioError, match="inside maxar1300") as told:
        world(start_s=400.0, end_s=480.0, rate_hz=0.1).check_poses()
    said = str(told.value)
    time_s = float(said.split(" s it is at")[0].rsplit(" ", 1)[1])
    assert 440.0 < time_s <= 480.0  # not the last pose alone is looked at
    assert "motion.end_s" in said
    place = world().trajectory.cam_from_target(time_s).inverse().translation
    assert place[2] < 0.1  # it is really at the ring plane or below, not merely near the craft


def test_a_motion_that_never_shows_the_target_is_refused() -> None:
    """Past the ring plane the camera looks away from it; one image that shows it is enough."""
    with pytest.raises(ScenarioError, match="out of view in all 4, from 600 to 601 s"):
        world(start_s=600.0, end_s=601.0, rate_hz=1.0).check_poses()
    shown_in_some_image(world(start_s=5500.0, end_s=6500.0, rate_hz=0.002))  # in the first alone


def test_lamps_too_faint_for_the_schedule_are_refused() -> None:
    faint = world_with(lamps={"intensity_w_sr": 1e-3})
    with pytest.raises(
        ScenarioError, match=r"below motion\.pair_gap_ms, 33 ms.* lamps.intensity_w_sr"
    ):
        faint.check_poses()


@pytest.mark.parametrize("case", case_names())
def test_the_cases_stay_outside_the_target(case: str) -> None:
    world(case=case, rate_hz=0.05).check_poses()


# Light


def test_typed_suns_are_unit_vectors_with_names_of_their_own() -> None:
    typed, named = sun_group("0,-3,3"), sun_group("s2")
    assert named.name == "sun_S2"
    np.testing.assert_allclose(named.direction_in_target, sun_direction("S2"))
    assert np.linalg.norm(typed.direction_in_target) == pytest.approx(1.0)
    assert typed.name != sun_group("0,-3,3.1").name
    assert typed == sun_group("0,-1,1")  # one direction, one group, one store entry


def test_shared_suns_are_rendered_together_and_any_other_beside_them() -> None:
    names = [f"sun_S{number}" for number in range(1, 8)]
    for sun in ("S1", "S7"):
        assert [group.name for group in world(sun=sun).suns] == names
        assert world(sun=sun).sun.name == f"sun_{sun}"
    typed = world(sun="0,0,1")
    assert [group.name for group in typed.suns] == [*names, typed.sun.name]
    groups = [group.name for group in typed.groups(typed.exposures[1])]
    assert groups[-1] == "lamps_850"
    assert len(groups) == len(set(groups)) == 9


def test_the_two_rings_interleave() -> None:
    angles = []
    for band in (800, 850):
        x, y, _ = world().lamps(band).ring.points_in_cam.T
        angles += np.rad2deg(np.arctan2(y, x)).tolist()
    np.testing.assert_allclose(np.diff(np.sort(np.mod(np.round(angles, 6), 360))), 22.5)


def test_each_sun_has_its_own_earth_and_no_scenario_has_one_unasked() -> None:
    plain = world()
    assert not any(group.name.startswith("earth") for group in plain.groups(plain.exposures[1]))
    assert [group.name for group in plain.lit_by(plain.exposures[0])] == ["sun_S2", "lamps_800"]
    lit = world_with(earth={"shines": True, "direction": (0.0, 0.0, -2.0)})
    suns = {sun.name: sun for sun in lit.suns}
    earths = [group for group in lit.groups(lit.exposures[1]) if isinstance(group, EarthGroup)]
    assert [group.name for group in earths] == [name.replace("sun", "earth") for name in suns]
    for group in earths:
        sun = suns[group.name.replace("earth", "sun")]
        assert group.earth.sun_dir_in_target == sun.direction_in_target
        assert group.earth.direction_in_target == (0.0, 0.0, -1.0)
    assert [group.name for group in lit.lit_by(lit.exposures[1])] == [
        "sun_S2",
        "earth_S2",
        "lamps_850",
    ]


def test_a_floodlight_shines_in_both_exposures_through_the_camera_s_filter() -> None:
    lit = world_with(floodlight={"intensity_w_sr": 40.0, "centre_in_cam": (0.4, 0.0, 0.1)})
    (lamp,) = lit.sensor.streams[0].floodlights
    assert lamp.channel == lit.sun.channel
    np.testing.assert_allclose(lamp.ring.points_in_cam.mean(axis=0), [0.4, 0.0, 0.1], atol=1e-12)
    for exposure in lit.exposures[:2]:
        assert lamp in lit.lit_by(exposure)
        assert lamp in lit.groups(exposure)


def test_an_earth_in_no_direction_is_refused() -> None:
    table = resolve(REQUEST).model_dump()
    table["earth"]["direction"] = (0.0, 0.0, 0.0)
    with pytest.raises(ScenarioError, match=r"earth\.direction of three numbers, not all zero"):
        check_scenario(Scenario(**table), "mine.toml")


def test_both_exposures_of_a_frame_share_a_seed_and_no_two_frames_do() -> None:
    lit, again, otherwise = world(), world(), world_with(render={"seed": 2})
    seeds = [lit.render_seed(frame) for frame in range(200)]
    assert len(set(seeds)) == 200
    assert seeds == [again.render_seed(frame) for frame in range(200)]
    others = [otherwise.render_seed(frame) for frame in range(200)]
    assert not set(seeds) & set(others)


# What is loaded on board


def drawn(onboard: OnboardKnowledge) -> RigidTransform:
    assert onboard.prior is not None
    return onboard.prior.cam_from_target


def test_a_run_has_its_own_prior_and_always_the_same() -> None:
    one, other, again = (world().onboard(run) for run in (1, 2, 1))
    np.testing.assert_array_equal(drawn(one).matrix(), drawn(again).matrix())
    assert not np.array_equal(drawn(one).matrix(), drawn(other).matrix())


def test_priors_scatter_as_table_5_says() -> None:
    lit = world()
    first = lit.trajectory.cam_from_target(0.0)
    runs = 200
    offsets = np.array(
        [drawn(lit.onboard(run)).translation - first.translation for run in range(runs)]
    )
    sigma = np.array([0.017, 0.017, 0.05])
    four_sigma = 4.0 / np.sqrt(2.0 * runs)
    np.testing.assert_allclose(offsets.std(axis=0) / sigma, 1.0, atol=four_sigma)
    np.testing.assert_allclose(offsets.mean(axis=0) / sigma, 0.0, atol=4.0 / np.sqrt(runs))


def test_a_calibration_is_exact_unless_it_is_said_not_to_be() -> None:
    assert world().onboard(3).camera == world().camera
    rough = world_with(calibration={"sigma_focal_px": 2.0, "sigma_principal_point_px": 1.0})
    cameras = [rough.onboard(run).camera for run in range(100)]
    assert rough.camera == world().camera  # the true camera stays
    errors = np.array([[c.fx - rough.camera.fx, c.cx - rough.camera.cx] for c in cameras])
    np.testing.assert_allclose(errors.std(axis=0), [2.0, 1.0], rtol=4.0 / np.sqrt(200))


def test_a_target_without_markers_is_refused() -> None:
    table = resolve(REQUEST).model_dump() | {"target": "chaser"}
    with pytest.raises(ScenarioError, match="target with markers"):
        world_of(Scenario(**table)).onboard(0)
    with pytest.raises(ScenarioError, match="maxar1300"):
        _ = world_of(Scenario(**(table | {"target": "maxar1301"}))).target


# Exposure times


def shifted(prior: PosePrior, along_m: float) -> PosePrior:
    pose = prior.cam_from_target
    farther = RigidTransform(pose.rotation, pose.translation + np.array([0, 0, along_m]))
    return replace(prior, cam_from_target=farther)


def test_exposure_times_go_as_the_square_of_the_planned_range() -> None:
    lit, flight_plan = world(), Approach(pointing_accuracy_deg=0.0)  # the target does not sway
    start = flight_plan.cam_from_target(0.0)
    exact = PosePrior(start, np.zeros(3), np.zeros(3))
    first = lit.plan.before_any_image(0.0, exact) / start.translation[2] ** 2
    for time_s in (0.0, 100.0, 250.0, 330.0):
        range_m = flight_plan.cam_from_target(time_s).translation[2]
        assert lit.plan.before_any_image(time_s, exact) / range_m**2 == pytest.approx(first)


def test_exposure_times_follow_the_prior_and_nothing_truer() -> None:
    """A prior 0.1 m too far lengthens them; how the target really sways does not show in them."""
    lit, still = world(), world_with(motion={"target_wobble": False})
    prior = lit.onboard(0).prior
    assert prior is not None
    far = shifted(prior, 0.1)
    start_s, end_s = lit.scenario.times_s[0], lit.scenario.times_s[-1]
    for time_s in (start_s, end_s):
        assert lit.plan.before_any_image(time_s, far) > lit.plan.before_any_image(time_s, prior)
        assert lit.plan.before_any_image(time_s, prior) == still.plan.before_any_image(
            time_s, prior
        )
    swaying, steady = (w.trajectory.cam_from_target(end_s).matrix() for w in (lit, still))
    assert not np.allclose(swaying, steady, atol=1e-3)  # the two targets do lie otherwise


def test_frames_know_no_more_than_index_time_and_exposure() -> None:
    lit = world()
    entries = lit.frame_entries(lit.onboard(0).prior)
    assert [entry.index for entry in entries] == list(range(len(lit.scenario.times_s)))
    assert [entry.time_s for entry in entries] == lit.scenario.times_s
    exposures = [entry.exposure_ms for entry in entries]
    assert exposures == sorted(exposures, reverse=True)  # it comes nearer all the time
    assert 0.05 < exposures[-1] < exposures[0] < 5.0
