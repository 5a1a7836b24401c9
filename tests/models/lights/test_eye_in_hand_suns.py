from __future__ import annotations

import numpy as np
import pytest

from models.lights.sun import EYE_IN_HAND_SUNS_DEG, SUN_CASES_DEG, sun_direction


def test_there_are_37_and_none_has_another_cases_name() -> None:
    assert set(EYE_IN_HAND_SUNS_DEG) == {"E-SB", *(f"E-S{number}" for number in range(1, 37))}
    assert not set(EYE_IN_HAND_SUNS_DEG) & set(SUN_CASES_DEG)


def test_sb_is_straight_behind_the_target() -> None:
    assert sun_direction("E-SB") == pytest.approx([0.0, 0.0, -1.0], abs=1e-12)


@pytest.mark.parametrize("name", [name for name in EYE_IN_HAND_SUNS_DEG if name != "E-SB"])
def test_all_others_light_the_face_within_the_declination_of_a_year(name: str) -> None:
    towards = sun_direction(name.lower())
    assert towards[2] > 0.0
    assert abs(np.rad2deg(np.arcsin(towards[1]))) <= 23.1
