"""The unit that a mesh without one is taken for: the one in which a spacecraft is of that size."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from models.spacecraft.own.faults import guessed_unit


@pytest.mark.parametrize(
    ("largest", "unit"),
    [
        (0.06, "m"),  # a picosatellite
        (12.0, "m"),
        (59.0, "m"),  # the largest
        (0.04, "m"),  # nothing fits
        (61.0, "mm"),  # a cubesat in millimetres before a giant in metres
        (2500.0, "mm"),
        (109_000.0, "mm"),  # a station
        (111_000.0, "m"),  # nothing fits
    ],
)
@pytest.mark.parametrize("axis", range(3))
def test_the_longest_side_tells(largest: float, unit: str, axis: int) -> None:
    sides = np.full(3, 0.2 * largest)
    sides[axis] = largest
    corners = np.array([[0.0, 0.0, 0.0], sides]) + 7.0
    mesh = SimpleNamespace(path=Path("bus.stl"), vertices=corners)
    assert guessed_unit(mesh) == unit  # type: ignore[arg-type]


def test_a_format_of_metres_is_in_metres_whatever_its_size() -> None:
    mesh = SimpleNamespace(path=Path("bus.glb"), vertices=np.array([[0.0] * 3, [4000.0] * 3]))
    assert guessed_unit(mesh) == "m"  # type: ignore[arg-type]
