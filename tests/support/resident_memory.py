"""The memory of a verb and of those it starts, over the frames that it has done."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

PROGRAM = "import sys; from bench.cli import main; sys.exit(main())"
LOOK_S = 0.1


@dataclass(frozen=True)
class Look:
    """How much is done, and what each process has in memory, MB, and has had at most."""

    done: int
    now_mb: dict[int, float]
    most_mb: dict[int, float]


def watched(typed: Sequence[object], done: Callable[[], int]) -> list[Look]:
    """Run a verb in a process of its own to its end, and look at its memory again and again.

    Parameters
    ----------
    typed : sequence
    done : callable
        Counts the frames that are done.
    """
    process = subprocess.Popen(
        [sys.executable, "-P", "-c", PROGRAM, *map(str, typed)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    looks = []
    while process.poll() is None:
        said = {number: _memory(number) for number in (process.pid, *_children(process.pid))}
        there = {number: own for number, own in said.items() if own is not None}
        looks.append(
            Look(
                done(),
                {number: own[0] for number, own in there.items()},
                {number: own[1] for number, own in there.items()},
            )
        )
        time.sleep(LOOK_S)
    errors = process.communicate()[1]
    assert process.returncode == 0, errors[-2000:]
    return looks


def growth(amounts: Sequence[tuple[int, float]], total: int) -> tuple[float, float]:
    """Return the mean memory of the second quarter of the work, and of the last, MB.

    Parameters
    ----------
    amounts : sequence of (int, float)
        Frames that were done, and MB.
    total : int
        All frames.
    """
    quarters = [
        [mb for done, mb in amounts if low < done / total <= low + 0.25] for low in (0.25, 0.75)
    ]
    second, last = (sum(own) / len(own) for own in quarters)
    return second, last


def _memory(process: int) -> tuple[float, float] | None:
    """Return what a process has in memory and has had at most, MB; None if it is over."""
    try:
        lines = Path(f"/proc/{process}/status").read_text().splitlines()
    except OSError:
        return None
    table = dict(line.split(":", 1) for line in lines if ":" in line)
    if "VmRSS" not in table:
        return None
    now, most = (float(table[name].split()[0]) / 1024.0 for name in ("VmRSS", "VmHWM"))
    return now, most


def _children(process: int) -> list[int]:
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            if int(path.read_text().rpartition(")")[2].split()[1]) == process:
                found.append(int(path.parent.name))
        except OSError:
            continue
    return found
