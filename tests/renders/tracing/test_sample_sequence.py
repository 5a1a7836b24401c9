"""Samples of a pixel: Sobol's points, scrambled, against scipy's and against what nets promise."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2, qmc

from models.arrays import Floats
from tests.support.small_scenes import needs_jit


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    needs_jit()


def points(count: int, key: int, pair: int = 0) -> Floats:
    import mitsuba as mi

    from renders.tracing.sample_sequence import points_2d

    index = mi.UInt32(np.arange(count, dtype=np.uint32))
    return np.array(points_2d(index, mi.UInt32(key), mi.UInt32(pair)), dtype=np.float64).T


def test_unscrambled_they_are_sobols() -> None:
    """SciPy counts in Gray code: its point n is Sobol's number n ^ (n >> 1)."""
    import drjit as dr
    import mitsuba as mi

    from renders.tracing.sample_sequence import sobol_second

    index = mi.UInt32(np.arange(1024, dtype=np.uint32))
    ours = np.stack([np.array(dr.brev(index)), np.array(sobol_second(index))], axis=1) / 2.0**32
    gray = np.arange(1024) ^ (np.arange(1024) >> 1)
    np.testing.assert_array_equal(ours[gray], qmc.Sobol(2, scramble=False).random(1024))


@pytest.mark.parametrize("power", [3, 4, 8])
def test_every_elementary_box_holds_one_point(power: int) -> None:
    count = 2**power
    for key in range(20):
        drawn = points(count, key, pair=key + 3)
        assert drawn.min() >= 0.0
        assert drawn.max() < 1.0
        for split in range(power + 1):
            columns, rows = 2**split, count // 2**split
            box = np.floor(drawn[:, 0] * columns) * rows + np.floor(drawn[:, 1] * rows)
            assert len(np.unique(box)) == count


def test_each_point_alone_is_uniform_over_keys() -> None:
    """Chi-square over an 8 x 8 grid at the 1 in 10,000 level: fixed keys, so it never flickers."""
    import mitsuba as mi

    from renders.tracing.sample_sequence import points_2d

    keys = mi.UInt32(np.arange(64_000, dtype=np.uint32) * np.uint32(2_654_435_761))
    for index in (0, 5):
        x, y = np.array(points_2d(mi.UInt32(index), keys, mi.UInt32(2)))
        counts, _, _ = np.histogram2d(x, y, bins=8, range=[[0, 1], [0, 1]])
        statistic = ((counts - 1000.0) ** 2 / 1000.0).sum()
        assert statistic < chi2.ppf(1.0 - 1e-4, 63)


def test_pairs_of_dimensions_are_independent() -> None:
    """A path must not meet the lobe that its place in the pixel foretells."""
    together = []
    for key in range(150):
        first, second = points(16, 7919 * key, pair=1), points(16, 7919 * key, pair=2)
        together.append(
            [(first[:, a] - 0.5) @ (second[:, b] - 0.5) for a in (0, 1) for b in (0, 1)]
        )
    sums = np.array(together)
    spread = sums.std(axis=0) / np.sqrt(len(sums))
    assert (np.abs(sums.mean(axis=0)) < 4.0 * spread).all()
