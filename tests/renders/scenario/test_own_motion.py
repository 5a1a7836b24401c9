"""Poses, Suns, exposures and markers that a scenario's files bring."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from models.errors import ScenarioError
from models.motion.pose_table import pose_columns
from models.motion.table_motion import SmoothMotion, Stills
from renders.scenario.marker_tables import markers_from
from renders.scenario.motion_choice import table_motion_of
from renders.scenario.scenario import RenderRequest, Scenario, read_scenario, resolve
from tests.support.own_scenario import OWN_MARKERS, facing, pose_lines, row_of
from tests.support.tumble_scenario import tumble_table

SUN = ("sun_x", "sun_y", "sun_z")


def written(folder: Path, table: dict[str, Any], lines: list[str] | None = None) -> Path:
    (folder / "poses.csv").write_text("\n".join(lines or pose_lines(4)) + "\n")
    path = folder / "mine.toml"
    path.write_text(tomli_w.dumps({"name": "mine", **table}))
    return path


def poses(**changes: Any) -> dict[str, Any]:
    return {"motion": {"file": "poses.csv", **changes}}


def lines_with(more: tuple[str, ...], *rows: tuple[float, ...]) -> list[str]:
    header = ",".join((*pose_columns("cam_from_target"), *more))
    return [header, *(row_of(float(k), facing(5.0), *row) for k, row in enumerate(rows))]


# Motions


def test_a_table_of_poses_is_stills_unless_it_says_otherwise(tmp_path: Path) -> None:
    scenario = read_scenario(written(tmp_path, poses()))
    assert (scenario.motion_kind, scenario.frame_kind) == ("poses", "pairs")
    assert scenario.times_s == [0.0, 1.0, 2.0, 3.0]
    assert isinstance(table_motion_of(scenario), Stills)


def test_a_motion_through_them_is_sampled_at_its_rate(tmp_path: Path) -> None:
    path = written(tmp_path, poses(poses="interpolated", rate_hz=4.0))
    scenario = read_scenario(path)
    np.testing.assert_allclose(scenario.times_s, np.arange(0.0, 3.01, 0.25))
    motion = table_motion_of(scenario)
    assert isinstance(motion, SmoothMotion)
    motion.cam_from_target(scenario.times_s[0] - 0.033)  # the first pair's earlier exposure


def test_a_span_takes_some_of_the_rows(tmp_path: Path) -> None:
    request = RenderRequest(str(written(tmp_path, poses())), Path("unused"))
    assert resolve(replace(request, start_s=1.0, end_s=2.5)).times_s == [1.0, 2.0]
    with pytest.raises(ScenarioError, match="between two rows"):
        resolve(replace(request, start_s=1.2, end_s=1.8))
    with pytest.raises(ScenarioError, match="within the table of poses, 0 to 3 s"):
        resolve(replace(request, end_s=4.0))


def test_the_resolved_scenario_needs_no_file_and_its_fingerprint_knows_the_content(
    tmp_path: Path,
) -> None:
    scenario = read_scenario(written(tmp_path, poses()))
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "again.toml").write_text(scenario.to_toml())
    again = read_scenario(elsewhere / "again.toml")
    assert again == scenario
    assert again.fingerprint() == scenario.fingerprint()
    moved = [*pose_lines(4)[:-1], row_of(3.0, facing(4.5))]
    assert read_scenario(written(tmp_path, poses(), moved)).fingerprint() != scenario.fingerprint()


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (poses(kind="approach"), 'with motion.kind = "poses" alone, got it with "approach"'),
        ({"motion": {"kind": "poses"}}, "expected motion.file, a CSV file of poses"),
        ({"motion": {"poses": "stills"}}, "motion.poses with motion.kind"),
        ({"motion": {"kind": "tumble"}}, "no table [tumble]"),
        (tumble_table(frame={"kind": "pairs"}), 'frame.kind = "single" with [tumble]'),
        (poses(rate_hz=2.0), "motion.rate_hz to be left out with stills"),
        (poses(target_wobble=False), "motion.target_wobble to be left out with poses"),
        (poses(pair_gap_ms=1000.0), "below the time between pairs, 1000 ms, got 1000"),
        (poses(table=pose_lines(2)), "motion.file or motion.table, got both"),
        ({"motion": {"file": "absent.csv"}}, "absent.csv"),
        ({"motion": {"file": 3}}, "motion.file to be text"),
        ({"motion": {"table": 3}}, "motion.table to be a list"),
        ({"motion": {"table": ["a,b", "1,2"]}}, "motion.table:1: expected a header that names"),
        (poses() | {"frame": {"kind": "single"}}, "exposure.mode, of single images"),
        (
            poses() | {"frame": {"kind": "single"}, "exposure": {"mode": "fixed"}}
            | {"lamps": {"count": 4}},
            "lamps.count to be left out with single images",
        ),
        (poses() | {"frame": {"kind": "triple"}}, "frame.kind as one of 'pairs'"),
        (poses() | {"frame": {}}, "expected the key frame.kind"),
    ],
)  # fmt: skip
def test_a_motion_that_is_none_or_told_twice_is_refused(
    tmp_path: Path, table: dict[str, Any], said: str
) -> None:
    with pytest.raises(ScenarioError) as told:
        read_scenario(written(tmp_path, table))
    assert said in str(told.value)


def test_a_target_without_markers_is_seen_in_single_images(tmp_path: Path) -> None:
    table = poses() | {"target": "xmm", "exposure": {"mode": "fixed"}}
    assert read_scenario(written(tmp_path, table)).frame_kind == "single"
    marked = table | {"markers": OWN_MARKERS}
    assert read_scenario(written(tmp_path, marked)).frame_kind == "pairs"


# Suns and exposures of the rows, and the Sun by the date


def test_the_rows_sun_and_exposure_hold_unless_another_is_typed(tmp_path: Path) -> None:
    lines = lines_with((*SUN, "exposure_ms"), (1.0, 0.0, 0.0, 2.0), (0.0, 0.0, 1.0, 3.0))
    path = written(tmp_path, poses(), lines)
    scenario = read_scenario(path)
    assert (scenario.sun.default, scenario.exposure.mode) == ("table", "table")
    request = RenderRequest(str(path), Path("unused"), sun="S4")
    assert resolve(request).sun.default == "S4"


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (poses() | {"sun": {"default": "table"}}, "with sun_x, sun_y and sun_z"),
        (poses() | {"exposure": {"mode": "table"}}, "with a column exposure_ms"),
        ({"exposure": {"mode": "table"}}, "with a column exposure_ms"),
        ({"sun": {"default": "epoch"}}, "expected motion.epoch_utc"),
        (poses(epoch_utc="2026-03-20T12:00:00Z"), "expected [tumble] or an approach"),
        (tumble_table(sun={"default": "S2"}), 'such as "0.3,-0.5,1", or "epoch"'),
        (
            tumble_table(
                motion={"epoch_utc": "2026-03-20"}, sun={"default": "0,0,1"}
            ),
            "motion.epoch_utc: expected a date and time in UTC",
        ),
        ({"sun": {"shared": ["table"]}}, "expected a Sun among"),
    ],
)  # fmt: skip
def test_a_sun_or_exposure_that_nothing_gives_is_refused(
    tmp_path: Path, table: dict[str, Any], said: str
) -> None:
    with pytest.raises(ScenarioError) as told:
        read_scenario(written(tmp_path, table))
    assert said in str(told.value)


def test_an_exposure_of_a_row_ends_before_the_next_begins(tmp_path: Path) -> None:
    lines = lines_with(("exposure_ms",), (2.0,), (40.0,))
    with pytest.raises(ScenarioError, match=r"below motion.pair_gap_ms, 33 ms.*got 40 ms at 1 s"):
        read_scenario(written(tmp_path, poses(), lines))


@pytest.mark.parametrize("epoch", ['"2026-03-20T12:00:00Z"', "2026-03-20T12:00:00Z"])
def test_a_date_gives_the_sun_as_text_or_as_tomls_own(tmp_path: Path, epoch: str) -> None:
    table = tumble_table()
    del table["sun"]
    path = written(tmp_path, table)
    text = path.read_text().replace("[motion]", f"[motion]\nepoch_utc = {epoch}")
    path.write_text(text)
    scenario = read_scenario(path)
    assert scenario.motion.epoch_utc == "2026-03-20T12:00:00Z"
    assert scenario.sun.default == "epoch"


# Markers


def test_markers_come_from_a_file_or_stand_in_the_scenario(tmp_path: Path) -> None:
    (tmp_path / "markers.toml").write_text(tomli_w.dumps(OWN_MARKERS))
    by_file = read_scenario(written(tmp_path, {"markers": "markers.toml"}))
    here = read_scenario(written(tmp_path, {"markers": OWN_MARKERS}))
    assert by_file == here
    assert by_file.markers is not None
    pattern = markers_from(by_file.markers, "here")
    assert pattern.names == ("a", "b", "c", "d", "e")
    assert pattern.radius_m == 0.02
    (tmp_path / "again.toml").write_text(by_file.to_toml())
    assert read_scenario(tmp_path / "again.toml") == by_file


def marker(**changes: Any) -> dict[str, Any]:
    first, *others = OWN_MARKERS["marker"]
    return {**OWN_MARKERS, "marker": [{**first, **changes}, *others]}


@pytest.mark.parametrize(
    ("markers", "said"),
    [
        ("absent.toml", "absent.toml"),
        (3, "markers to be a table"),
        ({**OWN_MARKERS, "marker": OWN_MARKERS["marker"][:2]}, "at least 3"),
        (marker(kind="lamp"), "markers.marker.0.kind as one of 'retroreflector'"),
        (marker(name="a.b"), "markers.marker.0.name of letters, digits"),
        (marker(name="b"), "each marker's name once"),
        (marker(normal_in_target=[0.0, 0.0, 2.0]), "normals of length one"),
        (marker(place=[0.0, 0.0, 0.0]), "unknown key markers.marker.0.place; expected one of name"),
    ],
)
def test_markers_of_which_no_pose_follows_are_refused(
    tmp_path: Path, markers: Any, said: str
) -> None:
    with pytest.raises(ScenarioError) as told:
        read_scenario(written(tmp_path, {"markers": markers}))
    assert said in str(told.value)


def test_a_marker_file_knows_the_kinds_there_are(tmp_path: Path) -> None:
    (tmp_path / "markers.toml").write_text(tomli_w.dumps(marker(kind="lamp")))
    with pytest.raises(ScenarioError, match=r"marker\.0\.kind as one of retroreflector, white_dot"):
        read_scenario(written(tmp_path, {"markers": "markers.toml"}))


# What is told


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"told": {"mount": {"turn_deg": {"sigma": 0.1}}}}, "told.mount to be left out"),
        ({"told": {"target": {"inertia_scale": {"sigma": 0.1}}}}, "told.target to be left out"),
        (tumble_table(told={"markers": {}}), "told.markers to be left out"),
        ({"told": {"camera": {"fz": {"sigma": 1.0}}}}, "unknown key told.camera.fz"),
        ({"told": {"camera": {"fx": {"sigma": -1.0}}}}, "told.camera.fx.sigma from 0 to"),
        ({"told": {"camera": {"fx": 1.0}}}, "told.camera.fx to be a table"),
    ],
)
def test_what_nobody_is_told_cannot_be_told_otherwise(
    tmp_path: Path, table: dict[str, Any], said: str
) -> None:
    with pytest.raises(ScenarioError) as told:
        read_scenario(written(tmp_path, table))
    assert said in str(told.value)


def test_an_inertia_that_is_not_known_is_not_told_otherwise(tmp_path: Path) -> None:
    table = tumble_table(told={"target": {"inertia_scale": {"sigma": 0.1}}})
    read_scenario(written(tmp_path, table))
    table["tumble"] = {**table["tumble"], "onboard": {"knows_inertia": False}}
    with pytest.raises(ScenarioError, match="knows_inertia is false"):
        read_scenario(written(tmp_path, table))


def test_a_plain_scenario_tells_everything_as_it_is() -> None:
    scenario = Scenario(name="x")  # type: ignore[call-arg]
    assert (scenario.told, scenario.markers, scenario.frame) == (None, None, None)
