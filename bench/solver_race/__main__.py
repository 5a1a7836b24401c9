"""``python -m bench.solver_race``: solvers side by side in one run, as a table."""

from __future__ import annotations

import argparse
import sys

from rich.table import Table

from bench.report.numbers import number, share
from bench.solver_race.problems import drawn_problems
from bench.solver_race.race import race
from bench.solver_race.solvers import PEER, SOLVERS
from models.errors import RvbenchError
from models.plain_console import plain_console

COLUMNS = ("solver", "time, us", "faster by", "found", "position", "attitude")
EXPLAINED = (
    f"Processor time of one thread a problem; faster than {PEER}, in the same rounds; poses found; "
    "root mean square error over the Cramér-Rao bound."
)


def main(arguments: list[str] | None = None) -> int:
    """Race and print; 2 where that cannot be."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--problems", type=int, default=2000, metavar="N")
    parser.add_argument("--noise-px", type=float, default=0.1, metavar="PX")
    parser.add_argument("--rounds", type=int, default=5, metavar="N")
    parser.add_argument("--seed", type=int, default=0, metavar="N")
    asked = parser.parse_args(arguments)
    if asked.problems < 1 or asked.rounds < 1 or not 0.0 < asked.noise_px < 10.0 or asked.seed < 0:
        parser.error("expected whole numbers from 1, a seed from 0 and noise between 0 and 10 px")
    console = plain_console()
    problems = drawn_problems(asked.problems, asked.noise_px, asked.seed)
    try:
        standings = race(problems, SOLVERS, asked.rounds)
    except RvbenchError as error:
        print(error, file=sys.stderr)
        return 2
    table = Table(*COLUMNS)
    table.columns[0].no_wrap = True
    for own in standings:
        table.add_row(
            own.name,
            number(own.microseconds),
            number(own.times_faster),
            share(own.found),
            number(own.position_over_bound, 4),
            number(own.attitude_over_bound, 4),
        )
    console.print(table)
    console.print(EXPLAINED)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
