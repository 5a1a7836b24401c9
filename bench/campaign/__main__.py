"""``make campaign``: hostile inputs, kills, and disks, clocks and crowds that do harm; a table."""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal
from unittest.mock import patch

import tyro
from tyro.conf import Positional, arg

from bench.campaign.grounds import make_grounds
from bench.campaign.hostile.controls import check_controls
from bench.campaign.hostile.running import trials, try_again, try_all
from bench.campaign.hostile.trial import NAMES
from bench.campaign.journal import FAULT, Journal, Tried
from bench.campaign.kills import KILLED, try_kills
from bench.campaign.places import PLACES, try_places
from bench.campaign.tables import fault_line, table_of
from models.errors import RvbenchError
from models.plain_console import plain_console

KINDS: dict[str, tuple[str, ...]] = {
    "hostile": NAMES,
    "kills": tuple(KILLED),
    "places": tuple(PLACES),
}
Seconds = Annotated[float | None, arg(metavar="S", help_behavior_hint="")]


@dataclass(frozen=True)
class Campaign:
    """Do harm to rvbench, by seeds, and see whether it stands.

        python -m bench.campaign hostile --count 10000
        python -m bench.campaign hostile --only GLB --seed 17
        python -m bench.campaign kills --count 1000
        python -m bench.campaign places --count 60

    Exit code 1 if it did not. What was tried is kept in OUT/WHAT.jsonl and not tried again: the
    same command goes on, and its table is of all trials.
    """

    what: Positional[Literal["hostile", "kills", "places"]]
    """files and command lines that cannot be right; verbs killed and gone on with; disks that are
    full, read-only or gone, clocks that run back, and two to eight who write at once"""
    count: int = 100
    """inputs, kills, or places, those among them that were tried before"""
    first: int = 0
    """first seed"""
    only: Annotated[str | None, arg(metavar="KIND", help_behavior_hint="")] = None
    """a single kind, as the table names it"""
    seed: Annotated[int | None, arg(metavar="N", help_behavior_hint="")] = None
    """of that kind, this seed alone, again: what a fault names"""
    seconds: Seconds = None
    """begin nothing after so many seconds, but one of each kind of hostile inputs, or a single
    trial, is always tried"""
    full: bool = True
    """hostile inputs to the folders, too, that take minutes to make"""
    workers: int = 2
    """processes that try hostile inputs"""
    out: Path = Path("out/campaign")
    """grounds, which are made once, and WHAT.jsonl"""

    def run(self) -> int:
        """Do it; return the exit code.

        Raises
        ------
        RvbenchError
            If there is no such kind, a seed comes without one, or what is right is refused.
        """
        began = time.monotonic()
        kinds = KINDS[self.what]
        if self.only is not None and self.only not in kinds:
            raise RvbenchError(f"expected --only one of {', '.join(kinds)}, got {self.only!r}")
        if self.seed is not None and self.only is None:
            raise RvbenchError("expected --only KIND with --seed, which is one of a kind's")
        out = self.out.resolve()
        os.environ.setdefault("RVBENCH_CACHE", str(out / "cache"))
        journal = Journal(out / f"{self.what}.jsonl")
        flies = self.what == "kills" and self.only in (None, "fuse")
        make_grounds(out / "grounds", tumble=self.full and self.what == "hostile", flight=flies)
        if self.what == "hostile" and self.seed is not None:
            assert self.only is not None
            return try_again(self.only, self.seed, out / "grounds", out / "trial")
        until = None if self.seconds is None else began + self.seconds
        with tempfile.TemporaryDirectory(prefix="rvbench-campaign-") as scratch:
            return self._told(journal, self._tried(journal, until, Path(scratch)))

    def _tried(self, journal: Journal, until: float | None, scratch: Path) -> Iterator[Tried]:
        grounds = (self.out / "grounds").resolve()
        if self.what == "hostile":
            with patch.dict(os.environ, RVBENCH_STORE=str(scratch / "store")):
                check_controls(grounds, scratch / "control" / "trial", self.only, full=self.full)
            asked = trials(self.count, self.first, self.only, full=self.full)
            return try_all(journal.left(asked), grounds, scratch, self.workers, until)
        names = (self.only,) if self.only is not None else KINDS[self.what]
        try_some = try_kills if self.what == "kills" else try_places
        if self.seed is not None:
            return try_some(names, 1, self.seed, grounds, scratch, set(), until, once=True)
        own = [each for each in journal.tried if each.kind in names and each.seed >= self.first]
        done = sum(each.kills for each in own) if self.what == "kills" else len(own)
        left = max(0, self.count - done)
        return try_some(names, left, self.first, grounds, scratch, journal.seen, until)

    def _told(self, journal: Journal, tried: Iterator[Tried]) -> int:
        """Keep and tell each trial as it ends; return the exit code."""
        before, faults = len(journal.tried), list[str]()
        for each in tried:
            if self.seed is None:
                journal.keep(each)
            if each.ended == FAULT:
                faults.append(fault_line(each))
                print(faults[-1], file=sys.stderr, flush=True)
        shown = journal.tried
        plain_console().print(table_of(self.what, KINDS[self.what], shown))
        print("\n".join([*faults, f"{len(shown) - before} tried now, {len(faults)} faults"]))
        return int(bool(faults))


if __name__ == "__main__":
    try:
        sys.exit(tyro.cli(Campaign, prog="python -m bench.campaign").run())
    except RvbenchError as error:
        sys.exit(f"campaign: {error}")
