"""What a sweep is asked to do is found in the approach, or refused with what is possible."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.sweep.plan import (
    SweepRequest,
    moment_at_range,
    plan_sweep,
    range_at,
    ranges_covered_m,
)
from models.errors import ScenarioError
from models.lights.sun import SUN_CASES_DEG
from renders.scenario.scenario import RenderRequest, resolve
from renders.world.build import world_of
from tests.support.own_scenario import pose_lines

WORLD = world_of(resolve(RenderRequest("maxar-approach", Path("unused"))))
MILLISECOND_M = 1.5e-5  # at 15 mm/s


def plan(**options):
    return plan_sweep(SweepRequest("maxar-approach", Path("unused"), **options))


@settings(max_examples=20)
@given(st.floats(*ranges_covered_m(WORLD)))
def test_at_the_moment_of_a_range_the_camera_is_that_far(range_m):
    time_s = moment_at_range(WORLD, range_m)
    assert 0.0 <= time_s <= 330.0
    assert time_s == round(time_s, 3)  # it can be typed
    assert range_at(WORLD, time_s) == pytest.approx(range_m, abs=MILLISECOND_M)


def test_poses_suns_and_pipelines():
    asked = plan(range_m=(2.5, 4.0), time_s=(10.0, 10.0), suns=("paper",), pipeline="paper")
    assert [pose.range_m for pose in asked.poses[:2]] == pytest.approx([2.5, 4.0], abs=1e-4)
    assert asked.poses[2].time_s == 10.0
    assert len(asked.poses) == 3
    assert [sun.name for sun in asked.suns] == list(SUN_CASES_DEG)
    assert [each.label for each in asked.pipelines] == ["paper"]
    assert len(plan(range_m=(2.5,)).suns) == 188
    assert len(plan(range_m=(2.5,), sun_step_deg=45.0).suns) == 22


def test_a_sweep_is_a_thousand_columns_wide_unless_asked():
    assert plan(range_m=(2.5,)).scenario.camera.width == 1024
    assert plan(range_m=(2.5,), width=2048).scenario.camera.width == 2048
    assert plan(range_m=(2.5,), width=256).scenario.camera.width == 256


def test_samples_reach_the_scenario():
    render = plan(range_m=(2.5,), spp=4, marker_samples=64).scenario.render
    assert (render.samples, render.marker_samples) == (4, 64)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({}, "--range-m from 1.97 to 6.78, or --time-s from 0 to 330; got neither"),
        ({"range_m": (9.0,)}, "expected --range-m from 1.97 to 6.78.* got 9"),
        ({"range_m": (1.0,)}, "expected --range-m from 1.97 to 6.78.* got 1"),
        ({"range_m": (float("nan"),)}, "expected --range-m from 1.97 to 6.78"),
        ({"time_s": (331.0,)}, "expected --time-s from 0 to 330.* got 331"),
        ({"time_s": (5.0,), "sun_step_deg": 7.0}, "divides 180.* 6.92308 is the nearest"),
        ({"time_s": (5.0,), "suns": ("S9",)}, "expected a Sun among S1.* got 'S9'"),
        ({"time_s": (5.0,), "suns": ("S1",), "sun_step_deg": 15.0}, "either a grid.* got both"),
        (
            {"time_s": (5.0,), "exposure_ms": (1.0, 0.0)},
            "expected --exposure-ms from 0.0001 to 100000, got 0",
        ),
        ({"time_s": (5.0,), "lamp_w_sr": (-1.0,)}, "expected --lamp-w-sr from .*, got -1"),
        ({"time_s": (5.0,), "exposure_ms": (float("nan"),)}, "expected --exposure-ms from"),
        ({"time_s": (5.0,), "lamp_w_sr": (float("inf"),)}, "expected --lamp-w-sr from"),
        ({"time_s": (float("nan"),)}, "expected --time-s from 0 to 330"),
        ({"time_s": (5.0,), "marker_samples": 0}, "--marker-samples from 1 to 65536, got 0"),
        ({"time_s": (5.0,), "marker_samples": 10**12}, "--marker-samples from 1 to 65536"),
        ({"time_s": (5.0,), "threads": 0}, "expected --threads from 1 to 512, got 0"),
        ({"time_s": (5.0,), "threads": 100_000}, "expected --threads from 1 to 512, got 100000"),
        ({"time_s": (5.0,), "memory_gb": float("nan")}, "expected --memory-gb from 0 to"),
        ({"time_s": (5.0,), "memory_gb": float("inf")}, "expected --memory-gb from 0 to"),
        ({"time_s": (5.0,), "memory_gb": 0.1}, "--memory-gb of at least 1 for 1024"),
        ({"time_s": (5.0,), "store_budget_gb": 0.001}, "--store-budget-gb of at least .* 1024"),
    ],
)
def test_what_cannot_be_is_refused_with_what_can(options, told):
    with pytest.raises(ScenarioError, match=told):
        plan(**options)


def of_stills(tmp_path, **options):
    (tmp_path / "poses.csv").write_text("\n".join(pose_lines(4)) + "\n")
    path = tmp_path / "still.toml"
    path.write_text('name = "still"\n[motion]\nkind = "poses"\nfile = "poses.csv"\n')
    return plan_sweep(SweepRequest(str(path), Path("unused"), **options))


def test_a_pose_of_stills_is_a_row_of_their_table(tmp_path):
    assert [pose.time_s for pose in of_stills(tmp_path, time_s=(2.0,)).poses] == [2.0]
    (pose,) = of_stills(tmp_path, range_m=(5.4,)).poses  # rows stand half a metre apart
    assert (pose.time_s, pose.range_m) == (1.0, pytest.approx(5.5))
    with pytest.raises(ScenarioError, match=r"of a row of still's table of poses.* such as 1"):
        of_stills(tmp_path, time_s=(1.3,))
    with pytest.raises(ScenarioError, match=r"expected --range-m from 4\.50 to 6\.00"):
        of_stills(tmp_path, range_m=(9.0,))


def test_light_that_was_traced_for_one_exposure_is_not_asked_for_another(tmp_path):
    case = tmp_path / "blurred.toml"
    case.write_text('name = "blurred"\n[shutter]\nblur = true\n')
    plan_sweep(SweepRequest(str(case), Path("unused"), time_s=(5.0,)))
    with pytest.raises(ScenarioError, match=r"no --exposure-ms with shutter\.blur"):
        plan_sweep(SweepRequest(str(case), Path("unused"), time_s=(5.0,), exposure_ms=(3.0,)))
