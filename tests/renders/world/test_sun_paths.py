"""Paths are followed from the Sun once where it stands still, and for each image where it turns."""

from __future__ import annotations

from pathlib import Path

from renders.scenario.scenario import RenderRequest, Scenario, resolve
from renders.store.light_keys import LightKeys
from renders.world.build import world_of
from renders.world.sun_paths import sun_paths, told
from renders.world.world import World
from tests.support.tumble_scenario import tumble_table


def approach(end_s: float, **render: object) -> World:
    request = RenderRequest("maxar-demo", Path(), end_s=end_s, width=128)
    table = resolve(request).model_dump()
    table["render"].update(render)
    return world_of(Scenario(**table))


def test_none_are_followed_unless_asked_for() -> None:
    assert sun_paths(approach(290.0)) is None
    assert "from the lens alone" in told(None, 7)


def test_a_frame_alone_is_lit_as_in_a_batch() -> None:
    batch, alone = (approach(end_s, paths=1000) for end_s in (290.0, 240.0))
    assert sun_paths(batch) == sun_paths(alone)
    keys = [LightKeys(world, "jit").bounced(world.sun) for world in (batch, alone)]
    assert keys[0] == keys[1]


def test_where_the_sun_stands_still_all_exposures_share_them() -> None:
    chosen = sun_paths(approach(290.0, paths=1000))
    assert chosen is not None
    assert chosen.once
    assert told(chosen, 1) == "1000 paths are followed from the Sun, once for all exposures"


def test_where_it_turns_each_image_has_its_own() -> None:
    table = tumble_table()
    table.setdefault("render", {})["paths"] = 1000
    chosen = sun_paths(world_of(Scenario(**table)))
    assert chosen is not None
    assert not chosen.once
    assert "from each of 2 Suns, in each exposure" in told(chosen, 2)


def test_a_scalar_variant_follows_none() -> None:
    assert LightKeys(approach(290.0, paths=1000), "scalar").sun_paths is None
