"""How long a sweep will still take, learnt from what it has done, and shown on stderr."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn

from models.progress_lines import LinePace, told

LIGHT, POSES = "light", "poses"


@dataclass
class StageClock:
    """Work of one kind: how much there is, and how long pieces of it took.

    Attributes
    ----------
    total : int
        Pieces in all.
    done : int
    steps : list of (int, float)
        Pieces and seconds of each step done.
    """

    total: int
    done: int = 0
    steps: list[tuple[int, float]] = field(default_factory=list)

    def add(self, pieces: int, seconds: float, telling: bool = True) -> None:
        """Count a step.

        Parameters
        ----------
        pieces : int
        seconds : float, s
        telling : bool
            Whether it is like those to come.
        """
        self.done += pieces
        if pieces > 0 and telling:
            self.steps.append((pieces, seconds))

    @property
    def left_s(self) -> float | None:
        """Seconds left at the pace so far; None before anything of it was done.

        The first step compiles kernels or starts processes: once there are others, it is not
        counted.
        """
        if self.done >= self.total:
            return 0.0
        telling = self.steps[1:] or self.steps
        pieces = sum(count for count, _ in telling)
        if pieces == 0:
            return None
        return (self.total - self.done) * sum(spent for _, spent in telling) / pieces


class SweepProgress:
    """Two bars, for light and for poses, and the time left of each and in all.

    Where stderr is no terminal, one line tells of each step of light, and one now and then of the
    poses.
    """

    def __init__(self, console: Console, totals: dict[str, int]) -> None:
        self.console = console
        self.clocks = {name: StageClock(total) for name, total in totals.items()}
        self._paces = {name: LinePace(total) for name, total in totals.items()}
        self._bars = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("left: {task.fields[left]}"),
            console=console,
            transient=not console.is_terminal,
        )
        self._rows: dict[str, TaskID] = {}

    @property
    def left_s(self) -> float | None:
        """Seconds left in all; None while the pace of a stage that has work left is unknown."""
        lefts = [clock.left_s for clock in self.clocks.values()]
        known = [left for left in lefts if left is not None]
        return sum(known) if len(known) == len(lefts) else None

    @contextmanager
    def shown(self) -> Iterator[SweepProgress]:
        """Show the bars."""
        with self._bars:
            for name, clock in self.clocks.items():
                if clock.total:
                    self._rows[name] = self._bars.add_task(name, total=clock.total, left="")
            self._tell()
            yield self

    def add(self, stage: str, pieces: int, seconds: float, telling: bool = True) -> None:
        """Count a step of a stage; see ``StageClock.add``.

        Parameters
        ----------
        stage : str
            ``LIGHT`` or ``POSES``.
        pieces : int
        seconds : float, s
        telling : bool
            Whether the step is like those to come.
        """
        self.clocks[stage].add(pieces, seconds, telling)
        self._tell()
        clock = self.clocks[stage]
        knows = len(clock.steps) > 1 or clock.done == clock.total  # the first starts processes
        is_due = knows and self._paces[stage].due(clock.done)
        if not self.console.is_terminal and (stage == LIGHT or is_due):
            self.console.print(
                f"{stage}: {clock.done} of {clock.total}; left: {told(clock.left_s)}; "
                f"in all: {told(self.left_s)}",
                soft_wrap=True,
            )

    def _tell(self) -> None:
        for name, row in self._rows.items():
            clock = self.clocks[name]
            words = told(clock.left_s)
            if name == list(self._rows)[-1]:
                words += f"; in all: {told(self.left_s)}"
            self._bars.update(row, completed=clock.done, left=words)
