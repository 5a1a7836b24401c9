"""So many inputs that cannot be right, shared among the kinds, and one of them again."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bench.campaign.hostile.crew import tried
from bench.campaign.hostile.kinds import COMMAND_LINE, KINDS
from bench.campaign.hostile.trial import Told, try_one
from bench.campaign.journal import Tried

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

    Returns
    -------
    list of (str, int)
        One of each kind, then the others, mixed.
    """
    shares = {kind.name: kind.share for kind in KINDS if full or not kind.full}
    shares[COMMAND_LINE] = COMMAND_LINE_SHARE
    if only is not None:
        shares = {only: 1.0}
    unit = count / sum(shares.values())
    every = [
        (name, first + number)
        for name, share in shares.items()
        for number in range(1, max(1, round(share * unit)))
    ]
    once = [(name, first) for name in shares]
    mixed = np.random.default_rng(ORDER).permutation(len(every))
    return once + [every[int(place)] for place in mixed]


def try_all(
    asked: list[tuple[str, int]],
    grounds: Path,
    scratch: Path,
    workers: int,
    until: float | None,
) -> Iterator[Tried]:
    """Try them, each kind once whatever the time, and begin no other after some instant.

    Parameters
    ----------
    asked : list of (str, int)
        Kinds and seeds.
    grounds, scratch : Path
    workers : int
    until : float, optional, s
        Of the monotonic clock.
    """

    def due() -> Iterator[tuple[str, int]]:
        met = set[str]()
        for name, seed in asked:
            if until is None or time.monotonic() < until or name not in met:
                met.add(name)
                yield name, seed

    for number, told in enumerate(tried(due(), grounds, scratch, workers), 1):
        if number % HEARTBEAT == 0:
            print(f"{number} tried", file=sys.stderr, flush=True)
        yield kept(told)


def kept(told: Told) -> Tried:
    """Return what a journal keeps of a trial."""
    fault = told.verdict.fault
    if fault:
        fault = f"{fault} [{told.how} of {told.spoilt}; {told.typed[:160]!r}]"
    return Tried(told.kind, told.seed, str(told.verdict.ended), fault, processor_s=told.processor_s)


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
