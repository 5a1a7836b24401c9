"""One trial: a copy of the ground, a file of it spoilt, a verb in this process, a verdict."""

from __future__ import annotations

import os
import shutil
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.campaign.hostile.kind import OUT, Kind
from bench.campaign.hostile.kinds import COMMAND_LINE, KINDS
from bench.campaign.hostile.spoiling import spoil
from bench.campaign.hostile.tree import damage, tree
from bench.campaign.hostile.typed import typed_wrongly
from bench.campaign.hostile.verb_alone import Reached, no_heavy_work
from bench.campaign.hostile.verdict import Heard, Verdict, judge
from bench.campaign.processes import processor_s

DRAW = 1789  # what else the seed is for
TIMES_S = {"small.toml": "200", "armed.toml": "320"}
"""Of a pose in a case, where it is not the first instant that there is."""
OURS: tuple[str, ...] = (
    "pairs/data/score.json", "pairs/data/report.html", "pairs/data/estimates/*",
    "pairs/data/show/*", "pairs/store/*",
)  # fmt: skip
NAMES = (*(kind.name for kind in KINDS), COMMAND_LINE)


@dataclass(frozen=True)
class Told:
    """A trial, for the table and for who repeats it."""

    kind: str
    seed: int
    typed: str
    spoilt: str
    how: str
    verdict: Verdict
    errors: str
    processor_s: float = 0.0


def try_one(name: str, seed: int, grounds: Path, folder: Path) -> Told:
    """Try one seed of a kind.

    Parameters
    ----------
    name : str
    seed : int
    grounds : Path
    folder : Path
        Of the trial; made anew, and left as it is when the trial is over.
    """
    random, began_s = np.random.default_rng([DRAW, NAMES.index(name), seed]), processor_s()
    place = lay_out(name, grounds, folder)
    if name == COMMAND_LINE:
        typed, how = typed_wrongly(random)
        spoilt, never_right, allowed = "", False, OURS
    else:
        kind = KINDS[NAMES.index(name)]
        done = spoil(random, kind, place / kind.ground)
        spoilt, how = str(done.path.relative_to(place)), done.how
        typed = typed_of(kind, spoilt, int(random.integers(len(kind.commands))))
        never_right, allowed = kind.needed and done.never_right, kind.ours
    before = tree(folder)
    heard = hear(typed, place)
    after = tree(folder)
    if name == COMMAND_LINE:  # it may have been told to write anywhere; but over nothing of others
        after = {path: after[path] for path in after if path in before}
    damaged = damage(before, after, [f"here/{each}" for each in (f"{OUT}/*", *allowed)])
    verdict = judge(heard, never_right=never_right, damaged=damaged, written=place / OUT)
    spent_s = processor_s() - began_s
    return Told(name, seed, " ".join(typed), spoilt, how, verdict, heard.errors, spent_s)


def lay_out(name: str, grounds: Path, folder: Path) -> Path:
    """Copy the grounds of a kind, beside a file that is not ours; return the folder of the copies.

    Parameters
    ----------
    name : str
    grounds, folder : Path
        As of ``try_one``.
    """
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "decoy").mkdir(parents=True)
    (folder / "decoy" / "precious.txt").write_text("not ours\n")
    place = folder / "here"
    (place / OUT).mkdir(parents=True)
    kind = None if name == COMMAND_LINE else KINDS[NAMES.index(name)]
    for ground in ("cases", "pairs", "export") if kind is None else (kind.ground, *kind.beside):
        shutil.copytree(grounds / ground, place / ground)
    if kind is None:
        shutil.copytree(folder / "decoy", place / "decoy")
    return place


def hear(typed: list[str], place: Path) -> Heard:
    """Run a verb in a folder of this process's; return what it did and said."""
    from bench.cli import main

    with _heard(place) as said, no_heavy_work():
        try:
            code, escaped = main(typed), ""
        except Reached:
            code, escaped = None, ""
        except BaseException as error:
            code, escaped = 2, f"{type(error).__name__}: {error}"
    return Heard(code, said[0], escaped)


def typed_of(kind: Kind, spoilt: str, number: int) -> list[str]:
    """Return one of a kind's command lines, with the file that is spoilt in its place.

    Parameters
    ----------
    kind : Kind
    spoilt : str
        From the folder of the trial.
    number : int
        Of the command.
    """
    name = Path(spoilt).name
    words = {"file": spoilt, "name": name, "time_s": TIMES_S.get(name, "0")}
    return [each.format(**words) for each in kind.commands[number]]


@contextmanager
def _heard(place: Path) -> Iterator[list[str]]:
    """Run in a folder, with both streams in files, as C libraries write to them, too."""
    was = os.getcwd()
    kept = os.dup(1), os.dup(2)
    said = [""]
    paths = [place.parent.parent / f"said_{number}.{os.getpid()}" for number in (1, 2)]
    sys.stdout.flush()
    sys.stderr.flush()
    for number, path in zip((1, 2), paths, strict=True):
        opened = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(opened, number)
        os.close(opened)
    os.chdir(place)
    try:
        with warnings.catch_warnings():
            _warn_always()
            yield said
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for number, stream in zip((1, 2), kept, strict=True):
            os.dup2(stream, number)
            os.close(stream)
        os.chdir(was)
        said[0] = paths[1].read_bytes().decode(errors="backslashreplace")


def _warn_always() -> None:
    """Have warnings that users see told each time, not only the first: a seed repeats its trial."""
    kinds: tuple[Any, ...] = (RuntimeWarning, UserWarning, SyntaxWarning, FutureWarning)
    for kind in kinds:
        warnings.simplefilter("always", kind)
