"""The runs behind a cell of a table: what each came to, the worst of each column marked."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from bench.report.numbers import NONE, count, number
from bench.report.table import Table
from models.arrays import AnyArray

Column: TypeAlias = Sequence[float | None] | AnyArray

MOST_ROWS = 100


@dataclass(frozen=True)
class RunTable:
    """What runs came to.

    Attributes
    ----------
    title : str
        Which runs; no two of a page have the same.
    told : str
        How they were drawn, and which are listed.
    head : tuple of str
    rows : tuple of tuple of str
    worst : tuple of int or None
        By column, the row whose number is largest, or that has none.
    """

    title: str
    told: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    worst: tuple[int | None, ...]

    @property
    def anchor(self) -> str:
        """Where it stands in a page."""
        return f"runs-{hashlib.sha256(self.title.encode()).hexdigest()[:12]}"


def run_table(
    title: str,
    drawn: str,
    columns: Mapping[str, Column],
    texts: Mapping[str, Sequence[str]] | None = None,
    first: str = "run",
    numbers: Sequence[int] | AnyArray | None = None,
) -> RunTable:
    """Return a table of runs; of more than a hundred, those that are worst by the first column.

    Parameters
    ----------
    title : str
        Which runs.
    drawn : str
        How they were drawn.
    columns : mapping of str to (n,) array
        What each run came to, by name with unit; NaN or None where it came to nothing, which is
        worst.
    texts : mapping of str to sequence of str
        Words of each run, behind its numbers.
    first : str
        What the rows are.
    numbers : (runs,) int array or sequence, optional
        Theirs; from 0 on unless given.
    """
    named = np.arange(len(next(iter(columns.values())))) if numbers is None else numbers
    values = {name: np.abs(np.asarray(own, dtype=np.float64)) for name, own in columns.items()}
    signed = {name: np.asarray(own, dtype=np.float64) for name, own in columns.items()}
    ranks = {name: np.where(np.isnan(own), np.inf, own) for name, own in values.items()}
    leading = next(iter(ranks.values()))
    shown = np.arange(len(leading))
    told = f"{drawn}; {count(len(leading))} in all"
    if len(leading) > MOST_ROWS:
        shown = np.sort(np.argsort(-leading, kind="stable")[:MOST_ROWS])
        told += f", of which the {MOST_ROWS} worst are listed, by {next(iter(columns))}"
    words = texts or {}
    rows = tuple(
        (
            count(int(named[k])),
            *(NONE if np.isnan(own[k]) else number(float(own[k])) for own in signed.values()),
            *(own[k] for own in words.values()),
        )
        for k in shown.tolist()
    )
    worst = [
        int(np.argmax(own[shown])) if len(shown) > 1 and np.ptp(own[shown]) > 0.0 else None
        for own in (np.minimum(each, np.finfo(np.float64).max) for each in ranks.values())
    ]
    head = (first, *columns, *words)
    return RunTable(title, told, head, rows, (None, *worst, *(None for _ in words)))


def with_runs(
    table: Table, by_row: Sequence[Mapping[int, RunTable] | None] | Mapping[int, RunTable]
) -> Table:
    """Return a table whose cells lead to the runs behind them.

    Parameters
    ----------
    table : Table
    by_row : sequence of mapping of int to RunTable
        Of each row, by column; None of a row without. Or one mapping for every row.
    """
    every = [by_row] * len(table.rows) if isinstance(by_row, Mapping) else by_row
    behind = {
        (row, column): runs
        for row, own in enumerate(every)
        for column, runs in (own or {}).items()
        if runs.rows and table.rows[row][column] not in ("", NONE)
    }
    return replace(table, behind={**table.behind, **behind})
