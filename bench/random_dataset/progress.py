"""How far a random dataset is: frames, frames an hour, what is left and when it ends."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import datetime, timedelta

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from models.progress_lines import LinePace, told

A_DAY_S, AN_HOUR_S = 86400.0, 3600.0


class Rate:
    """Frames an hour, from those that were rendered since the beginning.

    Parameters
    ----------
    total : int
        Frames to render.
    clock : callable
        Seconds.
    now : callable
        Date and time.
    """

    def __init__(
        self,
        total: int,
        clock: Callable[[], float] = time.monotonic,
        now: Callable[[], datetime] = datetime.now,
    ) -> None:
        self.total, self.done = total, 0
        self._clock, self._now = clock, now
        self._began_s = clock()

    @property
    def frames_an_hour(self) -> float:
        """So far; processes have started and scenes were built meanwhile."""
        spent_s = max(self._clock() - self._began_s, 1e-9)
        return AN_HOUR_S * self.done / spent_s

    def said(self) -> str:
        """Return the rate, what is left, and when it ends, in words."""
        if not self.done:
            return "the rate is not known yet"
        left_s = AN_HOUR_S * (self.total - self.done) / self.frames_an_hour
        rate = f"{float(f'{self.frames_an_hour:.2g}'):.0f} frames an hour"
        if self.done >= self.total:
            return rate
        end = self._now() + timedelta(seconds=left_s)
        when = f"{end:%H:%M}" if left_s < A_DAY_S else f"{end:%Y-%m-%d %H:%M}"
        return f"{rate}; left: {told(left_s)}, until {when}"


@contextmanager
def dataset_progress(console: Console, total: int) -> Iterator[Callable[[int], None]]:
    """Yield what takes how many frames came, and tells: a bar on a terminal, else lines."""
    rate, pace = Rate(total), LinePace(total)
    if not console.is_terminal:

        def advance(frames: int) -> None:
            rate.done += frames
            if pace.due(rate.done):
                console.print(f"dataset: {rate.done} of {total}; {rate.said()}", soft_wrap=True)

        yield advance
        return
    bars = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[said]}"),
        console=console,
    )
    with bars:
        row = bars.add_task("dataset", total=total, said=rate.said())

        def advance_bar(frames: int) -> None:
            rate.done += frames
            bars.update(row, completed=rate.done, said=rate.said())

        yield advance_bar
