"""Disks that fill or cannot be written, clocks that run back, and many who write at once."""

from __future__ import annotations

import itertools
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from bench.campaign.grounds import FORMAT
from bench.campaign.journal import FAULT, Tried
from bench.campaign.processes import contents, differences, ended, fault_of, processor_s, start

DRAW = 1848
ROOM_KB = (40, 700)  # where a run of 128 columns takes 900
ENOUGH = "64m"
MOST_CLOCK_READS = 20
YEAR_S = 365.25 * 86400.0
MOST_WRITERS = 8
FILES_OF_A_RUN = 40  # that get their names, about; more are none, and nothing befalls it


class Skipped(Exception):
    """A place that this machine does not let us make, and why."""


def _full_disk(grounds: Path, place: Path, random: np.random.Generator) -> str:
    """Run on a disk that fills up, then with room: whole files are kept, and it goes on."""
    with _disk(place / "disk") as disk:
        _mount("-o", f"remount,size={int(random.integers(*ROOM_KB))}k", disk)
        typed = ("run", grounds / "cases" / "small.toml", "--out", disk / "out",
                 "--store", place / "store")  # fmt: skip
        heard = ended(start(typed, place))
        fault = fault_of(heard, 0, 2)
        if fault:
            return fault
        if heard.code == 2 and "No space left" not in heard.errors:
            return f"another message than that of a full disk: {heard.errors[-300:]}"
        kept = contents(disk / "out") if (disk / "out").is_dir() else {}
        _mount("-o", f"remount,size={ENOUGH}", disk)
        return _goes_on(typed, place, grounds, disk / "out", kept)


def _full_store(grounds: Path, place: Path, random: np.random.Generator) -> str:
    """Run with a store that fills up, then with room."""
    with _disk(place / "disk") as disk:
        _mount("-o", f"remount,size={int(random.integers(*ROOM_KB)) // 4}k", disk)
        typed = ("run", grounds / "cases" / "small.toml", "--out", place / "out",
                 "--store", disk / "store")  # fmt: skip
        fault = fault_of(ended(start(typed, place)), 0, 2)
        if fault:
            return fault
        _mount("-o", f"remount,size={ENOUGH}", disk)
        return _goes_on(typed, place, grounds, place / "out", {})


def _vanished_folder(grounds: Path, place: Path, random: np.random.Generator) -> str:
    """Run on a disk that is unmounted meanwhile, and mounted again."""
    return _vanished(grounds, place, random, "out")


def _vanished_store(grounds: Path, place: Path, random: np.random.Generator) -> str:
    """Run with a store whose disk is unmounted meanwhile, and mounted again."""
    return _vanished(grounds, place, random, "store")


def _vanished(grounds: Path, place: Path, random: np.random.Generator, which: str) -> str:
    """Unmount the disk of one of a run's folders; in half of the trials mount it again at once."""
    folders = {"out": place / "out", "store": place / "store"}
    with _disk(place / "kept") as kept, _bound(kept, place / "seen") as seen:
        folders[which] = seen / which
        typed = ("run", grounds / "cases" / "small.toml", "--out", folders["out"],
                 "--store", folders["store"])  # fmt: skip
        struck, comes_back = int(random.integers(FILES_OF_A_RUN)), random.random() < 0.5
        gone, back = f"umount --lazy {seen}", f"mount --bind {kept} {seen}"
        if comes_back:
            gone = f"{gone}; (sleep {random.uniform(0.0, 1.0):.3f}; {back}) > /dev/null 2>&1 &"
        heard = ended(start(typed, place, struck=struck, befalls=gone))
        if fault := fault_of(heard, 0, 2):
            return fault
        if not comes_back and (beneath := sorted(seen.rglob("*"))):
            return f"wrote {beneath[-1].relative_to(seen)} beneath the place of the mount"
        if not seen.is_mount():
            _mount("--bind", kept, seen)
        done = differences(contents(grounds / "pairs" / "data"), contents(folders["out"]))
        if heard.code == 0 and done:
            return f"said that all was done, but {done}"
        return _goes_on(typed, place, grounds, folders["out"], {})


def _read_only(grounds: Path, place: Path, random: np.random.Generator) -> str:
    """Run, report and export into what cannot be written: one message, and nothing is changed."""
    with _disk(place / "disk") as disk:
        shutil.copytree(grounds / "pairs" / "data", disk / "data")
        _mount("-o", "remount,ro", disk)
        case, before = grounds / "cases" / "small.toml", contents(disk)
        choices: tuple[tuple[object, ...], ...] = (
            ("run", case, "--out", disk / "out", "--store", place / "store"),
            ("run", case, "--out", disk / "data", "--store", place / "store", "--seeds", "2"),
            ("render", case, "--out", place / "out", "--store", disk / "store"),
            ("estimate", disk / "data"), ("score", disk / "data"), ("report", disk / "data"),
            ("export", disk / "data", "--as", FORMAT, "--out", disk / "export"),
            ("dataset", grounds / "cases" / "spec.toml", "--out", disk / "few"),
            ("suite", "pesce2019", "--quick", "--out", disk / "suite"),
        )  # fmt: skip
        typed = choices[int(random.integers(len(choices)))]
        fault = fault_of(ended(start(typed, place)), 2)
        return fault or differences(before, contents(disk))


