"""Processes that try seeds: one that hangs, dies or takes all memory is a fault, and replaced."""

from __future__ import annotations

import multiprocessing
import os
import resource
import signal
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from bench.campaign.hostile.trial import Told, try_one
from bench.campaign.hostile.verdict import Ended, Verdict
from bench.campaign.processes import words_of

MOST_PROCESSOR_S = 60.0  # of a trial; the slowest takes a tenth of it
MOST_WAITING_S = 120.0  # without any processor time, and without asking for it
TICK_S = 1.0 / os.sysconf("SC_CLK_TCK")
MOST_MEMORY = 8 * 2**30
MOST_FILE = 3 * 2**30
PATIENCE_S = 2.0


@dataclass
class _Hand:
    """A process, and what it has in hand."""

    process: Any
    line: Connection
    asked: tuple[str, int] | None = None
    since_s: float = 0.0
    began_at_s: float = 0.0
    spent_s: float = 0.0

    def ask(self, trial: tuple[str, int]) -> None:
        """Hand it a trial."""
        self.asked, self.since_s = trial, time.monotonic()
        self.began_at_s = self.spent_s = _processor(self.process.pid)[0]
        self.line.send(trial)

    def hangs(self) -> str:
        """Return why it is taken to hang; nothing while it works, or waits for a core."""
        if self.asked is None:
            return ""
        spent_s, waits = _processor(self.process.pid)
        if spent_s != self.spent_s or not waits:
            self.spent_s, self.since_s = spent_s, time.monotonic()
        if spent_s - self.began_at_s > MOST_PROCESSOR_S:
            return f"hangs: not done after {MOST_PROCESSOR_S:g} s of a processor"
        if time.monotonic() - self.since_s > MOST_WAITING_S:
            return f"hangs: waits for what does not come in {MOST_WAITING_S:g} s"
        return ""


def tried(
    trials: Iterable[tuple[str, int]], grounds: Path, scratch: Path, workers: int
) -> Iterator[Told]:
    """Try every seed, in whatever order.

    Parameters
    ----------
    trials : iterable of (str, int)
        Kinds and seeds.
    grounds, scratch : Path
    workers : int
    """
    left, over = iter(trials), False
    hands = [_begun(grounds, scratch / str(number)) for number in range(workers)]
    try:
        while True:
            for number, hand in enumerate(hands):
                if hand.asked is None and not over:
                    trial = next(left, None)
                    over = trial is None
                    if trial is not None:
                        hand.ask(trial)
                if why := hand.hangs():
                    yield _fault(hand, why)
                    hands[number] = _begun(grounds, scratch / str(number))
            busy = {hand.line: number for number, hand in enumerate(hands) if hand.asked}
            if not busy and over:
                return
            for line in wait(list(busy), PATIENCE_S):
                number = busy[line]  # type: ignore[index]
                hand = hands[number]
                try:
                    told: Told = hand.line.recv()
                    hand.asked = None
                    yield told
                except EOFError:
                    hand.process.join()
                    yield _fault(hand, f"the process died: {hand.process.exitcode}")
                    hands[number] = _begun(grounds, scratch / str(number))
    finally:
        for hand in hands:
            hand.process.kill()


def _begun(grounds: Path, folder: Path) -> _Hand:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    folder.mkdir(parents=True, exist_ok=True)
    process = context.Process(target=_serve, args=(theirs, grounds, folder), daemon=False)
    process.start()
    theirs.close()
    return _Hand(process, ours)


def _fault(hand: _Hand, what: str) -> Told:
    assert hand.asked is not None
    hand.process.kill()
    hand.process.join()
    name, seed = hand.asked
    return Told(name, seed, "", "", "", Verdict(Ended.FAULT, what), "")


def _processor(number: int) -> tuple[float, bool]:
    """Return the processor time of a process and of those it started, s, and whether all wait.

    One that waits for a core, as on a busy machine, is at work.
    """
    states = {int(path.name): words_of(path) for path in Path("/proc").glob("[0-9]*")}
    spent_s, waits, left = 0.0, True, [number]
    while left:
        process = left.pop()
        words = states.get(process, [])
        if words:  # else it is over, which its line tells
            spent_s += TICK_S * sum(map(int, words[11:15]))
            waits = waits and words[0] in "SDZ"
        left += [child for child, its in states.items() if its and int(its[1]) == process]
    return spent_s, waits


def _serve(line: Connection, grounds: Path, folder: Path) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_FILE, MOST_FILE))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.environ["RVBENCH_STORE"] = str(folder / "default_store")
    while True:
        try:
            name, seed = line.recv()
        except EOFError:
            return
        line.send(try_one(name, seed, grounds, folder / "trial"))
