"""A wireframe refuses what no target can be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Floats
from models.wireframe.wireframe import Wireframe

TRIANGLE = Wireframe(
    name="kite",
    landmark_names=("nose", "left", "right"),
    points_in_target=np.array([[3.0, 0.0, 4.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]]),
    appendage=np.array([True, False, False]),
    edges=np.array([[0, 1], [1, 2]]),
    triangles_in_target=np.zeros((1, 3, 3)),
)


def test_counts_its_landmarks_and_knows_its_reach() -> None:
    assert len(TRIANGLE) == 3
    assert TRIANGLE.radius_m == 5.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"landmark_names": ("nose", "nose", "right")}, "each landmark's name once"),
        ({"points_in_target": np.zeros((2, 3))}, r"3 landmarks as \(m, 3\) points"),
        ({"appendage": np.array([True])}, r"\(m,\) flags"),
        ({"edges": np.array([0, 1])}, r"expected \(e, 2\) edges"),
        ({"edges": np.array([[0, 3]])}, "between landmarks 0 to 2"),
        ({"edges": np.array([[1, 1]])}, "joins itself"),
        ({"triangles_in_target": np.zeros((1, 3))}, r"expected \(f, 3, 3\) triangles"),
        ({"points_in_target": np.full((3, 3), np.nan)}, "finite"),
        ({"symmetries": (2.0 * np.eye(3),)}, "rotations"),
    ],
)
def test_refuses_what_is_not_a_wireframe(changes: dict[str, Floats], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(TRIANGLE, **changes)  # type: ignore[arg-type]
