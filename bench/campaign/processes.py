"""Verbs in processes of their own, to be killed, and folders to be compared."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from bench.campaign.hostile.verdict import Heard, fault_of_message

PROGRAM = "import sys; from bench.cli import main; sys.exit(main())"
STRUCK = """
import os, pathlib, signal, sys
number, befalls, rename = int(sys.argv.pop(1)), sys.argv.pop(1), pathlib.Path.replace
def replace(scratch, place):
    global number
    number -= 1
    if number < 0 and not befalls:
        os.killpg(0, signal.SIGKILL)
    renamed = rename(scratch, place)
    if number == -1 and befalls:
        os.system(befalls)
    return renamed
pathlib.Path.replace = replace
"""
COUNTED = """
import pathlib, sys, time
count, rename = open(sys.argv.pop(1), "w", buffering=1), pathlib.Path.replace
def replace(scratch, place):
    print(repr(time.monotonic()), file=count)
    return rename(scratch, place)
pathlib.Path.replace = replace
"""
SET_BACK = """
import sys, time
reads, seconds, clock = int(sys.argv.pop(1)), float(sys.argv.pop(1)), time.time
def set_back():
    global reads
    reads -= 1
    return clock() - (seconds if reads < 0 else 0.0)
time.time = set_back
"""
WORKER = b"multiprocessing.spawn"
TIME_LIMIT_S = 3600.0  # a machine may be slow; a process that waits for nothing is the tests' work
NEVER_THE_SAME = (
    "*.html", "*.runtime.csv", "*.seconds.json", "claims/*.json", "made", "*.part",
)  # fmt: skip
KEYS_NEVER_THE_SAME = frozenset({"runtime_ms", "store", "seconds", "frame_ms"})


def start(
    typed: Sequence[object],
    cwd: Path,
    env: Mapping[str, str] | None = None,
    struck: int = -1,
    befalls: str = "",
    set_back: tuple[int, float] | None = None,
    counted: Path | None = None,
) -> subprocess.Popen[str]:
    """Start a verb in a process group of its own.

    Parameters
    ----------
    typed : sequence
    cwd : Path
    env : mapping, optional
        Variables beside this process's.
    struck : int
        Files that get their names before the whole group is killed, just before the next one does;
        below zero for never.
    befalls : str
        What a shell does instead of the kill, once that next one has its name.
    set_back : (int, float), optional
        How often the clock is read before it is set back, and by how many seconds.
    counted : Path, optional
        File that takes the instants of the monotonic clock at which files got their names from this
        process, not from its workers, a line each, s.
    """
    program, words = PROGRAM, list[str]()
    if counted is not None:
        program, words = COUNTED + program, [str(counted)]
    if struck >= 0:
        program, words = STRUCK + program, [str(struck), befalls]
    if set_back is not None:
        program, words = SET_BACK + program, [*map(str, set_back), *words]
    return subprocess.Popen(
        [sys.executable, "-P", "-c", program, *words, *map(str, typed)],
        cwd=cwd,
        env={**os.environ, **(env or {})},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def ended(process: subprocess.Popen[str], limit_s: float = TIME_LIMIT_S) -> Heard:
    """Wait for a verb to end; kill its group where it does not."""
    try:
        _, errors = process.communicate(timeout=limit_s)
    except subprocess.TimeoutExpired:
        kill_group(process)
        process.communicate()
        return Heard(None, "", f"hangs: not done after {limit_s:g} s")
    return Heard(process.returncode, errors)


def processor_s() -> float:
    """Return the processor time of this process and of those that it has waited for, s."""
    return sum(os.times()[:4])


def kill_group(process: subprocess.Popen[str]) -> None:
    """Kill a verb and whatever it started."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def kill_one_of(process: subprocess.Popen[str], share: float) -> bool:
    """Kill one of the workers that a verb started, alone; tell whether there was one.

    Parameters
    ----------
    process : Popen
    share : float
        Which of them, in the order of their numbers. What Python starts to mind what processes
        share is none: it says by itself that it was killed.
    """
    own = sorted(
        int(path.name)
        for path in Path("/proc").glob("[0-9]*")
        if (words := words_of(path)) and int(words[1]) == process.pid and _works(path)
    )
    if own and process.poll() is None:
        with suppress(ProcessLookupError):
            os.kill(own[int(share * len(own))], signal.SIGKILL)
            return True
    return False


def _works(process: Path) -> bool:
    try:
        return WORKER in (process / "cmdline").read_bytes()
    except OSError:
        return False


def words_of(process: Path) -> list[str]:
    """Return what the system says of a process, from its state on; nothing once it is over."""
    try:
        return (process / "stat").read_text().rpartition(")")[2].split()
    except OSError:
        return []


def fault_of(heard: Heard, *codes: int) -> str:
    """Return what is wrong with how a verb ended; nothing if it is one of the codes that may be."""
    if heard.escaped:
        return heard.escaped
    if "Traceback (most recent call last)" in heard.errors:
        return f"traceback: {heard.errors[-600:]}"
    if heard.code not in codes:
        return f"exit code {heard.code}: {heard.errors[-600:]}"
    return fault_of_message(heard)


def contents(folder: Path) -> dict[str, str]:
    """Return a hash of every file below a folder: runtimes, and what names folders, apart."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(_lasting(path)).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not any(path.match(each) for each in NEVER_THE_SAME)
    }


def differences(one: Mapping[str, str], other: Mapping[str, str]) -> str:
    """Return what of two folders differs, in words; nothing if nothing does."""
    told = [
        *(f"{name} is missing" for name in sorted(set(one) - set(other))),
        *(f"{name} is more" for name in sorted(set(other) - set(one))),
        *(f"{name} differs" for name in sorted(set(one) & set(other)) if one[name] != other[name]),
    ]
    return ", ".join(told[:4])


def _lasting(path: Path) -> bytes:
    if path.suffix != ".json":
        return path.read_bytes()
    try:
        return json.dumps(_without(json.loads(path.read_bytes())), sort_keys=True).encode()
    except ValueError:
        return path.read_bytes()


def _without(value: Any) -> Any:
    if isinstance(value, list):
        return [_without(each) for each in value]
    if not isinstance(value, dict):
        return value
    return {key: _without(item) for key, item in value.items() if key not in KEYS_NEVER_THE_SAME}
