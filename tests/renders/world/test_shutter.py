"""What rows take of instants: all of the light, at the right time, spread over the exposure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import ScenarioError
from models.pose import RigidTransform
from renders.batches.stepping import Steered
from renders.scenario.scenario import Scenario, check_scenario
from renders.world.build import world_of
from renders.world.exposure import Exposure
from renders.world.shutter import MOST_INSTANTS, STEP_PX, open_shutter, row_weights

ROUNDING = 1e-9
SIDEWAYS_M_S = 0.4
AHEAD = RigidTransform(np.diag([1.0, -1.0, -1.0]), np.array([0.0, -0.9, 6.0]))
APPROACH = {"name": "t", "camera": {"preset": "chaser_fixed", "width": 256}}


def scenario(shutter, **tables):
    return Scenario(**APPROACH, shutter=shutter, **tables)


def world(shutter, exposure_ms=40.0, motion=None):
    exposure = {"mode": "fixed", "exposure_ms": exposure_ms}
    made = world_of(scenario(shutter, exposure=exposure))
    return replace(made, trajectory=Steered(motion or sideways))


def sideways(time_s):
    away = np.array([SIDEWAYS_M_S * (time_s - 10.0), 0.0, 0.0])
    return RigidTransform(AHEAD.rotation, AHEAD.translation + away)


def made_of_px(opened):
    return STEP_PX * (len(opened.poses) - 1)


@given(
    instants=st.integers(3, 60),
    rows=st.integers(1, 40),
    open_share=st.floats(0.0, 1.0),
)
def test_light_that_is_linear_in_time_is_seen_at_each_rows_own_time(instants, rows, open_share):
    open_s = open_share * 0.02
    row_s = (0.02 - open_s) / max(rows - 1, 1)
    spread_s = open_s + row_s * (rows - 1)
    if spread_s < 1e-6:
        return
    offsets = np.linspace(-0.5 * spread_s, 0.5 * spread_s, instants)
    middles = row_s * (np.arange(rows) - 0.5 * (rows - 1))
    weights = row_weights(offsets, middles, open_s)
    assert (weights >= -ROUNDING).all()
    np.testing.assert_allclose(weights.sum(axis=0), 1.0, atol=ROUNDING)
    np.testing.assert_allclose(offsets @ weights, middles, atol=ROUNDING)


def test_an_exposure_is_seen_evenly():
    offsets = np.linspace(-0.5, 0.5, 401)
    weights = row_weights(offsets, np.zeros(1), 1.0)[:, 0]
    # Of light that was on for a box of time, the mean square is a twelfth of its square.
    assert offsets**2 @ weights == pytest.approx(1.0 / 12.0, rel=1e-4)


def test_nothing_is_added_up_where_nothing_moves_or_nobody_asks():
    shown = Exposure(0, 850, 10.0)
    assert open_shutter(world({}), shown, None) is None
    assert open_shutter(world({"blur": True}, motion=AHEAD), shown, None) is None
    assert open_shutter(world({"blur": True}, exposure_ms=0.01), shown, None) is None


def test_instants_lie_closer_than_a_step_and_as_long_as_the_shutter_is_open():
    made = world({"blur": True})
    opened = open_shutter(made, Exposure(0, 850, 10.0), None)
    assert opened.offsets_s[-1] - opened.offsets_s[0] == pytest.approx(0.04)
    nearest = max(part.mesh.vertices[:, 2].max() for part in made.target.parts)
    moved_px = made.camera.fx * SIDEWAYS_M_S * 0.04 / (AHEAD.translation[2] - nearest)
    assert moved_px / (len(opened.poses) - 1) <= STEP_PX * 1.05
    np.testing.assert_allclose(opened.poses[0].matrix(), sideways(9.98).matrix())
    assert opened.samples(64) == 64 // 2 ** int(np.log2(len(opened.poses) - 1))


def test_a_rolling_shutter_reads_from_the_top():
    opened = open_shutter(world({"row_us": 100.0}), Exposure(0, 850, 10.0), None)
    seen_s = opened.offsets_s @ opened.row_weights
    np.testing.assert_allclose(np.diff(seen_s), 1e-4, atol=ROUNDING)
    assert seen_s.sum() == pytest.approx(0.0, abs=ROUNDING)


def test_what_crosses_the_image_is_blurred_though_nothing_stays_in_it():
    fast = world({"blur": True}, motion=lambda t: sideways(10.0 + 300.0 * (t - 10.0)))
    opened = open_shutter(fast, Exposure(0, 850, 10.0), None)
    assert opened is not None
    assert made_of_px(opened) > 0.5 * fast.camera.width
    assert len(opened.poses) <= MOST_INSTANTS


def test_rows_that_are_read_into_the_next_image_are_refused():
    slow = scenario({"row_us": 200.0}, motion={"pair_gap_ms": 33.0})
    with pytest.raises(ScenarioError, match="read before the next image begins"):
        check_scenario(slow, "here")


@pytest.mark.parametrize(
    ("tables", "told"),
    [
        ({"exposure": {"mode": "auto"}}, "exposure.mode"),
        ({"render": {"noise": 0.5}}, "render.noise"),
        ({"render": {"paths": 1024}}, "render.paths"),
    ],
)
def test_what_must_be_known_before_light_is_traced_is_asked_for(tables, told):
    with pytest.raises(ScenarioError, match=told):
        check_scenario(scenario({"blur": True}, **tables), "here")


def test_a_scenario_without_a_shutter_is_what_it_was():
    plain, empty = scenario(None), scenario({})
    assert "shutter" not in plain.to_toml()
    assert plain.fingerprint() != empty.fingerprint()
    check_scenario(scenario({}, render={"noise": 0.5}), "here")
