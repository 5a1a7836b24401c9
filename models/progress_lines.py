"""Progress as plain lines, now and then, for what is no terminal: a log, a file, another program.

A line is due after each tenth of the work, and after ten seconds without one; of a long job more
seldom, so that hours make tens of lines and not thousands.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

SHARE = 0.1  # of the work
EVERY_S = 10.0
EVERY_SHARE = 0.1  # of the time so far


def told(seconds: float | None) -> str:
    """Return a time as one says it: no more digits than an estimate has."""
    if seconds is None:
        return "not known yet"
    if seconds < 1.0:
        return "none"
    if seconds < 50.0:
        return f"about {max(5, 5 * math.ceil(seconds / 5.0))} s"
    if seconds < 5400.0:
        return f"about {max(1, round(seconds / 60.0))} min"
    return f"about {seconds / 3600.0:.1f} h"


class LinePace:
    """Tells when a line of progress is due.

    Parameters
    ----------
    total : int
        Pieces in all.
    clock : callable
        Seconds.
    """

    def __init__(self, total: int, clock: Callable[[], float] = time.monotonic) -> None:
        self.total = total
        self._clock = clock
        self._began_s = self._said_s = clock()
        self._said = 0

    @property
    def spent_s(self) -> float:
        """Seconds since the beginning."""
        return self._clock() - self._began_s

    def due(self, done: int) -> bool:
        """Tell whether to say a line now that so many are done; if so, it counts as said."""
        now_s = self._clock()
        wait_s = max(EVERY_S, EVERY_SHARE * (now_s - self._began_s))
        far = done - self._said >= SHARE * self.total
        if not (far or now_s - self._said_s >= wait_s or done == self.total):
            return False
        self._said, self._said_s = done, now_s
        return True


class ProgressLines:
    """Counts pieces and says lines such as ``render: 4 of 10; left: about 20 s``.

    Parameters
    ----------
    title : str
    total : int
    say : callable
        Takes a line.
    clock : callable
        Seconds.
    """

    def __init__(
        self,
        title: str,
        total: int,
        say: Callable[[str], object],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.title = title
        self.total = total
        self.done = 0
        self._say = say
        self._pace = LinePace(total, clock)

    def advance(self) -> None:
        """Count a piece, and say a line if one is due."""
        self.done += 1
        if self._pace.due(self.done):
            left_s = self._pace.spent_s / self.done * (self.total - self.done)
            self._say(f"{self.title}: {self.done} of {self.total}; left: {told(left_s)}")
