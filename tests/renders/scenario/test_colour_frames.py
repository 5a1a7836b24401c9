from __future__ import annotations

import re

import pytest

from models.errors import ScenarioError
from renders.scenario.case_files import case_path
from renders.scenario.scenario import Scenario, check_scenario, read_scenario
from renders.world.build import world_of


def changed(**tables: dict[str, object]) -> Scenario:
    table = read_scenario(case_path("grasp-approach")).model_dump()
    for name, values in tables.items():
        table[name].update(values)
    return Scenario(**table)


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"stars": {"shine": True}}, "expected stars.shine to be left out with colour"),
        ({"lamps": {"count": 4}}, "expected lamps.count to be left out with colour"),
        ({"retroreflector": {"returned_850": 0.5}}, "expected retroreflector.returned_850"),
        ({"exposure": {"mode": "schedule"}}, "expected exposure.mode, of single images"),
    ],
)
def test_what_has_no_effect_on_colour_is_refused(
    tables: dict[str, dict[str, object]], said: str
) -> None:
    with pytest.raises(ScenarioError, match=re.escape(said)):
        check_scenario(changed(**tables), "mine.toml")


def test_a_first_pose_and_a_lens_with_a_focus_are_its_own() -> None:
    scenario = changed(prior={"sigma_t_m": [0.03] * 3}, optics={"focus_m": 0.6})
    assert check_scenario(scenario, "mine.toml").needs_depth


def test_dots_are_found_to_be_in_colour_unless_typed() -> None:
    table = read_scenario(case_path("grasp-approach")).model_dump()
    table["frame"] = None
    assert Scenario(**table).frame_kind == "colour"


def test_a_target_without_markers_is_refused() -> None:
    scenario = changed()
    scenario = scenario.model_copy(update={"target": "xmm"})
    with pytest.raises(ScenarioError, match=r"expected a target with markers for frame\.kind"):
        _ = world_of(scenario).target
