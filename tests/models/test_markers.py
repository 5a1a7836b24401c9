from __future__ import annotations

import numpy as np
import pytest

from models.arrays import AnyArray
from models.markers import MarkerPattern

POINTS = np.array([[0.0, 0.0, 0.0], [0.3, 0.4, 0.0], [0.0, 2.0, 0.0]])
UP = np.tile([0.0, 0.0, 1.0], (3, 1))


def test_the_nearest_two_markers() -> None:
    pattern = MarkerPattern(("a", "b", "c"), POINTS, UP, 0.01)
    assert len(pattern) == 3
    assert pattern.min_separation_m == pytest.approx(0.5)
    assert MarkerPattern(("a",), POINTS[:1], UP[:1], 0.01).min_separation_m == np.inf


@pytest.mark.parametrize(
    ("names", "points", "normals", "radius_m", "said"),
    [
        (("a", "b"), POINTS, UP, 0.01, r"2 points and normals of shape \(2, 3\)"),
        (("a", "b", "c"), POINTS, UP[:2], 0.01, r"\(2, 3\)"),
        (("a", "b", "a"), POINTS, UP, 0.01, "each marker's name once, got a, b, a"),
        (("a", "b", "c"), POINTS * np.nan, UP, 0.01, "finite points"),
        (("a", "b", "c"), POINTS, UP, 0.0, "radius in m above zero, got a radius of 0.0"),
        (("a", "b", "c"), POINTS, UP, np.nan, "radius in m above zero"),
        (("a", "b", "c"), POINTS, 2.0 * UP, 0.01, "length one, got lengths"),
        (("a", "b", "c"), POINTS, UP * np.nan, 0.01, "length one"),
    ],
)
def test_a_pattern_that_cannot_be_is_refused(
    names: tuple[str, ...], points: AnyArray, normals: AnyArray, radius_m: float, said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        MarkerPattern(names, points, normals, radius_m)
