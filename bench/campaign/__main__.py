"""``make campaign``: hostile inputs, kills, and disks, clocks and crowds that do harm; a table."""

from __future__ import annotations

import json
import os
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro
from rich import box
from rich.table import Table
from tyro.conf import Positional, arg

from bench.campaign.grounds import make_grounds
from bench.campaign.hostile.running import trials, try_again, try_all
from bench.campaign.hostile.table import hostile_table, told_faults
from bench.campaign.hostile.trial import NAMES
from bench.campaign.kills import KILLED, Kills
from bench.campaign.places import PLACES, Skipped, try_place
from models.errors import RvbenchError
from models.plain_console import plain_console

Seconds = Annotated[float | None, arg(metavar="S", help_behavior_hint="")]


@dataclass(frozen=True)
class Campaign:
    """Do harm to rvbench, by seeds, and see whether it stands.

        python -m bench.campaign hostile --count 10000
        python -m bench.campaign hostile --only GLB --seed 17
        python -m bench.campaign kills --count 1000
        python -m bench.campaign places --count 60

    Exit code 1 if it did not.
    """

    what: Positional[Literal["hostile", "kills", "places"]]
    """files and command lines that cannot be right; verbs killed and gone on with; disks that are
    full or read-only, clocks that run back, and two to eight who write at once"""
    count: int = 100
    """inputs, kills, or places"""
    first: int = 0
    """first seed"""
    only: Annotated[str | None, arg(metavar="KIND", help_behavior_hint="")] = None
    """a single kind, as the table names it"""
    seed: Annotated[int | None, arg(metavar="N", help_behavior_hint="")] = None
    """of that kind, this seed alone: what a fault names"""
    seconds: Seconds = None
    """begin nothing after so many seconds"""
    full: bool = True
    """hostile inputs to the folders, too, that take minutes to make"""
    workers: int = 2
    """processes that try hostile inputs"""
    out: Path = Path("out/campaign")
    """grounds, which are made once, and WHAT.json"""

    def run(self) -> int:
        """Do it; return the exit code.

        Raises
        ------
        RvbenchError
            If there is no such kind, or a seed comes without one.
        """
        kinds = {"hostile": NAMES, "kills": tuple(KILLED), "places": tuple(PLACES)}[self.what]
        if self.only is not None and self.only not in kinds:
            raise RvbenchError(f"expected --only one of {', '.join(kinds)}, got {self.only!r}")
        if self.seed is not None and self.only is None:
            raise RvbenchError("expected --only KIND with --seed, which is one of a kind's")
        grounds = (self.out / "grounds").resolve()
        os.environ.setdefault("RVBENCH_CACHE", str(self.out.resolve() / "cache"))
        make_grounds(grounds, tumble=self.full and self.what == "hostile")
        if self.what == "hostile":
            return self._hostile(grounds)
        return self._kills(grounds) if self.what == "kills" else self._places(grounds)

    def _hostile(self, grounds: Path) -> int:
        if self.seed is not None:
            assert self.only is not None
            return try_again(self.only, self.seed, grounds, self.out.resolve() / "trial")
        asked = trials(self.count, self.first, self.only, full=self.full)
        found = try_all(asked, grounds, self.workers, self.seconds)
        faults = told_faults(found)
        plain_console().print(hostile_table(found))
        self._write([asdict(each) for each in found], faults)
        return int(bool(faults))

    def _kills(self, grounds: Path) -> int:
        verbs = [self.only] if self.only is not None else list(KILLED)
        counted = {verb: [0, 0, 0] for verb in verbs}
        faults, seed, began = list[str](), self.seed or self.first, time.monotonic()
        with tempfile.TemporaryDirectory(prefix="rvbench-campaign-") as scratch:
            campaign = Kills(grounds, Path(scratch))
            while sum(own[1] for own in counted.values()) < self.count and self._goes_on(began):
                for verb in verbs:
                    killed, fault = campaign.try_one(verb, seed)
                    row = counted[verb]
                    row[0], row[1], row[2] = row[0] + 1, row[1] + killed, row[2] + bool(fault)
                    self._tell(faults, verb, seed, fault)
                seed += 1
                if self.seed is not None:
                    break
        self._print(("verb", "gone on with", "kills", "faults"), counted)
        self._write(counted, faults)
        return int(bool(faults))

    def _places(self, grounds: Path) -> int:
        names = [self.only] if self.only is not None else list(PLACES)
        counted = {name: [0, 0, 0] for name in names}
        faults, began = list[str](), time.monotonic()
        each = 1 if self.seed is not None else max(1, self.count // len(names))
        first = self.first if self.seed is None else self.seed
        with tempfile.TemporaryDirectory(prefix="rvbench-campaign-") as scratch:
            for seed in range(first, first + each):
                for name in names:
                    if not self._goes_on(began):
                        break
                    try:
                        fault = try_place(name, seed, grounds, Path(scratch) / "place")
                    except Skipped as why:
                        counted[name][2] += 1
                        print(f"{name}: skipped: {why}", file=sys.stderr)
                        continue
                    counted[name][0] += 1
                    counted[name][1] += bool(fault)
                    self._tell(faults, name, seed, fault)
        self._print(("place", "tried", "faults", "skipped"), counted)
        self._write(counted, faults)
        return int(bool(faults))

    def _goes_on(self, began: float) -> bool:
        return self.seconds is None or time.monotonic() - began < self.seconds

    def _tell(self, faults: list[str], kind: str, seed: int, fault: str) -> None:
        if fault:
            faults.append(f"--only {kind!r} --seed {seed}: {fault}")
            print(faults[-1], file=sys.stderr, flush=True)

    def _print(self, titles: tuple[str, ...], counted: dict[str, list[int]]) -> None:
        table = Table(box=box.SIMPLE)
        for place, title in enumerate(titles):
            table.add_column(title, justify="right" if place else "left")
        for name, row in counted.items():
            table.add_row(name, *map(str, row))
        plain_console().print(table)

    def _write(self, told: object, faults: list[str]) -> None:
        print("\n".join([*faults, f"{len(faults)} faults"]))
        text = json.dumps({"faults": faults, "told": told}, indent=0)
        (self.out / f"{self.what}.json").write_text(text + "\n")


if __name__ == "__main__":
    try:
        sys.exit(tyro.cli(Campaign, prog="python -m bench.campaign").run())
    except RvbenchError as error:
        sys.exit(f"campaign: {error}")
