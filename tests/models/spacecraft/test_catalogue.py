from __future__ import annotations

import pytest

from models.errors import ScenarioError
from models.spacecraft.catalogue import SPACECRAFT, spacecraft_by_name


@pytest.mark.parametrize("name", sorted(SPACECRAFT))
def test_finds_a_spacecraft_by_its_name(name: str) -> None:
    assert spacecraft_by_name(name).name == name


def test_an_unknown_name_is_answered_with_those_there_are() -> None:
    with pytest.raises(ScenarioError, match=r"chaser, hispasat, maxar1300, xmm, got 'hubble'"):
        spacecraft_by_name("hubble")
