from __future__ import annotations

import pytest

from models.errors import ScenarioError
from models.spacecraft.catalogue import SPACECRAFT, TARGETS, spacecraft_by_name
from models.spacecraft.wireframes import WIREFRAMES, wireframe_by_name


@pytest.mark.parametrize("name", sorted(SPACECRAFT))
def test_finds_a_spacecraft_by_its_name(name: str) -> None:
    assert spacecraft_by_name(name).name == name


def test_an_unknown_name_is_answered_with_those_there_are() -> None:
    with pytest.raises(
        ScenarioError, match=r"maxar1300, maxar1300_grasp, maxar1300_unmarked, xmm, got 'hubble'"
    ):
        spacecraft_by_name("hubble")


def test_every_target_is_what_its_words_say() -> None:
    assert set(WIREFRAMES) <= set(TARGETS) <= set(SPACECRAFT)
    for name, told in TARGETS.items():
        craft = spacecraft_by_name(name)
        if craft.markers is not None:
            look = f"{len(craft.markers)} markers of radius {1e3 * craft.markers.radius_m:.1f} mm"
        else:
            wireframe = wireframe_by_name(name)
            shape = f"{len(wireframe)} landmarks, {len(wireframe.edges)} edges"
            look = f"no markers; a wireframe of {shape}"
        assert told == f"{look}, {len(craft.part_names)} named parts"
