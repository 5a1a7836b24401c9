"""A range finder in a world: a stream beside the images, what it met behind the wall."""

from __future__ import annotations

import pytest

from models.errors import ScenarioError
from models.frame import RANGE
from renders.batches.public_half import dataset_info, public_files, table_readings
from renders.scenario.scenario import Scenario, check_scenario
from renders.truth.sealed_texts import sealed_texts
from renders.world.build import world_of
from renders.world.world import World
from tests.support.tumble_scenario import TUMBLE, tumble_table

UNKNOWN = {**TUMBLE, "onboard": {"knows_target": False}}
SIGMA_M, FRAMES = 0.01, 11


@pytest.fixture(scope="module")
def world() -> World:
    table = tumble_table(
        tumble=UNKNOWN,
        motion={"end_s": 100.0, "rate_hz": 0.1},
        range_finder={"sigma_m": SIGMA_M, "rate_hz": 0.05},
    )
    return world_of(check_scenario(Scenario.model_validate(table), "here"))


def test_every_other_frame_is_read_and_it_is_the_surface(world):
    sensor = world.tables[-1]
    assert sensor.name == RANGE
    readings = table_readings(world, sensor, 0)
    read = {frame: each.column("range_m")[0] for frame, each in readings if len(each.time_s)}
    assert set(read) == set(range(0, FRAMES, 2))
    for frame, range_m in read.items():
        truth = sensor.truth(world.scenario.times_s[frame])
        assert abs(range_m - truth.surface_m) < 5.0 * SIGMA_M
        assert truth.centre_m - truth.surface_m > 0.3  # the tube's wall is before its axis
        assert truth.centre_m == pytest.approx(30.0, abs=0.05)


def test_runs_differ_and_repeat(world):
    one, again, other = (public_files(world, run)["range.csv"] for run in (0, 0, 1))
    assert one == again
    assert one != other


def test_nothing_of_the_target_is_on_board(world):
    info, files = dataset_info(world), public_files(world)
    assert info.chain == "unknown_images"
    assert [each.name for each in info.streams] == ["image", "chaser_orbit", RANGE]
    assert "wireframe.json" not in files
    assert "inertia" not in files["knowledge.toml"]
    centre = f"{world.tables[-1].truth(0.0).centre_m:.3f}"
    assert centre not in files["range.csv"]


def test_truth_has_both_of_every_frame(world):
    lines = sealed_texts(world)["truth/ranges.csv"].splitlines()
    assert lines[0] == "index,surface_m,centre_m,met_share"
    assert len(lines) == 1 + FRAMES


def test_a_steered_camera_takes_its_beam_along(world):
    sensor, early = world.tables[-1], world.trajectory.cam_from_target(0.0)

    class Nearer:
        def cam_from_target(self, time_s):
            return early.__class__(early.rotation, early.translation - [0.0, 0.0, 5.0])

    moved = sensor.along(Nearer()).truth(0.0)
    assert moved.surface_m == pytest.approx(sensor.truth(0.0).surface_m - 5.0, abs=1e-6)


def test_a_known_target_may_have_one_too():
    table = tumble_table(range_finder={})
    world = world_of(check_scenario(Scenario.model_validate(table), "here"))
    assert world.chain == "tumble_images"
    assert "wireframe.json" in public_files(world)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"tumble": None, "range_finder": {}, "sun": {"default": "S2"}}, "without; no other"),
        (
            {"tumble": UNKNOWN, "told": {"target": {"inertia_scale": {"sigma": 0.1}}}},
            "told.target to be left out where tumble.onboard.knows_target",
        ),
    ],
)
def test_what_would_have_no_effect_is_refused(changes, told):
    table = {key: value for key, value in tumble_table(**changes).items() if value is not None}
    with pytest.raises(ScenarioError, match=told):
        check_scenario(Scenario.model_validate(table), "here")


@pytest.mark.parametrize("key", ["sigma_m", "rate_hz", "outlier_span_m"])
def test_a_range_finder_that_cannot_be_is_refused(key):
    with pytest.raises(ValueError, match=key):
        Scenario.model_validate(tumble_table(range_finder={key: 0.0}))
