"""Do the units that are not done, spread over processes, and say how long it will still take."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import cv2
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from bench.status.readers import ASKED_NAME
from bench.suites.units import WorkUnit, read_outcome, write_outcome
from bench.sweep.workers import Workers
from models.at_work import at_work
from models.atomic_file import sweep_scratch, write_text
from models.plain_console import plain_console
from models.progress_lines import LinePace, told


@dataclass
class Pace:
    """How long units take by kind, measured where one was done, and what is left.

    Attributes
    ----------
    workers : int
    left : dict
        Expected seconds of the units that are left, by kind.
    spent : dict
        Expected and true seconds of those done, by kind.
    """

    workers: int
    left: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    spent: dict[str, list[tuple[float, float]]] = field(default_factory=lambda: defaultdict(list))

    def add(self, unit: WorkUnit) -> None:
        """Count a unit that is left."""
        self.left[unit.kind].append(unit.expected_s)

    def learn(self, unit: WorkUnit, seconds: float) -> None:
        """Note how long a unit took."""
        self.spent[unit.kind].append((unit.expected_s, seconds))

    def done(self, unit: WorkUnit, seconds: float) -> None:
        """Note that a unit that was left is done."""
        self.left[unit.kind].remove(unit.expected_s)
        self.learn(unit, seconds)

    @property
    def cpu_left_s(self) -> float:
        """Seconds left of one core."""
        return sum(sum(left) * self._slowness(kind) for kind, left in self.left.items())

    @property
    def left_s(self) -> float:
        """Seconds left on the clock, if every worker has a core."""
        return self.cpu_left_s / self.workers

    def _slowness(self, kind: str) -> float:
        """Return true over expected seconds of a kind; of all where none of it was done."""
        steps = self.spent[kind] or [step for steps in self.spent.values() for step in steps]
        expected = sum(step[0] for step in steps)
        return sum(step[1] for step in steps) / expected if expected > 0.0 else 1.0


def do_units(
    units: Sequence[WorkUnit],
    folder: Path,
    workers: int,
    console: Console | None = None,
    asked: Sequence[WorkUnit] | None = None,
) -> int:
    """Do every unit that is not done.

    Each outcome is written by the process that made it, at once: a killed suite loses the units
    that were in hand, and the same call goes on with the others.

    Parameters
    ----------
    units : sequence of WorkUnit
    folder : Path
        Of the outcomes.
    workers : int
        Processes; with one, the work is done in this process.
    console : Console, optional
        Where progress goes; stderr unless given.
    asked : sequence of WorkUnit, optional
        All units that were asked for, where these are a share of them.

    Returns
    -------
    int
        How many were done now.
    """
    console = console or plain_console(stderr=True)
    sweep_scratch(folder)
    pace = Pace(workers)
    missing = []
    for unit in units:
        outcome = read_outcome(folder, unit)
        if outcome is None:
            missing.append(unit)
            pace.add(unit)
        else:
            pace.learn(unit, float(outcome.seconds.sum()))
    if not missing:
        return 0
    missing = one_of_each_kind_first(missing)
    write_text(
        folder / ASKED_NAME, json.dumps({"asked": [each.name for each in asked or units]}) + "\n"
    )
    console.print(
        f"{len(units) - len(missing)} of {len(units)} units are done already; {workers} "
        f"worker{'s' if workers > 1 else ''}, left: {told(pace.left_s)}",
        soft_wrap=True,
    )
    with at_work(folder, "suite"):
        _spread(missing, folder, pace, console)
    return len(missing)


def one_of_each_kind_first(units: Iterable[WorkUnit]) -> list[WorkUnit]:
    """Order units so that how long each kind takes is known early."""
    heads: dict[str, WorkUnit] = {}
    rest = []
    for unit in units:
        if heads.setdefault(unit.kind, unit) is not unit:
            rest.append(unit)
    return [*heads.values(), *rest]


def _spread(missing: list[WorkUnit], folder: Path, pace: Pace, console: Console) -> None:
    bars = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("left: {task.fields[left]}"),
        console=console,
        transient=not console.is_terminal,
    )
    lines = LinePace(len(missing))
    with Workers(pace.workers) as pool, bars:
        row = bars.add_task("units", total=len(missing), left=told(pace.left_s))
        results = pool.run(_do, [(folder, unit) for unit in missing])
        for count, (number, seconds) in enumerate(results, start=1):
            pace.done(missing[number], seconds)
            bars.update(row, completed=count, left=told(pace.left_s))
            if lines.due(count) and not console.is_terminal:
                console.print(
                    f"units: {count} of {len(missing)}; left: {told(pace.left_s)}", soft_wrap=True
                )


def _do(folder: Path, unit: WorkUnit) -> float:
    """Do one unit, in whatever process, and keep what it came to; return the seconds it took."""
    cv2.setNumThreads(1)
    outcome = unit.done()
    write_outcome(folder, unit, outcome)
    return float(outcome.seconds.sum())
