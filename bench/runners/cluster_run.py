"""Have a command's work done on a cluster: find its job or submit one, then wait for it."""

from __future__ import annotations

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console

from bench.runners.job_record import (
    JobRecord,
    cancelled_path,
    new_record,
    read_record,
    write_record,
)
from bench.runners.job_script import job_script
from bench.runners.options import RunnerRequest
from bench.runners.queue import Queue
from bench.runners.shared_work import SharedWork
from bench.runners.slurm_queue import SlurmQueue
from bench.runners.supervising import Patience, Supervision
from models.atomic_file import write_text
from models.errors import RunnerError


def have_done(
    request: RunnerRequest,
    work: SharedWork,
    console: Console,
    patience: Patience | None = None,
) -> None:
    """Have done what is missing, and return once it is there.

    A job that is under way in the folder is waited for instead of submitting another.

    Parameters
    ----------
    request : RunnerRequest
    work : SharedWork
    console : Console
    patience : Patience, optional

    Raises
    ------
    RunnerError, StorageError
        Each says what to do; nothing already done is lost.
    """
    (work.place / "logs").mkdir(parents=True, exist_ok=True)
    with only_submitter(work.place):
        _have_done(request, work, console, patience)


def _have_done(
    request: RunnerRequest, work: SharedWork, console: Console, patience: Patience | None
) -> None:
    missing = work.missing()
    found = read_record(work.place)
    under_way = found is not None and _is_under_way(request, work, found)
    if not missing and not under_way:
        return
    if found is not None and under_way:
        if found.command != work.arguments or found.chunks != work.chunks:
            raise RunnerError(
                f"expected no other job at work in {work.out}, found {found.name} of the command "
                f"`rvbench {' '.join(found.command)}` in {found.chunks} jobs; wait for it, or "
                f"`rvbench cancel {work.out}`"
            )
        record, again = found, []
        console.print(f"job {_named(record)} is under way; waiting for it", soft_wrap=True)
    else:
        record, again = new_record(request.runner, work), sorted(missing)
    if again:
        write_record(work.place, record)
        _forget_tokens(work.place, record)
    queue = queue_of(request, work, record)
    own = Supervision(work, queue, record, console, patience or Patience())
    try:
        _submit_and_wait(own, request.runner, again, sum(missing.values()))
    finally:
        queue.close()


def _submit_and_wait(own: Supervision, runner: str, again: list[int], missing: int) -> None:
    work, console = own.work, own.console
    if again:
        own.submit(again)
        console.print(
            f"submitted {len(again)} jobs to SLURM as {_named(own.record)}; {missing} of "
            f"{work.pieces} {work.noun} are missing. This command may be stopped: the jobs go on, "
            "and the same command waits for them again"
            if runner == "slurm"
            else f"handed {len(again)} jobs to Dask; {missing} of {work.pieces} {work.noun} are "
            "missing",
            soft_wrap=True,
        )
    own.wait()


@contextmanager
def only_submitter(place: Path) -> Iterator[None]:
    """Refuse a second submitter of a folder, who would submit again what the first does.

    Raises
    ------
    RunnerError
        If there is another; where the disk knows no locks, it is not seen.
    """
    with (place / "submitter").open("w") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise RunnerError(
                f"expected nobody else to wait for the jobs of {place.parent}, another process "
                "does; let it, or end it and run the same command again"
            ) from error
        except OSError:
            pass
        yield


def queue_of(request: RunnerRequest, work: SharedWork, record: JobRecord) -> Queue:
    """Return the cluster as a job sees it.

    Parameters
    ----------
    request : RunnerRequest
    work : SharedWork
    record : JobRecord

    Raises
    ------
    RunnerError
        If there is none, or what it takes is not installed.
    """
    if request.runner == "slurm":
        script = work.place.absolute() / "job.sh"
        write_text(script, job_script(work, record.name))
        logs = work.place.absolute() / "logs"
        return SlurmQueue(record.name, script, logs, request.workers, request.sbatch)
    from bench.runners.dask_queue import DaskQueue

    return DaskQueue(request.scheduler, work, record)


def cancel(out: Path) -> JobRecord | None:
    """Cancel the job that was submitted last in a folder; return it, None if there was none.

    Raises
    ------
    RunnerError, DatasetError
        If it cannot be cancelled, or what is there is not ours.
    """
    place = out / "runner"
    record = read_record(place)
    if record is None:
        return None
    write_text(cancelled_path(place, record.name), "")  # which jobs of Dask look for
    if record.runner == "slurm":
        SlurmQueue(record.name, place / "job.sh", place / "logs").cancel()
    return record


def _is_under_way(request: RunnerRequest, work: SharedWork, record: JobRecord) -> bool:
    """Tell whether a job that was submitted before is still queued; one of Dask never is."""
    if record.runner != "slurm":
        return False
    place = work.place.absolute()
    queued = SlurmQueue(record.name, place / "job.sh", place / "logs").queued()
    if queued is None:
        raise RunnerError(
            f"expected the cluster to tell whether job {_named(record)} is still at work, got no "
            "answer; nothing was submitted: run the same command again once squeue answers"
        )
    return bool(queued.active)


def _forget_tokens(place: Path, record: JobRecord) -> None:
    """Delete what earlier jobs left behind."""
    for path in place.glob("rvbench-*.token"):
        if path.name != f"{record.name}.token":
            path.unlink(missing_ok=True)


def _named(record: JobRecord) -> str:
    return f"{record.name} ({', '.join(record.ids)})" if record.ids else record.name
