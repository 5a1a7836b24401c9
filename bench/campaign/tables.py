"""What came of a campaign: kind by kind, and by the code that was tried."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from rich import box
from rich.table import Table

from bench.campaign.journal import FAULT, Tried

Column = Callable[[Sequence[Tried]], str]


def _ended(how: str) -> Column:
    return lambda tried: str(sum(each.ended == how for each in tried))


def _mean_s(tried: Sequence[Tried]) -> str:
    return f"{sum(each.processor_s for each in tried) / len(tried):.2f}" if tried else ""


def _kills(tried: Sequence[Tried]) -> str:
    return str(sum(each.kills for each in tried))


TRIED: dict[str, Column] = {"tried": lambda tried: str(len(tried))}
ENDS: dict[str, Column] = {"faults": _ended(FAULT), "processor s, mean": _mean_s}
COLUMNS: dict[str, dict[str, Column]] = {
    "hostile": {
        **TRIED, "refused": _ended("refused"), "accepted": _ended("accepted"), **ENDS,
    },
    "kills": {"gone on with": TRIED["tried"], "kills": _kills, **ENDS},
    "places": {**TRIED, **ENDS},
}  # fmt: skip


def table_of(what: str, kinds: Iterable[str], tried: Sequence[Tried]) -> Table:
    """Return a line for each kind that was tried, for all, and for each version of the code.

    Parameters
    ----------
    what : str
        Part of the campaign.
    kinds : iterable of str
        In order.
    tried : sequence of Tried
    """
    columns = COLUMNS[what]
    table = Table(box=box.SIMPLE)
    table.add_column(what, no_wrap=True)
    for title in columns:
        table.add_column(title, justify="right")

    def add(name: str, own: Sequence[Tried]) -> None:
        if own:
            table.add_row(name, *(told(own) for told in columns.values()))

    for kind in kinds:
        add(kind, [each for each in tried if each.kind == kind])
    table.add_section()
    add("all", tried)
    versions = list(dict.fromkeys(each.code for each in tried))
    for code in versions:
        add(f"code {code}", [each for each in tried if each.code == code])
    return table


def fault_line(tried: Tried) -> str:
    """Return a fault, with what repeats it."""
    return f"--only {tried.kind!r} --seed {tried.seed}: {tried.fault}"
