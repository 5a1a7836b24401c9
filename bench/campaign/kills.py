"""Verbs killed at random instants, again and again, then left to end: the bytes are the same.

Half the kills come as a file is about to get its name, counted in files, so that a seed repeats
them to the step. Others come at an instant of the clock after the first file, wherever the process
then is, in a kernel or a library, its workers with it; and some hit one of its workers alone, of
which it must tell.
"""

from __future__ import annotations

import itertools
import json
import shutil
import time
from collections.abc import Collection, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from bench.campaign.grounds import FORMAT, SUITE, code_of_the_house
from bench.campaign.journal import FAULT, Tried
from bench.campaign.processes import (
    contents,
    differences,
    ended,
    fault_of,
    kill_group,
    kill_one_of,
    processor_s,
    start,
)
from models.errors import RvbenchError

DRAW = 1815
MOST_KILLS = 3
HOWS = ("at a file", "at a file", "at an instant", "a worker")
STORE = ("--store", "store")
KILLED: dict[str, tuple[str, ...]] = {
    "render": ("render", "cases/lit.toml", "--out", "out", *STORE),
    "run": ("run", "cases/lit.toml", "--seeds", "2", "--out", "out", *STORE),
    "sweep": (
        "sweep", "cases/lit.toml", "--suns", "S2", "S3", "--time-s", "1", "--width", "64",
        "--threads", "2", "--out", "out", *STORE,
    ),
    "dataset": ("dataset", "cases/drawn.toml", "--workers", "2", "--out", "out"),
    "export": ("export", "pairs/data", "--as", FORMAT, "--out", "out"),
    "suite": (*SUITE, "--workers", "2", "--out", "out"),
    "estimate": ("estimate", "out"),
    "fuse": ("fuse", "flight/hand/data", "flight/chaser/data", "--out", "out/fused.jsonl"),
    "compare": (
        "compare", "pairs/data", "pairs/said.bop.csv", "--vsd-px", "0", "--resamples", "100",
        "--out", "out",
    ),
    "pairs": (
        "run", "cases/small.toml", "--seeds", "2", "--threads", "2", "--out", "out", *STORE,
    ),
    "filters": (
        "suite", "vinag2018", "--quick", "--parts", "leo", "--seeds", "1", "--duration-s", "60",
        "--workers", "2", "--out", "out",
    ),
}  # fmt: skip
"""By the name of the verb; ``pairs`` is a run of the house's markers, ``filters`` another suite."""
COPIED = {"estimate": "pairs/data"}
"""What a verb begins with in its folder, of the grounds, but for estimates and what is made of
them."""


@dataclass(frozen=True)
class Undisturbed:
    """A verb that nobody disturbed.

    Attributes
    ----------
    made : dict of str to str
        What it wrote.
    first_s, last_s : float, s
        From its start to its first file, and to its end.
    files : int
        How often the process that was started, none of its workers, gave a file its name.
    """

    made: dict[str, str]
    first_s: float
    last_s: float
    files: int


