"""Poses that clutter makes by itself, counted by drawing it."""

from __future__ import annotations

import numpy as np
import pytest

from pipelines.pnp.chance_match import MOST_FALSE_ALARMS, false_alarms

SIDE_PX, REACH_PX = 256.0, 4.0


@pytest.mark.parametrize("more", [1, 2, 3])
def test_the_chance_of_more_matches_is_that_of_clutter_drawn(more: int) -> None:
    """A pose's other markers stand anywhere: how often do so many have clutter within reach."""
    rng = np.random.default_rng(1)
    strays, left, draws = 60, 7, 4000
    hits = 0
    for _ in range(draws):
        clutter = rng.uniform(0.0, SIDE_PX, (strays, 2))
        # Away from the image's edge, where a reach lies in it whole.
        places = rng.uniform(REACH_PX, SIDE_PX - REACH_PX, (left, 2))
        gaps = np.linalg.norm(places[:, None] - clutter[None], axis=2).min(axis=1)
        hits += np.count_nonzero(gaps < REACH_PX) >= more
    one_pose = false_alarms(3 + more, 3 + left, 1, strays, SIDE_PX**2, REACH_PX) * 6.0
    # Two strays near one marker count once where they are drawn: 2 % of 4.5 %.
    assert one_pose == pytest.approx(hits / draws, rel=0.1, abs=3.0 / draws)


def test_four_of_ten_among_much_clutter_are_chance_and_all_ten_are_not() -> None:
    """Nothing foreseen: each of 150 candidates may be each of 10 markers."""
    found = [false_alarms(k, 10, 1500 - k, 150 - k, 256.0**2, 0.6) for k in (4, 5, 6, 8, 10)]
    assert found == sorted(found, reverse=True)
    assert found[0] > 1.0
    assert found[-1] < 1e-9


def test_where_a_pose_is_foreseen_few_matches_do() -> None:
    """Every candidate lies where its marker is foreseen, and a stray or two beside them."""
    assert false_alarms(4, 10, 0, 0, 1e5, 1.0) == 0.0
    assert false_alarms(4, 10, 2, 2, 1e5, 1.0) < MOST_FALSE_ALARMS
