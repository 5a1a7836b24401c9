"""A chaser that navigates for itself, typed where it would do nothing or cannot be."""

from typing import Any

import pytest

from models.errors import ScenarioError
from renders.scenario.scenario import Scenario, check_scenario
from tests.support.tumble_scenario import TUMBLE, tumble_table

DATED = {"start_s": 10.0, "end_s": 20.0, "rate_hz": 1.0, "epoch_utc": "2026-03-20T12:00:00Z"}
EXACT = {**TUMBLE, "onboard": {}}


def checked(**changes: Any) -> Scenario:
    table = {"motion": DATED, "tumble": EXACT, "navigation": {}, **changes}
    return check_scenario(Scenario.model_validate(tumble_table(**table)), "mine.toml")


def test_it_is_taken_as_it_is() -> None:
    assert checked().navigation is not None


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"motion": {"end_s": 20.0, "rate_hz": 1.0}}, "motion.epoch_utc"),
        ({"tumble": TUMBLE}, "tumble.onboard.chaser_sigma_m_s to be left out"),
        ({"navigation": {"star_rate_hz": 7}}, "to divide 100"),
        ({"navigation": {"by": "stated", "star_rate_hz": 1}}, "navigation.star_rate_hz to be left"),
        ({"tumble": {**EXACT, "onboard": {"knows_target": False}}}, "a known target"),
    ],
)
def test_what_cannot_be_is_refused_by_its_key(changes, told) -> None:
    with pytest.raises(ScenarioError, match=told):
        checked(**changes)


def test_it_needs_an_orbit() -> None:
    plain = Scenario.model_validate({"name": "mine", "navigation": {}, "motion": DATED})
    with pytest.raises(ScenarioError, match=r"\[navigation\] with \[tumble\] alone"):
        check_scenario(plain, "mine.toml")
