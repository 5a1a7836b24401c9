"""Markers of one's own on a spacecraft: at their places, instead of its own, and outside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.errors import ScenarioError
from models.markers import MarkerPattern
from models.spacecraft.maxar1300 import maxar1300
from models.spacecraft.own_markers import with_own_markers
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.solids import box

PATTERN = MarkerPattern(
    ("a", "b", "c"),
    np.array([[0.3, 0.0, 0.5], [-0.3, 0.2, 0.5], [0.0, -0.4, 0.5]]),
    np.tile([0.0, 0.0, 1.0], (3, 1)),
    0.02,
)
CUBE = Spacecraft(
    "cube", (Part("body", box((1.0, 1.0, 1.0), (0.0, 0.0, 0.0)), "black_paint"),), None, np.zeros(3)
)


def test_they_replace_the_spacecrafts_own_and_their_supports() -> None:
    lift = np.array([0.0, 0.0, 0.5])
    bare = with_own_markers(
        maxar1300(), replace(PATTERN, points_in_target=PATTERN.points_in_target + lift)
    )
    assert bare.markers is not None
    assert bare.markers.names == ("a", "b", "c")
    assert set(maxar1300().part_names) - set(bare.part_names) == {"marker_supports"}
    assert maxar1300().markers is not bare.markers


def test_a_spacecraft_without_markers_gets_some() -> None:
    assert with_own_markers(CUBE, PATTERN).markers is PATTERN


def test_a_marker_on_a_skin_is_outside() -> None:
    with_own_markers(CUBE, PATTERN)


def test_a_marker_inside_or_facing_inwards_is_refused_by_name() -> None:
    sunk = PATTERN.points_in_target - [[0.0, 0.0, 0.0], [0.0, 0.0, 0.1], [0.0, 0.0, 0.0]]
    with pytest.raises(ScenarioError, match=r"marker 'b' at \(-0.300, 0.200, 0.400\) m"):
        with_own_markers(CUBE, replace(PATTERN, points_in_target=sunk))
    with pytest.raises(ScenarioError, match="marker 'a'"):
        with_own_markers(CUBE, replace(PATTERN, normals_in_target=-PATTERN.normals_in_target))
