"""Worlds of what a user brings: poses, markers, a Sun that moves, and errors of what is told."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from models.errors import ScenarioError
from models.motion.pose_table import pose_columns
from models.sky.sun_ephemeris import epoch_of, sun_dir_in_inertial
from renders.batches.public_half import dataset_info, public_files
from renders.detector.exposure_control import ExposureControl
from renders.scenario.scenario import Scenario, read_scenario
from renders.world.build import world_of
from renders.world.world import World
from tests.support.own_scenario import (
    OWN_CAMERA,
    OWN_MARKERS,
    every_difference,
    facing,
    pose_lines,
    row_of,
)
from tests.support.tumble_scenario import tumble_table

EPOCH = "2026-03-20T12:00:00Z"


def read(folder: Path, lines: list[str] | None = None, **tables: Any) -> Scenario:
    (folder / "poses.csv").write_text("\n".join(lines or pose_lines(4)))
    motion = {"file": "poses.csv", **tables.pop("motion", {})}
    path = folder / "mine.toml"
    path.write_text(tomli_w.dumps({"name": "mine", "motion": motion, **tables}))
    return read_scenario(path)


def composed(folder: Path, lines: list[str] | None = None, **tables: Any) -> World:
    return world_of(read(folder, lines, **tables))


def suns_and_exposures() -> list[str]:
    header = (*pose_columns("cam_from_target"), "sun_x", "sun_y", "sun_z", "exposure_ms")
    rows = [
        row_of(0.0, facing(5.0), 1.0, 0.0, 0.0, 2.0),
        row_of(1.0, facing(4.0), 0.0, 0.6, 0.8, 3.0),
    ]
    return [",".join(header), *rows]


def test_both_exposures_of_a_still_pair_are_at_its_row(tmp_path: Path) -> None:
    world = composed(tmp_path, camera=OWN_CAMERA)
    assert world.chain == "retroreflector_pairs"
    assert [(e.frame, e.band) for e in world.exposures[:3]] == [(0, 800), (0, 850), (1, 800)]
    for early, late in zip(world.exposures[::2], world.exposures[1::2], strict=True):
        assert late.time_s - early.time_s == pytest.approx(0.033)
        assert world.trajectory.cam_from_target(early.time_s) is world.trajectory.cam_from_target(
            late.time_s
        )
    first = world.trajectory.cam_from_target(world.exposures[0].time_s)
    np.testing.assert_allclose(first.matrix(), facing(6.0).matrix(), atol=1e-12)


def test_between_interpolated_poses_the_earlier_exposure_is_earlier(tmp_path: Path) -> None:
    world = composed(tmp_path, motion={"poses": "interpolated", "rate_hz": 2.0})
    early, late = world.exposures[4:6]
    fallen_m = np.diff(
        [world.trajectory.cam_from_target(e.time_s).translation[2] for e in (early, late)]
    )[0]
    assert fallen_m == pytest.approx(-0.5 * 0.033, rel=1e-6)  # 6 m to 4.5 m in three seconds
    world.trajectory.cam_from_target(world.exposures[0].time_s - 0.016)  # the open shutter's start


def test_the_rows_give_sun_and_exposure(tmp_path: Path) -> None:
    world = composed(tmp_path, suns_and_exposures())
    for exposure in world.exposures:
        expected = [(1.0, 0.0, 0.0), (0.0, 0.6, 0.8)][exposure.frame]
        assert world.lit_by(exposure)[0].direction_in_target == pytest.approx(expected)
    assert [entry.exposure_ms for entry in world.frame_entries(None)] == [2.0, 3.0]


def test_exposures_of_single_images_are_meant_for_the_chips_own_pixels(tmp_path: Path) -> None:
    camera = OWN_CAMERA | {"rendered_width": 480}
    world = composed(tmp_path, suns_and_exposures(), camera=camera, frame={"kind": "single"})
    assert world.chain == "posed_images"
    assert [entry.exposure_ms for entry in world.frame_entries(None)] == [2.0 / 16, 3.0 / 16]


def test_a_target_without_markers_is_told_as_its_drawing_and_no_pose(tmp_path: Path) -> None:
    world = composed(tmp_path, target="xmm", exposure={"mode": "fixed"})
    onboard = world.onboard(0)
    assert onboard.wireframe is not None
    assert (onboard.markers, onboard.prior, world.chaser) == (None, None, None)
    assert dataset_info(world).onboard == ("camera.toml", "detector.toml", "wireframe.json")


def test_own_markers_are_where_they_are_and_told_as_surveyed(tmp_path: Path) -> None:
    survey = {"markers": {"place_m": {"sigma": 0.001}}}
    world = composed(tmp_path, markers=OWN_MARKERS, told=survey)
    places = [row["point_in_target_m"] for row in OWN_MARKERS["marker"]]
    assert world.target.markers is not None
    np.testing.assert_array_equal(world.target.markers.points_in_target, places)
    surveyed = world.onboard(3).markers
    assert surveyed is not None
    errors = surveyed.points_in_target - places
    assert 0.0 < np.abs(errors).max() < 0.005
    assert "sigmas.toml" in public_files(world)
    assert "marker_supports" not in world.target.part_names


def test_a_marker_inside_the_target_is_refused(tmp_path: Path) -> None:
    first, *others = OWN_MARKERS["marker"]
    sunk = {**OWN_MARKERS, "marker": [{**first, "point_in_target_m": [0.0, 0.0, -1.5]}, *others]}
    with pytest.raises(ScenarioError, match="marker 'a'"):
        composed(tmp_path, markers=sunk).target  # noqa: B018


def test_a_camera_inside_the_target_is_refused(tmp_path: Path) -> None:
    header, *rows = pose_lines(2)
    world = composed(tmp_path, [header, *rows, row_of(5.0, facing(0.001, (180.0, 0.0, 0.0)))])
    world.check_poses()
    deep = facing(0.5, (180.0, 0.0, 0.0))  # from below the deck, inside the bus
    with pytest.raises(ScenarioError, match=r"outside the target; at 5\.0 s"):
        composed(tmp_path, [header, *rows, row_of(5.0, deep)]).check_poses()


def test_the_clock_on_board_stamps_all_that_is_told(tmp_path: Path) -> None:
    clock = {"offset_s": {"offset": 0.25}, "drift_ppm": {"offset": 100.0}}
    table = tumble_table(told={"clock": clock})
    world = world_of(Scenario.model_validate(table))
    navigation = public_files(world)["navigation.csv"].splitlines()[1:]
    times_s = [float(line.split(",")[1]) for line in navigation]
    shown = [world.clock(0).shows(time_s) for time_s in world.scenario.times_s]
    assert times_s == shown
    assert shown == pytest.approx([0.25, 50.255, 100.26])
    exact = world_of(Scenario.model_validate(tumble_table()))
    positions = [line.split(",")[2:] for line in navigation]
    assert positions == [
        line.split(",")[2:] for line in public_files(exact)["navigation.csv"].splitlines()[1:]
    ]


def test_what_was_metered_by_an_inexact_clock_is_gone_on_with(tmp_path: Path) -> None:
    table = tumble_table(
        told={"clock": {"offset_s": {"offset": 0.25}}},
        exposure={"mode": "auto", "exposure_ms": 4.0},
    )
    world = world_of(Scenario.model_validate(table))
    first = ExposureControl(world, None)
    dark = np.zeros((64, 64), dtype=np.uint16)
    first.entry(2, lambda index: dark)
    resumed = ExposureControl(world, None)
    resumed.resume([world.clock(0).stamped(entry) for entry in first.entries])
    assert resumed.entries == first.entries
    unstamped = ExposureControl(world, None)
    unstamped.resume(first.entries)
    assert len(unstamped.entries) == 1


def test_a_date_puts_the_sun_into_inertial_axes(tmp_path: Path) -> None:
    table = tumble_table(
        motion={"end_s": 100.0, "rate_hz": 0.02, "epoch_utc": EPOCH}, sun={"default": "epoch"}
    )
    scenario = Scenario.model_validate(table)
    world = world_of(scenario)
    x, y, z = sun_dir_in_inertial(epoch_of(EPOCH)).tolist()
    typed = world_of(
        scenario.model_copy(
            update={"sun": scenario.sun.model_copy(update={"default": f"{x!r},{y!r},{z!r}"})}
        )
    )
    for time_s in scenario.times_s:
        by_date = world.sun_at(world.sun, time_s).direction_in_target
        # The Sun itself moves by 1 deg a day: 1e-3 deg in 100 s.
        assert by_date == pytest.approx(
            typed.sun_at(typed.sun, time_s).direction_in_target, abs=3e-5
        )
    world.check_poses()


def test_a_date_on_which_the_earth_hides_the_sun_is_refused() -> None:
    """The Sun stands at the March equinox; the chaser, behind the Earth of it, in shadow."""
    orbit = {"a_km": 7000.0, "raan_deg": 0.0, "argument_of_perigee_deg": 0.0}
    tumble = {**tumble_table()["tumble"], "orbit": {**orbit, "true_anomaly_deg": 180.0}}
    motion = {"end_s": 1.0, "rate_hz": 0.5, "epoch_utc": EPOCH}
    table = tumble_table(motion=motion, sun={"default": "epoch"}, tumble=tumble)
    told = r"got epoch: in all 1 images, .* the target is in the Earth.s shadow"
    with pytest.raises(ScenarioError, match=told):
        world_of(Scenario.model_validate(table)).check_poses()
    lit = {**tumble, "orbit": {**orbit, "true_anomaly_deg": 0.0}}
    world_of(Scenario.model_validate({**table, "tumble": lit})).check_poses()


def test_every_difference_reaches_a_free_targets_files() -> None:
    told = {k: v for k, v in every_difference().items() if k != "markers"}
    exact, off = (
        world_of(Scenario.model_validate(tumble_table(**extra))) for extra in ({}, {"told": told})
    )
    plain, other = public_files(exact), public_files(off)
    assert set(other) - set(plain) == {"sigmas.toml", "optics.toml"}
    for name in plain:
        assert other[name] != plain[name], name


def test_runs_know_otherwise_and_see_the_same(tmp_path: Path) -> None:
    world = composed(tmp_path, told={"camera": {"fx": {"sigma": 1.0}}})
    first, second = world.onboard(0).camera, world.onboard(1).camera
    assert first.fx != second.fx != world.camera.fx
    assert replace(first, fx=1000.0) == replace(second, fx=1000.0)
