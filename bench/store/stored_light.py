"""What ``rvbench store`` does: list, verify and prune the light that is kept.

It reads files and loads no Mitsuba.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table

from bench.progress import frame_progress
from models.errors import ScenarioError, StorageError, cause
from renders.store.budget import GB, Entry, budget_bytes, evict
from renders.store.check import Damage, all_entries, damaged
from renders.store.claims import Claim, forget_claims_without_light, live_claims, read_claims

TITLES = ("case", "Sun", "dataset", "entries", "size", "its own", "last used")
PLACE = TITLES.index("dataset")
GAP = 2  # characters between columns
LEAST_PATH = 12  # characters that are shown, however narrow the terminal
NOBODY = "of no dataset on record"


@dataclass(frozen=True)
class Holding:
    """The light of one dataset in a store.

    Attributes
    ----------
    claim : Claim
    state : str
        ``in use``, ``gone`` (its folder) or nothing.
    entries : list of Entry
    alone_bytes : int
        Disk that no other dataset's light takes.
    """

    claim: Claim
    state: str
    entries: list[Entry]
    alone_bytes: int


def existing(folder: Path) -> Path:
    """Refuse a store that is not there.

    Raises
    ------
    StorageError
    """
    if not folder.is_dir():
        raise StorageError(
            f"expected a store of light at {folder}, found none; nothing has been rendered into "
            "it yet, or it is another: name it with --store or $RVBENCH_STORE"
        )
    return folder


def holdings(folder: Path, entries: list[Entry]) -> tuple[list[Holding], list[Entry]]:
    """Return whose light is in a store, and the entries that are on nobody's record."""
    claims, by_key = read_claims(folder), {entry.key: entry for entry in entries}
    live = {claim.dataset for claim in live_claims(folder)}
    users = Counter(key for claim in claims for key in claim.keys)
    found = []
    for claim in claims:
        own = [by_key[key] for key in sorted(claim.keys) if key in by_key]
        alone = sum(entry.cost_bytes for entry in own if users[entry.key] == 1)
        gone = "" if claim.dataset.is_dir() else "gone"
        found.append(Holding(claim, "in use" if claim.dataset in live else gone, own, alone))
    found.sort(key=lambda holding: (holding.claim.case, str(holding.claim.dataset)))
    return found, [entry for entry in entries if entry.key not in users]


def print_holdings(folder: Path, console: Console) -> None:
    """Print how much light lies in a store, dataset by dataset, with its size and last use."""
    entries = all_entries(existing(folder))
    found, orphans = holdings(folder, entries)
    rows = [
        (
            *(each.claim.case, each.claim.sun),
            f"{each.claim.dataset}{f' ({each.state})' if each.state else ''}",
            *_numbers(each.entries, each.alone_bytes),
        )
        for each in found
    ]
    if orphans:
        own = sum(entry.cost_bytes for entry in orphans)
        rows.append(("", "", NOBODY, *_numbers(orphans, own)))
    if entries:
        console.print(holdings_table(rows, console.width))
    console.print(_total(folder, entries), soft_wrap=True)


def holdings_table(rows: Sequence[tuple[str, ...]], width: int) -> Table:
    """Return a table so wide at most; of a path too long for it the end is shown, which differs.

    Parameters
    ----------
    rows : sequence of tuple of str
        A cell for each of ``TITLES``.
    width : int
        Characters.
    """
    table = Table(box=box.SIMPLE, pad_edge=False, collapse_padding=True)
    for name in TITLES:
        right = name in TITLES[3:]
        table.add_column(name, justify="right" if right else "left", no_wrap=True)
    widest = [
        max(map(len, (name, *own)))
        for name, own in zip(TITLES, zip(*rows, strict=True), strict=True)
    ]
    room = max(LEAST_PATH, width - sum(widest) + widest[PLACE] - GAP * len(TITLES))
    for row in rows:
        place = row[PLACE]
        shown = place if len(place) <= room else f"…{place[len(place) - room + 1 :]}"
        table.add_row(*row[:PLACE], shown, *row[PLACE + 1 :])
    return table


def _total(folder: Path, entries: list[Entry]) -> str:
    cost = sum(entry.cost_bytes for entry in entries)
    linked = sum(entry.size_bytes for entry in entries) - cost
    beside = f"; {size_text(linked)} more are links to files of datasets" if linked else ""
    limit = budget_bytes(None)
    budget = "none" if limit == float("inf") else size_text(limit)
    return f"{folder}: {size_text(cost)} in {len(entries)} entries{beside}; budget: {budget}"


def _numbers(entries: list[Entry], own_bytes: int) -> tuple[str, str, str, str]:
    used_ns = max((entry.used_ns for entry in entries), default=None)
    size = sum(entry.size_bytes for entry in entries)
    ago = "" if used_ns is None else f"{age_text(time.time() - used_ns * 1e-9)} ago"
    return str(len(entries)), size_text(size), size_text(own_bytes), ago


def find_damage(folder: Path) -> tuple[list[Damage], int]:
    """Read every entry of a store, with a progress bar; return the damaged ones, and how many."""
    entries = all_entries(existing(folder))
    with frame_progress("verify", len(entries)) as advance:
        return damaged(folder, entries, advance), len(entries)


def whose(folder: Path, damage: Damage) -> str:
    """Return whose light a damaged entry was, as far as it is on record."""
    owners = [
        f"{claim.case}, Sun {claim.sun}, {claim.dataset}"
        for claim in read_claims(folder)
        if damage.path.stem in claim.keys
    ]
    return "; ".join(owners) or NOBODY


def prune(folder: Path, to_gb: float) -> tuple[int, int, bool]:
    """Delete what was used longest ago until a store is small enough.

    Returns
    -------
    (int, int, bool)
        Bytes that are left, how many entries were deleted, and whether commands that run now need
        light of this store.

    Raises
    ------
    ScenarioError
        If the size is none.
    StorageError
        If more is left than was asked for because the system lets nothing be deleted.
    """
    if not to_gb >= 0.0:
        raise ScenarioError(f"expected --to-gb to be a number of gigabytes, got {to_gb:g}")
    live = live_claims(existing(folder))
    needed = frozenset[str]().union(*(claim.needed for claim in live))
    wanted = frozenset[str]().union(*(claim.wanted for claim in live))
    refused: list[OSError] = []
    left, deleted = evict(folder, to_gb * GB, needed, wanted, refused)
    if refused and left > to_gb * GB:
        raise StorageError(
            f"expected to delete light from the store {folder} down to {to_gb:g} GB, got: "
            f"{cause(refused[0])} ({len(refused)} entries); {deleted} entries were deleted, "
            f"{size_text(left)} are left. Prune it as who may write it, or where it is not "
            "read-only"
        )
    forget_claims_without_light(folder, frozenset(entry.key for entry in all_entries(folder)))
    return left, deleted, bool(needed)


def size_text(size_bytes: float) -> str:
    """Return a size with its unit."""
    for unit, name in ((1e9, "GB"), (1e6, "MB"), (1e3, "kB")):
        if size_bytes >= unit:
            return f"{size_bytes / unit:.3g} {name}"
    return f"{size_bytes:.0f} B"


def age_text(seconds: float) -> str:
    """Return an age in the largest unit of which it holds two."""
    for unit, name in ((86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 2 * unit:
            return f"{seconds / unit:.0f} {name}"
    return f"{max(seconds, 0.0):.0f} s"
