"""Absolute and relative navigation in one: what the one does not know, the other is told of."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bench.suites.pesce2019.synthetic_points import PointNoise
from bench.suites.vinag2018.chain_run import corner_frames
from models.estimate import Estimate
from models.frame import POINTS, Frame, TableReading
from models.motion.relative_state import CHASER_ORBIT_COLUMNS, relative_state
from models.navigation_tables import GNSS, INERTIAL
from pipelines.absolute.pipeline import INTEGRITY, ORBIT
from pipelines.integrated.pipeline import RELATIVE_PROTECTION
from pipelines.registry import registered_pipeline
from renders.scenario.scenario import Scenario
from renders.world.build import world_of
from renders.world.world import World
from tests.support.tumble_scenario import TUMBLE, tumble_table

START_S, END_S = 20.0, 70.0
SETTLED = slice(20, None)  # of the frames: the relative filters have learnt the rates
ALIKE = 1.05  # of the errors with a chaser state that is true


def scenario(**navigation: Any) -> Scenario:
    exact = {"chaser_sigma_m": 0.0, "chaser_sigma_m_s": 0.0}
    stated = navigation.get("by") == "stated"
    return Scenario.model_validate(
        tumble_table(
            motion={
                "start_s": START_S,
                "end_s": END_S,
                "rate_hz": 1.0,
                "epoch_utc": "2026-03-20T12:00:00Z",
            },
            tumble={**TUMBLE, "onboard": exact if stated else {}},
            navigation={"field_degree": 4, **navigation},
        )
    )


def frames_of(world: World) -> list[Frame]:
    """Return corners at 0.1 px and one false one, beside what the chaser's sensors gave."""
    return list(corner_frames(world, PointNoise(0.1, 1), 1, 0))


def errors_m(world: World, said: list[Estimate]) -> np.ndarray:
    assert world.absolute is not None
    errors = []
    for each in said:
        state = relative_state(each)
        assert state is not None
        was = world.absolute.state(each.time_s)
        errors.append(np.linalg.norm(state.rho_in_lvlh - was.rho_in_lvlh))
    return np.array(errors)


@pytest.fixture(scope="module")
def navigated() -> tuple[World, list[Frame], list[Estimate]]:
    world = world_of(scenario())
    frames = frames_of(world)
    own = registered_pipeline("integrated").make(world.onboard(0), "best")
    return world, frames, [own.process(frame) for frame in frames]


def test_the_target_is_found_as_well_as_from_a_chaser_that_knows_its_state(navigated):
    world, _, said = navigated
    perfect = world_of(scenario(by="stated"))
    assert [each.name for each in perfect.tables] == ["chaser_orbit"]
    other = registered_pipeline("uncooperative").make(perfect.onboard(0), "best")
    known = [other.process(frame) for frame in frames_of(perfect)]
    own_m, known_m = errors_m(world, said)[SETTLED], errors_m(perfect, known)[SETTLED]
    assert np.sqrt(np.mean(own_m**2)) < ALIKE * np.sqrt(np.mean(known_m**2))


def test_the_chaser_is_known_at_the_image_and_not_at_its_last_record(navigated):
    """A fifth of a second of flight is 1.5 km; the pictures are not at the sensors' instants."""
    world, _, said = navigated
    own = registered_pipeline("integrated").make(world.onboard(0), "best")
    between = [replace(frame, time_s=frame.time_s + 0.13) for frame in frames_of(world)[:8]]
    for frame, at in zip(between, said, strict=False):
        told = own.process(frame)
        assert world.absolute is not None
        was = world.absolute.chaser_state(frame.time_s)
        for each, true in ((told, was), (at, world.absolute.chaser_state(at.time_s))):
            orbit = each.states[ORBIT]
            off = orbit.values["position_in_inertial_m"] - true.position_in_inertial
            assert orbit.covariance is not None
            assert off @ np.linalg.solve(orbit.covariance[:3, :3], off) < 25.0
            assert np.linalg.norm(off) < 10.0


def test_it_says_how_far_the_relative_position_may_be_off(navigated):
    world, _, said = navigated
    assert world.absolute is not None
    last = said[-1]
    state, was = relative_state(last), world.absolute.state(last.time_s)
    levels = last.states[INTEGRITY].values[RELATIVE_PROTECTION]
    assert state is not None
    assert (np.abs(state.rho_in_lvlh - was.rho_in_lvlh) < levels).all()
    assert levels.max() < 1.0


def test_an_image_that_comes_late_is_passed_by_and_harms_nothing(navigated):
    world, frames, said = navigated
    own = registered_pipeline("integrated").make(world.onboard(0), "best")
    for frame in frames[:4]:
        own.process(frame)
    empty = {
        name: TableReading(each.columns, np.zeros(0), np.zeros((0, len(each.columns))))
        for name, each in frames[2].readings.items()
        if isinstance(each, TableReading) and name != POINTS
    }
    late = own.process(replace(frames[2], index=99, readings={**frames[2].readings, **empty}))
    assert late.reason is not None
    assert "late" in late.reason
    assert late.pose is None
    after = own.process(frames[4])
    np.testing.assert_array_equal(
        relative_state(after).rho_in_lvlh, relative_state(said[4]).rho_in_lvlh
    )


def test_without_gyroscopes_the_chaser_is_lost_and_says_so(navigated):
    world, frames, _ = navigated
    own = registered_pipeline("integrated").make(world.onboard(0), "best")
    blind = {name: each for name, each in frames[0].readings.items() if name != INERTIAL}
    said = own.process(replace(frames[0], readings=blind))
    assert said.reason is not None
    assert "the chaser's own state is not known" in said.reason


def test_streams_are_whole_and_keyed_by_run():
    """Each record comes once, with the frame after it; another run has other noise."""
    world = world_of(scenario())
    for sensor in world.tables:
        parts = [
            sensor.reading(frame, now_s, since_s, 0)
            for frame, (now_s, since_s) in enumerate(
                zip(world.scenario.times_s, [-np.inf, *world.scenario.times_s], strict=False)
            )
        ]
        times_s = np.concatenate([each.time_s for each in parts])
        whole = sensor.reading(0, END_S, -np.inf, 0)
        np.testing.assert_array_equal(times_s, whole.time_s)
        assert times_s.max() == pytest.approx(END_S)
        assert times_s.min() < 1.5
        other = sensor.reading(0, END_S, -np.inf, 1)
        assert other.time_s.shape == whole.time_s.shape
        assert not np.array_equal(other.rows, whole.rows)
    starts = [world.onboard(run).tables["absolute.toml"]["position_m"] for run in (0, 0, 1)]
    assert starts[0] == starts[1] != starts[2]
    assert GNSS in {each.name for each in world.tables}
    assert CHASER_ORBIT_COLUMNS not in {each.columns for each in world.tables}


def test_in_its_absolute_mode_it_looks_at_no_target(navigated):
    """The switch of VINAG's section 3: the chaser's own state is told, images are passed by."""
    _, frames, said = navigated
    switched = world_of(scenario(relative_from_s=START_S + 3.0))
    own = registered_pipeline("integrated").make(switched.onboard(0), "best")
    told = [own.process(frame) for frame in frames[:5]]
    assert [each.mode for each in told[:3]] == ["absolute"] * 3
    assert all(ORBIT in each.states and relative_state(each) is None for each in told[:3])
    assert told[3].mode == said[0].mode == "acquired"
    np.testing.assert_array_equal(
        told[3].states[ORBIT].values["position_in_inertial_m"],
        said[3].states[ORBIT].values["position_in_inertial_m"],
    )