@dataclass
class Kills:
    """The grounds, and what verbs wrote undisturbed.

    Attributes
    ----------
    grounds, scratch : Path
    """

    grounds: Path
    scratch: Path
    whole: dict[str, Undisturbed] = field(default_factory=dict)

    def try_one(self, verb: str, seed: int) -> tuple[int, str]:
        """Kill a verb one to three times, let it end, compare.

        Parameters
        ----------
        verb : str
        seed : int

        Returns
        -------
        int, str
            Kills that found it alive, and the fault; nothing if it stood.
        """
        if verb not in self.whole:
            self.whole[verb] = self._undisturbed(verb)
        whole = self.whole[verb]
        random = np.random.default_rng([DRAW, list(KILLED).index(verb), seed])
        place, killed = self._place(verb, f"{verb}-{seed}"), 0
        for _ in range(int(random.integers(1, MOST_KILLS + 1))):
            how, share = HOWS[int(random.integers(len(HOWS)))], random.random()
            now, fault = self._struck(verb, place, how, share)
            killed += now
            if fault:
                return killed, fault
        fault = fault_of(ended(start(KILLED[verb], place)), 0)
        fault = fault or differences(whole.made, _made(place))
        if not fault and (left := sorted(place.rglob("*.part"))):
            fault = f"left {left[0].relative_to(place)}"
        if not fault:
            shutil.rmtree(place)
        return killed, fault

    def _struck(self, verb: str, place: Path, how: str, share: float) -> tuple[bool, str]:
        """Begin a verb and kill it, or one of its workers; return whether so, and the fault."""
        whole = self.whole[verb]
        if how == "at a file":
            process = start(KILLED[verb], place, struck=int(share * whole.files))
            heard, may_end = ended(process), (0, -9)
        else:
            process = start(KILLED[verb], place)
            time.sleep(whole.first_s + share * (whole.last_s - whole.first_s))
            alone = how == "a worker" and kill_one_of(process, share)
            may_end = (0, 2) if alone else (0, -9)
            if not alone:
                kill_group(process)
            heard = ended(process)
        return heard.code != 0, fault_of(heard, *may_end)

    def _undisturbed(self, verb: str) -> Undisturbed:
        """Return what a verb does undisturbed; kept beside the grounds, by the code's hash."""
        kept, code = self.grounds / "undisturbed" / f"{verb}.json", code_of_the_house()
        if kept.is_file() and (told := json.loads(kept.read_text()))["code"] == code:
            return Undisturbed(**told["whole"])
        whole = self._left_alone(verb)
        kept.parent.mkdir(exist_ok=True)
        kept.write_text(json.dumps({"code": code, "whole": asdict(whole)}))
        return whole

    def _left_alone(self, verb: str) -> Undisturbed:
        place, count = self._place(verb, verb), self.scratch / f"{verb}.instants"
        began = time.monotonic()
        fault = fault_of(ended(start(KILLED[verb], place, counted=count)), 0)
        ended_s = time.monotonic() - began
        if fault:
            raise RvbenchError(f"expected {verb} to end well where nobody disturbs it: {fault}")
        instants = [float(line) - began for line in count.read_text().splitlines()]
        return Undisturbed(_made(place), instants[0], ended_s, len(instants))

    def _place(self, verb: str, name: str) -> Path:
        place = self.scratch / name
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir(parents=True)
        for ground in ("cases", "pairs", "flight"):
            (place / ground).symlink_to(self.grounds / ground)
        if (copied := COPIED.get(verb)) is not None:
            own = shutil.ignore_patterns("estimates", "score.json", "report.html")
            shutil.copytree(self.grounds / copied, place / "out", ignore=own)
        return place


def try_kills(
    verbs: Sequence[str],
    count: int,
    first: int,
    grounds: Path,
    scratch: Path,
    seen: Collection[tuple[str, int]],
    until: float | None,
    *,
    once: bool = False,
) -> Iterator[Tried]:
    """Kill each verb in turn, until there were so many kills, and at least one verb.

    Parameters
    ----------
    verbs : sequence of str
    count : int
        Kills that found a verb alive.
    first : int
        Seed.
    grounds, scratch : Path
    seen : collection of (str, int)
        Verbs and seeds that are left out.
    until : float, optional, s
        Of the monotonic clock: nothing is begun later.
    once : bool
        Only the first seed, however few kills it brings.
    """
    campaign, killed, begun = Kills(grounds, scratch), 0, False
    for seed in [first] if once else itertools.count(first):
        for verb in verbs:
            if (verb, seed) in seen:
                continue
            late = until is not None and time.monotonic() > until
            if killed >= count or (begun and late):
                return
            begun, began_s = True, processor_s()
            now, fault = campaign.try_one(verb, seed)
            killed += now
            ended = FAULT if fault else "stood"
            yield Tried(verb, seed, ended, fault, now, processor_s() - began_s)


def _made(place: Path) -> dict[str, str]:
    return {
        f"{name}/{path}": digest
        for name in ("out", "store")
        if (place / name).is_dir()
        for path, digest in contents(place / name).items()
    }
