"""How starts are judged, and whether probabilities told are held against what happened."""

from __future__ import annotations

import numpy as np
import pytest

from bench.suites.uncooperative_suns.results import Starts, claims_of, interval, summary_of

CLAIMED_RIGHT, CLAIMED_WRONG, REFUSED = 60, 4, 16


def starts() -> Starts:
    """Sixty right claims told to be sure, four wrong ones told to be half so, and refusals."""
    count = CLAIMED_RIGHT + CLAIMED_WRONG + REFUSED
    images = np.ones(count, dtype=np.int64)
    images[CLAIMED_RIGHT + CLAIMED_WRONG :] = 0
    attitude = np.full(count, 1.0)
    attitude[CLAIMED_RIGHT : CLAIMED_RIGHT + 2] = 175.0
    off = np.full(count, 0.01)
    off[CLAIMED_RIGHT + 2 : CLAIMED_RIGHT + CLAIMED_WRONG] = 0.2
    doubt = np.full(count, 0.002)
    doubt[CLAIMED_RIGHT : CLAIMED_RIGHT + CLAIMED_WRONG] = 0.5
    silent = images == 0
    attitude[silent], off[silent], doubt[silent] = np.nan, np.nan, np.nan
    return Starts(
        phase_deg=np.linspace(0.0, 169.0, count),
        share=np.full(count, 0.1),
        lit=np.where(np.arange(count) % 2, 0.5, 0.1),
        attitude=np.tile(np.eye(3), (count, 1, 1)),
        images=images,
        attitude_deg=attitude,
        range_share=off,
        doubt=doubt,
        seconds=np.ones(count),
        reasons=tuple("leads by 0.01" if quiet else "" for quiet in silent),
    )


def test_an_attitude_or_a_range_beyond_the_limits_is_wrong() -> None:
    one = summary_of(starts())
    assert (one.every.found, one.every.wrong, one.every.refused) == (60, 4, 16)
    assert sum(each.starts for each in one.phase) == one.every.starts
    assert one.lit.starts == one.every.starts // 2


def test_claims_are_held_against_what_was_told() -> None:
    sure, half = claims_of(starts())
    assert (sure.claims, sure.wrong, half.claims, half.wrong) == (60, 0, 4, 4)
    assert sure.holds
    assert half.low == pytest.approx(0.025 ** (1 / 4))  # of four in four, by Clopper and Pearson
    assert half.holds == (half.told >= half.low)


@pytest.mark.parametrize(("wrong", "claims"), [(0, 10), (3, 10), (10, 10)])
def test_an_interval_holds_its_share(wrong: int, claims: int) -> None:
    low, high = interval(wrong, claims)
    assert 0.0 <= low <= wrong / claims <= high <= 1.0
