"""The classes of equations 1 to 3: what they are, and what they do not depend on."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pipelines.acquisition.pca_classes import pca_classes


def cross() -> np.ndarray:
    """Return a long and a short bar, crossed, about (1000, 700)."""
    along = np.array([[-400.0, 0.0], [-350.0, 0.0], [350.0, 0.0], [400.0, 0.0]])
    across = np.array([[0.0, -300.0], [0.0, 300.0], [0.0, -20.0], [0.0, 20.0]])
    return np.concatenate([along, across]) + np.array([1000.0, 700.0])


def test_the_first_class_lies_along_the_widest_direction() -> None:
    classes = pca_classes(cross())
    assert classes.first.tolist() == [True] * 4 + [False] * 4
    assert classes.second.tolist() == [False] * 4 + [True, True, False, False]
    assert classes.either.tolist() == [0, 1, 2, 3, 4, 5]
    away = np.linalg.norm(cross() - [1000.0, 700.0], axis=1)
    np.testing.assert_allclose(classes.threshold_px, away.mean())


@given(
    turn=st.floats(-np.pi, np.pi),
    shift=st.tuples(st.floats(-900.0, 900.0), st.floats(-900.0, 900.0)),
    scale=st.floats(0.05, 3.0),
)
def test_classes_do_not_depend_on_where_and_how_the_target_lies(
    turn: float, shift: tuple[float, float], scale: float
) -> None:
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    moved = scale * (cross() - [1000.0, 700.0]) @ rotation.T + np.array(shift)
    plain, other = pca_classes(cross()), pca_classes(moved)
    assert (plain.first == other.first).all()
    assert (plain.second == other.second).all()
