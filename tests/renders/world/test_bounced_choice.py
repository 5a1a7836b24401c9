"""Bounced light is traced once where that serves many exposures, and never where the Sun turns."""

from __future__ import annotations

from pathlib import Path

import pytest

from models.errors import ScenarioError
from renders.scenario.scenario import RenderRequest, Scenario, resolve
from renders.world.bounced_choice import LEAST_EXPOSURES, seen_from, told
from renders.world.build import world_of
from renders.world.world import World
from tests.support.tumble_scenario import tumble_table


def approach(end_s: float, **render: object) -> World:
    request = RenderRequest("maxar-demo", Path(), end_s=end_s, width=128)
    table = resolve(request).model_dump()
    table["render"].update(render)
    return world_of(Scenario(**table))


def test_many_exposures_share_what_is_traced_once() -> None:
    world = approach(290.0, noise=0.5)
    assert len(world.exposures) >= LEAST_EXPOSURES
    poses = seen_from(world, is_jit=True)
    assert poses is not None
    assert len(poses) == len(world.exposures)
    assert "once for the Sun" in told(poses, 1)


@pytest.mark.parametrize(
    "world",
    [
        approach(290.0),
        approach(290.0, noise=0.5, bounced="traced"),
        approach(240.0, noise=0.5),
    ],
    ids=["as many samples in each pixel", "asked for", "two exposures"],
)
def test_it_is_traced_in_each_otherwise(world: World) -> None:
    assert seen_from(world, is_jit=True) is None
    assert "in each exposure" in told(None, 7)


def test_it_is_looked_up_if_asked_for_but_not_without_a_jit() -> None:
    world = approach(240.0, bounced="looked_up")
    assert seen_from(world, is_jit=True) is not None
    assert seen_from(world, is_jit=False) is None


def test_a_sun_that_turns_over_the_target_is_refused() -> None:
    table = tumble_table()
    table.setdefault("render", {})["bounced"] = "looked_up"
    with pytest.raises(ScenarioError, match="the Sun turns over the target, got looked_up"):
        seen_from(world_of(Scenario(**table)), is_jit=True)
