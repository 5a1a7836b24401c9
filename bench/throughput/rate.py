"""What one piece of work came to: its rate, what a second worker brings, what it was before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.throughput.timing import Spent


@dataclass(frozen=True)
class Rate:
    """One row of the table.

    Attributes
    ----------
    name, things : str
    count : int
        Things that the command does.
    one : list of Spent
        By one worker, once for each repetition.
    two : list of Spent
        By two, each taken right after its fellow; empty where workers cannot be chosen.
    target : float or None
        Wanted of ``efficiency``.
    yardstick_s : float, s
    before : float or None
        ``a_yardstick`` as it was kept.
    """

    name: str
    things: str
    count: int
    one: list[Spent]
    two: list[Spent]
    target: float | None
    yardstick_s: float
    before: float | None = None

    @property
    def a_second(self) -> float:
        """Things a second of one core: of processor time, so that other work hardly counts."""
        return self.count / min(spent.processor_s for spent in self.one)

    @property
    def a_yardstick(self) -> float:
        """Things in the time of the yardstick, which depends less on the machine."""
        return self.a_second * self.yardstick_s

    @property
    def efficiency(self) -> float | None:
        """One worker's time by the clock over twice that of two: the middle of the repetitions."""
        if not self.two:
            return None
        pairs = zip(self.one, self.two, strict=True)
        return float(np.median([a.clock_s / (2.0 * b.clock_s) for a, b in pairs]))

    @property
    def spared(self) -> float | None:
        """One worker's processor time over that of two: what two share or wait for, busy or not."""
        if not self.two:
            return None
        pairs = zip(self.one, self.two, strict=True)
        return float(np.median([a.processor_s / b.processor_s for a, b in pairs]))

    @property
    def over_before(self) -> float | None:
        """How many times as fast as it was."""
        return None if self.before is None else self.a_yardstick / self.before

    @property
    def reached(self) -> bool:
        """Whether two workers bring what is wanted."""
        return self.target is None or self.efficiency is None or self.efficiency >= self.target
