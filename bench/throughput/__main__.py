"""``python -m bench.throughput``: how much each verb does, by one worker and by two, as a table."""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

from rich.console import Console
from rich.table import Table

from bench.report.numbers import number
from bench.throughput.kept import KEPT, keep, rates_before
from bench.throughput.rate import Rate
from bench.throughput.timing import Spent, timed, yardstick_s
from bench.throughput.work import Work, works
from models.errors import RvbenchError
from models.plain_console import plain_console

COLUMNS = ("what", "a second", "efficiency", "asked", "of processors", "against before")
EXPLAINED = (
    "A second: of processor time, one worker, start-up counted. Efficiency: one worker's time by "
    "the clock, on one core, over twice that of two on two, only worth reading where nothing else "
    "runs. Of processors: one worker's processor time over that of two. Against before: times as "
    f"fast as what is kept in {KEPT.name}, both in the time of a fixed piece of work."
)
BUSY = 0.3  # of load beyond what a command itself may leave: others are at work


def measured(work: Work, repeats: int, shared: Path, yard_s: float, before: float | None) -> Rate:
    """Time one piece of work, from an empty folder each time.

    Parameters
    ----------
    work : Work
    repeats : int
    shared : Path
        Where all rows put what they start from.
    yard_s : float, s
    before : float, optional
    """
    spent: dict[int, list[Spent]] = {1: [], 2: []}
    for arguments in work.prepare(shared):
        timed(arguments, shared / "prepare.log")
    for _ in range(repeats):
        for workers in (1, 2) if work.target is not None else (1,):
            with tempfile.TemporaryDirectory(dir=shared) as own:
                place = Path(own)
                typed, log = work.arguments(place, workers), place / "command.log"
                spent[workers].append(timed(typed, log, workers))
    return Rate(work.name, work.things, work.count, spent[1], spent[2], work.target, yard_s, before)


def print_rows(console: Console, rows: list[Rate]) -> None:
    """Print the table and what its columns mean.

    Parameters
    ----------
    console : Console
    rows : list of Rate
    """
    table = Table(*COLUMNS)
    for row in rows:
        table.add_row(
            row.name,
            f"{number(row.a_second)} {row.things}",
            number(row.efficiency),
            number(row.target),
            number(row.spared),
            number(row.over_before),
        )
    console.print(table)
    console.print(EXPLAINED)


def main(arguments: list[str] | None = None) -> int:
    """Time all rows; 1 where two workers bring less than asked, 2 where that cannot be."""
    parser = argparse.ArgumentParser(prog="python -m bench.throughput", description=__doc__)
    parser.add_argument("--size", type=float, default=1.0, help="1: some twenty seconds a command")
    parser.add_argument("--repeats", type=int, default=1)
    parser.add_argument("--only", nargs="+", metavar="WORD", help="rows whose names hold a word")
    parser.add_argument("--keep", action="store_true", help=f"write the rates to {KEPT.name}")
    parser.add_argument("--out", type=Path, default=Path("out/throughput"))
    asked = parser.parse_args(arguments)
    chosen = [
        work
        for work in works(min(max(asked.size, 0.05), 1000.0))
        if not asked.only or any(word in work.name for word in asked.only)
    ]
    if asked.repeats < 1 or not 0.05 <= asked.size <= 1000.0 or not chosen:
        parser.error(
            "expected repeats from 1, a size of 0.05 to 1000 and words of "
            + "; ".join(work.name for work in works(1.0))
        )
    console = plain_console(width=None if sys.stdout.isatty() else 140)
    asked.out.mkdir(parents=True, exist_ok=True)
    if (load := os.getloadavg()[0]) > BUSY:
        console.print(f"load {load:.1f}: other work runs, so that efficiencies say little")
    try:
        before, yard_s = rates_before(asked.size), yardstick_s()
        with tempfile.TemporaryDirectory(dir=asked.out) as folder:
            rows = [
                measured(work, asked.repeats, Path(folder), yard_s, before.get(work.name))
                for work in chosen
            ]
    except RvbenchError as error:
        print(error, file=sys.stderr)
        return 2
    print_rows(console, rows)
    names = ("a_second", "a_yardstick", "efficiency", "spared", "over_before", "reached")
    told = [asdict(row) | {name: getattr(row, name) for name in names} for row in rows]
    (asked.out / "throughput.json").write_text(json.dumps(told, indent=1))
    if asked.keep:
        keep(rows, asked.size)
    return 0 if all(row.reached for row in rows) else 1


if __name__ == "__main__":
    raise SystemExit(main())