def _clock(grounds: Path, place: Path, random: np.random.Generator) -> str:
    """Go on where files are of the future, or of long ago, and the clock is set back meanwhile."""
    shutil.copytree(grounds / "pairs", place / "pairs")
    years = float(random.choice([-60.0, -1.0, 1.0, 80.0]))
    data, store = place / "pairs" / "data", place / "pairs" / "store"
    frames = sorted((data / "frames").glob("*.png"))
    frames[int(random.integers(len(frames)))].unlink()
    for path in (place / "pairs").rglob("*"):
        then = path.stat().st_mtime + years * YEAR_S
        os.utime(path, (max(then, 0.0), max(then, 0.0)))
    typed = ("run", grounds / "cases" / "small.toml", "--out", data, "--store", store)
    set_back = int(random.integers(MOST_CLOCK_READS)), float(random.choice([10.0, YEAR_S]))
    fault = fault_of(ended(start(typed, place, set_back=set_back)), 0)
    return fault or _goes_on(typed, place, grounds, data, {})


def _one_store(grounds: Path, place: Path, random: np.random.Generator) -> str:
    """Have two to eight write into folders of their own, and one store."""
    outs = [place / f"out_{number}" for number in range(int(random.integers(2, MOST_WRITERS + 1)))]
    case = grounds / "cases" / "small.toml"
    begun = [start(("run", case, "--out", out, "--store", place / "store"), place) for out in outs]
    heard = [ended(each) for each in begun]
    whole = contents(grounds / "pairs" / "data")
    for each, out in zip(heard, outs, strict=True):
        if fault := fault_of(each, 0) or differences(whole, contents(out)):
            return fault
    return differences(contents(grounds / "pairs" / "store"), contents(place / "store"))


def _one_folder(grounds: Path, place: Path, random: np.random.Generator) -> str:
    """Have two to eight write into one folder: each ends well or with one message, and it is whole.

    Who comes second may be told that files have changed beneath it; the command then goes on.
    """
    count, case = int(random.integers(2, MOST_WRITERS + 1)), grounds / "cases" / "small.toml"
    typed = ("run", case, "--out", place / "out", "--store", place / "store")
    begun = [start(typed, place) for _ in range(count)]
    for heard in [ended(each) for each in begun]:
        if fault := fault_of(heard, 0, 2):
            return fault
    return _goes_on(typed, place, grounds, place / "out", {})


PLACES: dict[str, Callable[[Path, Path, np.random.Generator], str]] = {
    "full disk": _full_disk,
    "full store": _full_store,
    "vanished folder": _vanished_folder,
    "vanished store": _vanished_store,
    "read-only": _read_only,
    "clock": _clock,
    "writers on one store": _one_store,
    "writers in one folder": _one_folder,
}


def try_place(name: str, seed: int, grounds: Path, place: Path) -> str:
    """Try a seed; return the fault, nothing if all stood.

    Parameters
    ----------
    name : str
    seed : int
    grounds : Path
    place : Path
        Folder of the trial; made anew.

    Raises
    ------
    Skipped
        If this machine does not let us make such a place.
    """
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    return PLACES[name](grounds, place, np.random.default_rng([DRAW, seed]))


def try_places(
    names: Sequence[str],
    count: int,
    first: int,
    grounds: Path,
    scratch: Path,
    seen: Collection[tuple[str, int]],
    until: float | None,
    *,
    once: bool = False,
) -> Iterator[Tried]:
    """Try each place in turn, so many in all, and at least one; those that cannot be made are told.

    Parameters
    ----------
    names : sequence of str
    count : int
    first : int
        Seed.
    grounds, scratch : Path
    seen : collection of (str, int)
        Places and seeds that are left out.
    until : float, optional, s
        Of the monotonic clock: nothing is begun later.
    once : bool
        Only the first seed.
    """
    left, tried = list(names), 0
    for seed in [first] if once else itertools.count(first):
        for name in [each for each in left if (each, seed) not in seen]:
            late = until is not None and time.monotonic() > until
            if tried >= count or (tried and late):
                return
            began_s = processor_s()
            try:
                fault = try_place(name, seed, grounds, scratch / "place")
            except Skipped as why:
                print(f"{name}: skipped: {why}", file=sys.stderr)
                left.remove(name)
                continue
            tried += 1
            ended_as = FAULT if fault else "stood"
            yield Tried(name, seed, ended_as, fault, processor_s=processor_s() - began_s)
        if not left:
            return


def _goes_on(
    typed: tuple[object, ...], place: Path, grounds: Path, out: Path, kept: dict[str, str]
) -> str:
    """Run to the end; return what differs from who was never disturbed."""
    fault = fault_of(ended(start(typed, place)), 0)
    made = contents(out)
    whole = contents(grounds / "pairs" / "data")
    lost = [name for name, digest in kept.items() if name in whole and made.get(name) != digest]
    if not fault and lost:
        fault = f"{lost[0]} was whole and was written again, otherwise"
    return fault or differences(whole, made)


@contextmanager
def _disk(folder: Path) -> Iterator[Path]:
    """Mount a small disk of memory."""
    folder.mkdir(parents=True)
    _mount("-t", "tmpfs", "-o", f"size={ENOUGH}", "tmpfs", folder)
    try:
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", folder], check=False)


@contextmanager
def _bound(kept: Path, seen: Path) -> Iterator[Path]:
    """Have a disk at another place, too, where it can be unmounted and is not lost."""
    seen.mkdir()
    _mount("--bind", kept, seen)
    try:
        yield seen
    finally:
        while seen.is_mount():
            subprocess.run(["umount", "--lazy", seen], check=False)


def _mount(*arguments: object) -> None:
    if shutil.which("mount") is None:
        raise Skipped("no mount command")
    done = subprocess.run(
        ["mount", *map(str, arguments)], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        raise Skipped(f"no small disk can be mounted here: {done.stderr.strip()}")
