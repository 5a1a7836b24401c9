"""``python -m bench.campaign.hostile``: so many inputs that cannot be right, and what came of them."""

from __future__ import annotations

import json
import os
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro
from tyro.conf import arg

from bench.campaign.grounds import make_grounds
from bench.campaign.hostile.crew import tried
from bench.campaign.hostile.kinds import COMMAND_LINE, KINDS
from bench.campaign.hostile.table import hostile_table, told_faults
from bench.campaign.hostile.trial import NAMES, Told, try_one
from models.plain_console import plain_console

COMMAND_LINE_SHARE = 3.0


@dataclass(frozen=True)
class Hostile:
    """Spoil files and command lines, each by a seed, and see whether each is refused or right."""

    count: int = 10_000
    """trials, shared among the kinds"""
    first: int = 0
    """seed of the first trial of each kind"""
    seed: Annotated[int | None, arg(help_behavior_hint="")] = None
    """try this seed of `--only` alone, in this process, and tell all of it"""
    only: Annotated[str | None, arg(help_behavior_hint="")] = None
    """the only kind that is tried"""
    full: bool = True
    """with the kinds whose ground takes a minute to make"""
    seconds: Annotated[float | None, arg(help_behavior_hint="")] = None
    """begin no trial later than this, in s"""
    workers: int = 2
    """processes"""
    out: Path = Path("out/campaign")
    """folder of the grounds, and of hostile.json"""

    def run(self) -> int:
        """Try, and print the table; return how many faults there were, at most 1."""
        grounds = (self.out / "grounds").resolve()
        os.environ.setdefault("RVBENCH_CACHE", str(self.out.resolve() / "cache"))
        make_grounds(grounds, tumble=self.full)
        if self.seed is not None:
            assert self.only is not None, "a seed is one of a kind: --only KIND"
            folder = self.out.resolve() / "trial"
            told = try_one(self.only, self.seed, grounds, folder)
            print(f"rvbench {told.typed}\n{told.how} of {told.spoilt}, in {folder}\n{told.errors}")
            print(f"{told.verdict.ended}: {told.verdict.fault}")
            return int(bool(told.verdict.fault))
        found: list[Told] = []
        with tempfile.TemporaryDirectory(prefix="rvbench-campaign-") as scratch:
            began = time.monotonic()
            for told in tried(self._trials(), grounds, Path(scratch), self.workers):
                found.append(told)
                if told.verdict.fault:
                    print(told_faults([told])[0], file=sys.stderr, flush=True)
                if self.seconds is not None and time.monotonic() - began > self.seconds:
                    break
        plain_console().print(hostile_table(found))
        faults = told_faults(found)
        print("\n".join(faults))
        text = json.dumps([asdict(each) for each in found], indent=0)
        (self.out / "hostile.json").write_text(text)
        return int(bool(faults))

    def _trials(self) -> list[tuple[str, int]]:
        shares = {kind.name: kind.share for kind in KINDS if self.full or not kind.full}
        shares[COMMAND_LINE] = COMMAND_LINE_SHARE
        if self.only is not None:
            shares = {self.only: 1.0}
        unit = self.count / sum(shares.values())
        trials = [
            (name, self.first + number)
            for name, share in shares.items()
            for number in range(max(1, round(share * unit)))
        ]
        order = np.random.default_rng(0).permutation(len(trials))
        return [trials[int(place)] for place in order]


if __name__ == "__main__":
    assert NAMES
    sys.exit(tyro.cli(Hostile).run())
