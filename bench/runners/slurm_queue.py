"""SLURM by its own commands: ``sbatch`` an array, ``squeue`` it by name, ``scancel`` it.

The queue is asked for the job's name, not its number: a submitter that was killed before it could
write the number down finds its job all the same, and a job that has left the queue is no error.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from bench.runners.queue import Queued
from models.errors import RunnerError, ScenarioError
from models.reading.shown import shown

SLURM_S = 120.0  # after which a controller is taken not to answer
FORMAT = "%F|%K|%t|%r"  # array, task, state, reason
ENDED = {"CD", "CA", "F", "TO", "NF", "OOM", "BF", "DL", "PR", "SE"}
OPTION = re.compile(r"([a-z][a-z0-9-]*)(=[^\x00-\x1f]*)?")
OURS = {"array", "job-name", "output", "parsable", "open-mode", "cpus-per-task", "wrap"}
AT_WORK = {"R", "CG", "S", "ST", "SO", "RS"}


class SlurmQueue:
    """A job's arrays.

    Parameters
    ----------
    name : str
        Of the job.
    script : Path
        What each task runs.
    logs : Path
        Folder of what they say; it is there.
    cores : int
        Of a task.
    options : sequence of str
        More options of sbatch, without dashes.

    Raises
    ------
    RunnerError
        If there is no SLURM here.
    ScenarioError
        If one of the options is none, or ours to choose.
    """

    def __init__(
        self, name: str, script: Path, logs: Path, cores: int = 1, options: Sequence[str] = ()
    ) -> None:
        self.name, self.script, self.logs, self.cores = name, script, logs, cores
        self.options = sbatch_options(options)
        if shutil.which("sbatch") is None:
            raise RunnerError(
                "expected SLURM's sbatch on the path, found none; submit from one of the cluster's "
                "own machines, or choose another --runner"
            )

    def submit(self, numbers: Sequence[int]) -> tuple[str, ...]:
        """Submit an array of some chunks; see ``Queue``."""
        done = _said(
            [
                "sbatch",
                "--parsable",
                f"--job-name={self.name}",
                f"--array={ranges(numbers)}",
                f"--cpus-per-task={self.cores}",
                f"--output={self.logs}/%a.log",
                "--open-mode=append",
                "--requeue",
                *self.options,
                str(self.script),
            ]
        )
        number = done.stdout.strip().split(";")[0]
        if done.returncode or not number.isdecimal():
            raise RunnerError(
                f"expected sbatch to take the job, got: {_words(done)}; its other options come by "
                "--sbatch or by SBATCH_ variables, and everything done so far is kept"
            )
        return (number,)

    def queued(self) -> Queued | None:
        """Return what squeue tells; see ``Queue``."""
        done = _said(
            ["squeue", "--noheader", "--array", f"--name={self.name}", f"--format={FORMAT}"]
        )
        if done.returncode:
            return None
        waiting, running, why = set(), set(), ""
        for line in done.stdout.splitlines():
            _, _, rest = line.strip().partition("|")
            task, _, rest = rest.partition("|")
            state, _, reason = rest.partition("|")
            if not task.isdecimal() or state in ENDED:
                continue
            if state in AT_WORK:
                running.add(int(task))
            else:
                waiting.add(int(task))
                why = reason if reason not in ("None", "") else why
        return Queued(frozenset(waiting), frozenset(running), why)

    def cancel(self) -> None:
        """Cancel all arrays of the name; see ``Queue``."""
        done = _said(["scancel", f"--name={self.name}"])
        if done.returncode:
            raise RunnerError(f"expected scancel to take {self.name}, got: {_words(done)}")

    def close(self) -> None:
        """Do nothing: SLURM keeps no line open; see ``Queue``."""


def sbatch_options(typed: Sequence[str]) -> list[str]:
    """Return options of sbatch with their dashes.

    Parameters
    ----------
    typed : sequence of str
        Each ``key=value``, or ``key`` alone.

    Raises
    ------
    ScenarioError
        If one is none, or ours to choose.
    """
    for option in typed:
        found = OPTION.fullmatch(option)
        if found is None:
            raise ScenarioError(
                "expected --sbatch as options of sbatch without their dashes, such as "
                f"time=2:00:00, got {shown(option)}"
            )
        if found[1] in OURS:
            raise ScenarioError(
                f"expected --sbatch without {found[1]}, which is chosen here; leave it out"
            )
    return [f"--{option}" for option in typed]


def ranges(numbers: Sequence[int]) -> str:
    """Return numbers as SLURM writes them: ``0-3,7``."""
    runs: list[list[int]] = []
    for number in sorted(set(numbers)):
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return ",".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)


def _said(command: list[str]) -> subprocess.CompletedProcess[str]:
    try:
        return subprocess.run(
            command,
            capture_output=True,
            text=True,
            check=False,
            timeout=SLURM_S,
            stdin=subprocess.DEVNULL,
            env={**os.environ, "SLURM_TIME_FORMAT": "standard"},
        )
    except (subprocess.TimeoutExpired, OSError) as error:
        return subprocess.CompletedProcess(command, 1, "", str(error))


def _words(done: subprocess.CompletedProcess[str]) -> str:
    lines = (done.stderr.strip() or done.stdout.strip() or "nothing").splitlines()
    return lines[-1].removeprefix("sbatch: ").removeprefix("error: ")
