"""So many inputs that cannot be right, shared among the kinds, and one of them again."""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bench.campaign.hostile.crew import tried
from bench.campaign.hostile.kinds import COMMAND_LINE, KINDS
from bench.campaign.hostile.table import told_faults
from bench.campaign.hostile.trial import Told, try_one

COMMAND_LINE_SHARE = 3.0
ORDER = 1
HEARTBEAT = 100


def trials(count: int, first: int, only: str | None, *, full: bool) -> list[tuple[str, int]]:
    """Return kinds and seeds, mixed, so that whoever stops early has seen all kinds.

    Parameters
    ----------
    count : int
        Of all trials.
    first : int
        Seed of the first of each kind.
    only : str, optional
        The only kind.
    full : bool
        With the kinds whose ground takes a minute to make.
    """
    shares = {kind.name: kind.share for kind in KINDS if full or not kind.full}
    shares[COMMAND_LINE] = COMMAND_LINE_SHARE
    if only is not None:
        shares = {only: 1.0}
    unit = count / sum(shares.values())
    every = [
        (name, first + number)
        for name, share in shares.items()
        for number in range(max(1, round(share * unit)))
    ]
    return [every[int(place)] for place in np.random.default_rng(ORDER).permutation(len(every))]


def try_all(
    asked: list[tuple[str, int]], grounds: Path, workers: int, seconds: float | None
) -> list[Told]:
    """Try them, tell each fault as it is found, and begin none after some seconds.

    Parameters
    ----------
    asked : list of (str, int)
        Kinds and seeds.
    grounds : Path
    workers : int
    seconds : float, optional, s
    """
    began, found = time.monotonic(), list[Told]()

    def due() -> Iterator[tuple[str, int]]:
        for trial in asked:
            if seconds is not None and time.monotonic() - began > seconds:
                return
            yield trial

    with tempfile.TemporaryDirectory(prefix="rvbench-campaign-") as scratch:
        for told in tried(due(), grounds, Path(scratch), workers):
            found.append(told)
            if len(found) % HEARTBEAT == 0:
                print(f"{len(found)} tried", file=sys.stderr, flush=True)
            for line in told_faults([told]):
                print(f"{len(found)} tried; {line}", file=sys.stderr, flush=True)
    return found


def try_again(name: str, seed: int, grounds: Path, folder: Path) -> int:
    """Try one seed in this process, tell all of it, and leave its folder; return the exit code.

    Parameters
    ----------
    name : str
        Of the kind.
    seed : int
    grounds : Path
    folder : Path
        Of the trial.
    """
    told = try_one(name, seed, grounds, folder)
    print(f"in {folder / 'here'}: {told.how} of {told.spoilt}\nrvbench {told.typed}")
    print(told.errors or "(nothing was said)")
    print(f"{told.verdict.ended}{f': {told.verdict.fault}' if told.verdict.fault else ''}")
    return int(bool(told.verdict.fault))
