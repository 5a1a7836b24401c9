"""A sweep's light: batched within memory, under the keys of single runs, however it is batched."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.camera import camera_preset
from models.errors import ScenarioError
from models.lights.sun_grid import NamedSun, chosen_suns
from renders.batches.studio import Studio
from renders.batches.sweep_batches import (
    BYTES_PER_SAMPLE_SUM,
    GIBI,
    MOST_SUNS,
    PoseLight,
    even_batches,
    scenario_at,
    suns_in_a_batch,
)
from renders.scenario.scenario import RenderRequest, Scenario, read_scenario, resolve
from renders.store.light_keys import LightKeys
from renders.store.radiance_store import RadianceStore
from renders.tracing.light_groups import LampGroup, SunGroup
from renders.truth.exposure_truth import ExposureTruth
from renders.world.build import world_of
from tests.support.own_scenario import pose_lines
from tests.support.small_scenes import needs_jit

TIME_S = 250.0
SUNS = chosen_suns(("S2,270/30", "0.2,-0.5,1", "S4", "0,0,-1"))


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    asked = RenderRequest("maxar-demo", Path("unused"), width=64, spp=4)
    table = resolve(asked)
    render = table.render.model_copy(update={"marker_samples": 16, "max_depth": 2})
    return table.model_copy(update={"render": render})


def pose_light(
    scenario: Scenario,
    store: Path,
    suns: Sequence[NamedSun] = tuple(SUNS),
    time_s: float = TIME_S,
) -> PoseLight:
    world = world_of(scenario_at(scenario, time_s))
    keys = LightKeys(world, "jit")
    assert world.target.markers is not None
    return PoseLight(Studio(world, RadianceStore(store), keys, world.target.markers), suns)


def absent_of(light: PoseLight) -> set[str]:
    store = light.studio.store
    return {each.key for own in light.groups_of_sun for each in own if not store.has(each.key)}


@given(st.integers(0, 500), st.integers(1, 60))
def test_batches_are_as_few_and_as_even_as_can_be(count: int, most: int) -> None:
    batches = even_batches(count, most)
    assert [place for batch in batches for place in batch] == list(range(count))
    assert len(batches) == -(-count // most)
    sizes = [len(batch) for batch in batches]
    assert all(0 < size <= most for size in sizes)
    assert len(set(sizes[:-1])) <= 1  # so that all but the last share one kernel
    assert not sizes or sizes[-1] <= sizes[0]


@pytest.mark.parametrize("width", [256, 1024, 2048])
def test_a_batch_stays_within_the_memory_given(width: int) -> None:
    camera = camera_preset("chaser_fixed").resized(width)
    one_sum_gb = width * width * BYTES_PER_SAMPLE_SUM / GIBI
    for memory_gb in (1.0, 2.0, 8.0):
        suns = suns_in_a_batch(camera, 2, memory_gb)
        assert 1 <= suns <= MOST_SUNS
        assert suns * one_sum_gb < memory_gb
    assert suns_in_a_batch(camera, 2, 64.0) == MOST_SUNS
    with pytest.raises(ScenarioError, match="expected --memory-gb of at least"):
        suns_in_a_batch(camera, 2, 0.5)
    with pytest.raises(ScenarioError, match="expected --memory-gb of at least"):
        suns_in_a_batch(camera, 2, float("nan"))
    pair_bytes = 2 * 2 * width * width  # of half floats
    for pairs in (4, 10, 1000):  # a batch and the lamps fit into half the store
        suns = suns_in_a_batch(camera, 2, 64.0, pairs * pair_bytes)
        assert 1 <= suns < pairs
        assert (suns + 1) * pair_bytes <= 0.5 * pairs * pair_bytes
    with pytest.raises(ScenarioError, match="expected --store-budget-gb of at least"):
        suns_in_a_batch(camera, 2, 64.0, 3.9 * pair_bytes)


def test_keys_are_those_of_a_single_run(scenario: Scenario, tmp_path: Path) -> None:
    """What ``rvbench run --sun`` at the same moment would look for."""
    light = pose_light(scenario, tmp_path)
    for number, sun in enumerate(SUNS):
        table = scenario.model_copy(
            update={
                "motion": scenario.motion.model_copy(update={"start_s": TIME_S, "end_s": TIME_S}),
                "sun": scenario.sun.model_copy(update={"default": sun.text}),
            }
        )
        world = world_of(table)
        assert world.target.markers is not None
        studio = Studio(
            world, RadianceStore(tmp_path), LightKeys(world, "jit"), world.target.markers
        )
        for exposure in world.exposures:
            pose = world.trajectory.cam_from_target(exposure.time_s)
            expected = studio.group_keys(exposure, pose)
            assert light.keys(number)[exposure.band].items() <= expected.items()
            assert f"lamps_{exposure.band}" in light.keys(number)[exposure.band]
            assert world.sun.name in light.keys(number)[exposure.band]


def test_a_camera_that_stands_still_finds_one_suns_light_for_both_bands(tmp_path: Path) -> None:
    (tmp_path / "poses.csv").write_text("\n".join(pose_lines(2)) + "\n")
    (tmp_path / "still.toml").write_text(
        'name = "still"\n[camera]\nwidth = 128\n[motion]\nkind = "poses"\nfile = "poses.csv"\n'
    )
    light = pose_light(read_scenario(tmp_path / "still.toml"), tmp_path, time_s=1.0)
    keys = light.keys(0)
    assert {band: len(own) for band, own in keys.items()} == {800: 2, 850: 2}
    assert keys[800]["sun_S2"] == keys[850]["sun_S2"]
    batches = light.batches([0], absent_of(light), 48)
    traced = [each.key for batch in batches for each in batch.groups]
    assert len(traced) == len(set(traced)) == 3


def test_each_group_is_traced_once_the_shared_ones_first(
    scenario: Scenario, tmp_path: Path
) -> None:
    light = pose_light(scenario, tmp_path)
    batches = light.batches(range(len(SUNS)), absent_of(light), most=2)
    assert [batch.suns for batch in batches] == [(), (0, 1), (2, 3), (4,)]
    assert all(isinstance(each.group, LampGroup) for each in batches[0].groups)
    assert {each.exposure.band for each in batches[0].groups} == {800, 850}
    keys = [each.key for batch in batches for each in batch.groups]
    assert len(keys) == len(set(keys)) == 2 + 2 * len(SUNS)
    for batch in batches[1:]:
        assert len(batch.groups) == 2 * len(batch.suns)
        assert all(isinstance(each.group, SunGroup) for each in batch.groups)


def test_suns_whose_light_is_there_come_first_and_trace_nothing(
    scenario: Scenario, tmp_path: Path
) -> None:
    light = pose_light(scenario, tmp_path)
    lacking = {each.key for each in light.groups_of_sun[3] if isinstance(each.group, SunGroup)}
    first, second = light.batches(range(len(SUNS)), lacking, most=48)
    assert (first.suns, first.groups) == ((0, 1, 2, 4), ())
    assert (second.suns, {each.key for each in second.groups}) == ((3,), lacking)
    assert light.batches([], lacking, most=48) == []


def test_light_does_not_depend_on_the_batches(scenario: Scenario, tmp_path: Path) -> None:
    """To the bit: a pixel's random numbers depend on seed and pixel, not on the lights traced."""
    needs_jit()
    stored: list[dict[str, bytes]] = []
    for most in (1, 48):
        light = pose_light(scenario, tmp_path / str(most), SUNS[:2])
        for batch in light.batches(range(len(light.suns)), absent_of(light), most):
            light.trace(batch.groups)
        assert not absent_of(light)
        store = light.studio.store
        read = {each.key: store.read(each.key) for own in light.groups_of_sun for each in own}
        assert all(image is not None for image in read.values())
        stored.append({key: image.tobytes() for key, image in read.items()})
        lit = [np.frombuffer(data, np.float32).max() > 0.0 for data in stored[-1].values()]
        assert sum(lit) > len(lit) // 2
    assert stored[0] == stored[1]


def test_truth_tells_how_much_each_sun_lights(scenario: Scenario, tmp_path: Path) -> None:
    """Markers face +z: straight up lights them all but for shadows, straight down none."""
    needs_jit()
    light = pose_light(scenario, tmp_path)
    truths = light.truths()
    assert set(truths) == {sun.text for sun in SUNS}
    pose = light.studio.world.trajectory.cam_from_target(TIME_S).matrix()
    lit = {}
    for text, truth in truths.items():
        assert isinstance(truth, ExposureTruth)
        assert (truth.band, truth.time_s) == (850, TIME_S)
        np.testing.assert_allclose(truth.cam_from_target.matrix(), pose)
        lit[text] = truth.sun_lit
    assert np.max(lit["0,0,-1"]) == 0.0
    assert np.max(lit["S2"]) > 0.9
