"""Corners that another frame does not repeat are counted, and a frame repeats itself."""

import numpy as np

from bench.grain.features import NEAR_PX, unrepeated

POINTS = np.array([[10.0, 10.0], [50.0, 20.0], [80.0, 90.0]])


def test_a_frame_repeats_itself_and_what_moved_a_little() -> None:
    assert unrepeated(POINTS, POINTS) == 0
    assert unrepeated(POINTS, POINTS + 0.5 * NEAR_PX) == 0


def test_what_the_other_has_nowhere_near_is_counted() -> None:
    assert unrepeated(POINTS, POINTS[:1]) == 2
    assert unrepeated(POINTS, np.zeros((0, 2))) == 3
    assert unrepeated(np.zeros((0, 2)), POINTS) == 0
