"""What came of a campaign of hostile inputs, kind by kind."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rich import box
from rich.table import Table

from bench.campaign.hostile.trial import NAMES, Told
from bench.campaign.hostile.verdict import Ended


def hostile_table(tried: Sequence[Told]) -> Table:
    """Return how many trials of each kind were refused, accepted, and faults."""
    table = Table(box=box.SIMPLE)
    table.add_column("what is read")
    for title in ("tried", *Ended):
        table.add_column(title, justify="right")
    counted = Counter((each.kind, each.verdict.ended) for each in tried)
    for name in NAMES:
        row = [counted[name, ended] for ended in Ended]
        if sum(row):
            table.add_row(name, str(sum(row)), *map(str, row))
    every = [sum(counted[name, ended] for name in NAMES) for ended in Ended]
    table.add_row("all", str(sum(every)), *map(str, every))
    return table


def told_faults(tried: Sequence[Told]) -> list[str]:
    """Return each fault in a line, with what repeats it."""
    return [
        f"--only {each.kind!r} --seed {each.seed}: {each.verdict.fault} [{each.how} of "
        f"{each.spoilt}; {each.typed[:160]!r}]"
        for each in sorted(tried, key=lambda each: (each.verdict.fault, each.kind, each.seed))
        if each.verdict.ended == Ended.FAULT
    ]
