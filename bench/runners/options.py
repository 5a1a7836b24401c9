"""The options that send a verb's work elsewhere, and what they may be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, Protocol

from tyro.conf import arg

from bench.runners.chunks import MOST_CHUNKS, Chunk, read_chunk
from models.errors import ScenarioError
from models.reading.options import check_option

JOBS = 16
NAMES = ("runner", "jobs", "sbatch", "scheduler", "chunk")

RunnerName = Annotated[
    Literal["local", "slurm", "dask"],
    arg(
        help="who does the work: processes of this machine, an array of SLURM jobs, or the workers "
        "of a Dask scheduler. The folder must be shared with them; see docs/clusters.md"
    ),
]
JOBS_HELP = f"with slurm or dask, into how many jobs the work is cut ({JOBS}); each takes "
Jobs = Annotated[
    int | None,
    arg(
        metavar="N",
        help_behavior_hint="",
        help=f"{JOBS_HELP}--workers cores, one unless given",
    ),
]
JobsOfFrames = Annotated[
    int | None,
    arg(
        metavar="N",
        help_behavior_hint="",
        help=f"{JOBS_HELP}--threads cores, one unless given",
    ),
]
Sbatch = Annotated[
    tuple[str, ...],
    arg(
        metavar="KEY=VALUE ...",
        help_behavior_hint="",
        help="with slurm, options of sbatch without their dashes: partition=short time=2:00:00",
    ),
]
SchedulerAddress = Annotated[
    str | None,
    arg(
        metavar="tcp://HOST:PORT",
        help_behavior_hint="",
        help="with dask, the address of its scheduler",
    ),
]
ChunkText = Annotated[
    str | None,
    arg(
        metavar="K/N",
        help_behavior_hint="",
        help="do share K of N, K from 0, and leave what is made of all shares to the command "
        "without --chunk: what a job does, and a way to use any other scheduler",
    ),
]


@dataclass(frozen=True)
class RunnerRequest:
    """Who does the work, and in how many jobs.

    Attributes
    ----------
    runner : str
        slurm or dask.
    jobs : int
    workers : int
        Cores of each.
    sbatch : tuple of str
        More options of sbatch, without dashes.
    scheduler : str
        Dask's address; empty with slurm.
    """

    runner: Literal["slurm", "dask"]
    jobs: int
    workers: int = 1
    sbatch: tuple[str, ...] = ()
    scheduler: str = ""


class RunnerOptions(Protocol):
    """What a verb has that may send its work elsewhere, each as it was typed."""

    @property
    def runner(self) -> Literal["local", "slurm", "dask"]:
        """Who does the work."""

    @property
    def jobs(self) -> int | None:
        """Into how many jobs it is cut."""

    @property
    def sbatch(self) -> tuple[str, ...]:
        """More options of sbatch."""

    @property
    def scheduler(self) -> str | None:
        """Dask's address."""

    @property
    def chunk(self) -> str | None:
        """A share to be done here."""


def is_shared(verb: RunnerOptions) -> bool:
    """Tell whether any of it was typed: else nothing of runners is loaded."""
    return (verb.runner, verb.jobs, verb.sbatch, verb.scheduler, verb.chunk) != (
        "local", None, (), None, None,
    )  # fmt: skip


def asked_of(verb: RunnerOptions, cores: int | None) -> tuple[RunnerRequest | None, Chunk | None]:
    """Return who is to do a verb's work, None if this process, and the share that it is to do.

    Parameters
    ----------
    verb : RunnerOptions
    cores : int or None
        Of each job, as typed.

    Raises
    ------
    ScenarioError
        If options do not go together, or one is out of its range.
    """
    chunk = None if verb.chunk is None else read_chunk(verb.chunk)
    request = runner_request(verb.runner, verb.jobs, cores, verb.sbatch, verb.scheduler, verb.chunk)
    return request, chunk


def runner_request(
    runner: Literal["local", "slurm", "dask"],
    jobs: int | None,
    workers: int | None,
    sbatch: tuple[str, ...],
    scheduler: str | None,
    chunk: str | None,
) -> RunnerRequest | None:
    """Return what was asked; None where this process is to do the work.

    Parameters
    ----------
    runner : str
        local, slurm or dask.
    jobs : int or None
    workers : int or None
    sbatch : tuple of str
    scheduler : str or None
    chunk : str or None
        Each as it was typed.

    Raises
    ------
    ScenarioError
        If options do not go together, or one is out of its range.
    """
    given = {"--jobs": jobs, "--sbatch": sbatch or None, "--scheduler": scheduler}
    allowed = {"local": (), "slurm": ("--jobs", "--sbatch"), "dask": ("--jobs", "--scheduler")}
    for name, value in given.items():
        if value is not None and name not in allowed[runner]:
            owner = {"--sbatch": "slurm", "--scheduler": "dask"}.get(name, "slurm or dask")
            raise ScenarioError(
                f"expected {name} with --runner {owner} alone, got it with {runner}"
            )
    if runner == "local":
        return None
    if chunk is not None:
        raise ScenarioError(
            f"expected either --runner {runner} or --chunk, got both: a share is done where it is "
            "asked for"
        )
    if runner == "dask" and scheduler is None:
        raise ScenarioError(
            "expected --scheduler tcp://HOST:PORT with --runner dask, got none; `dask scheduler` "
            "prints it"
        )
    check_option("--jobs", jobs, 1, MOST_CHUNKS, whole=True)
    return RunnerRequest(runner, jobs or JOBS, workers or 1, sbatch, scheduler or "")
