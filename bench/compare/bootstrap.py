"""Intervals by resampling frames in blocks: errors of neighbouring frames are not independent.

The circular block bootstrap of Politis and Romano (1992): blocks of consecutive frames, joined at
the ends, are drawn with replacement. The length unless chosen is the cube root of the number of
frames (Hall, Horowitz and Jing 1995); of frames in no order it costs little. All methods are drawn
with the same numbers, so that differences are paired. Intervals are percentiles, each of 95 % by
itself and not of all together.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from models.arrays import Floats, Indices

CONFIDENCE = 0.95
FEWEST_BLOCKS = 6  # alike in sign by chance in 2 of 2^n: in 3 % for six, in 6 % for five
MOST_AT_ONCE = 4_000_000  # frames drawn
Statistic: TypeAlias = Callable[[Floats], Floats]


@dataclass(frozen=True)
class Resampling:
    """How frames are drawn.

    Attributes
    ----------
    seed : int
    resamples : int
    block_frames : int or None
        Length of a block; of the cube root of the number of frames unless given.
    """

    seed: int = 0
    resamples: int = 2000
    block_frames: int | None = None

    def block(self, frames: int) -> int:
        """Return how many frames a block has."""
        return min(frames, self.block_frames or max(1, round(frames ** (1.0 / 3.0))))

    def decides(self, frames: int) -> bool:
        """Return whether so many frames can tell two methods apart at 95 %, however they differ."""
        return frames >= FEWEST_BLOCKS * self.block(frames)

    def draws(self, frames: int) -> Iterator[Indices]:
        """Yield the places of the frames drawn, (k, frames) each, always the same."""
        rng = np.random.default_rng(self.seed)
        length = self.block(frames)
        blocks = -(-frames // length)
        left = self.resamples
        while left:
            count = min(left, max(1, MOST_AT_ONCE // frames))
            starts = rng.integers(frames, size=(count, blocks, 1))
            places = (starts + np.arange(length)) % frames
            yield places.reshape(count, -1)[:, :frames]
            left -= count


def mean(values: Floats) -> Floats:
    """Return the mean of each row of (k, n) values, (k,)."""
    return np.asarray(values.mean(axis=1))


def median(values: Floats) -> Floats:
    """Return the median of each row of (k, n) values, (k,).

    Of the two middle ones of an even number the mean; the lower one where the other is infinite, so
    that a half of the frames lost is not as bad as all.
    """
    low, high = (values.shape[1] - 1) // 2, values.shape[1] // 2
    ordered = np.partition(values, (low, high), axis=1)
    below, above = ordered[:, low], ordered[:, high]
    return np.where(np.isinf(above), below, 0.5 * (below + above))


def resampled(values: Floats, statistic: Statistic, how: Resampling) -> Floats:
    """Return a statistic of every resample.

    Parameters
    ----------
    values : (n,) array
        By frame.
    statistic : callable
        Of (k, n) values, (k,).
    how : Resampling

    Returns
    -------
    (resamples,) array
    """
    return np.concatenate([statistic(values[places]) for places in how.draws(len(values))])


def interval(resamples: Floats) -> tuple[float, float]:
    """Return where 95 of 100 of (m,) resamples lie; ends may be infinite."""
    tail = 0.5 * (1.0 - CONFIDENCE)
    low, high = np.quantile(resamples, [tail, 1.0 - tail], method="inverted_cdf")
    return float(low), float(high)
