"""A Dask scheduler that is there already, by its address; ``distributed`` is an extra.

Results never go through the scheduler: a task runs a command, which writes files, and hands back an
exit code. Dask forgets tasks when who handed them over leaves; what is done then stands, what runs
ends by itself, and the same command hands over the rest.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from bench.runners import dask_task
from bench.runners.job_record import JobRecord, token_path
from bench.runners.job_script import job_environment, python_command
from bench.runners.queue import Queued
from bench.runners.shared_work import SharedWork
from models.errors import RunnerError

ANSWER_S = 30.0
GONE = ("lost", "cancelled")


class DaskQueue:
    """A job's tasks.

    Parameters
    ----------
    address : str
        Of the scheduler.
    work : SharedWork
    record : JobRecord

    Raises
    ------
    RunnerError
        If ``distributed`` is not installed, the scheduler does not answer, or a worker does not see
        the folder.
    """

    def __init__(self, address: str, work: SharedWork, record: JobRecord) -> None:
        try:
            import cloudpickle
            import distributed
        except ImportError as error:
            raise RunnerError(
                f"expected the package distributed for --runner dask, got: {error}; install it "
                "beside rvbench, in its clone: .venv/bin/python -m pip install -e '.[dask]'"
            ) from error
        cloudpickle.register_pickle_by_value(dask_task)  # workers need not have rvbench
        try:
            self.client: Any = distributed.Client(address, timeout=ANSWER_S, name="rvbench")
        except (OSError, ValueError, TypeError) as error:
            raise RunnerError(
                f"expected a Dask scheduler at {address}, got: {error}; `dask scheduler` prints "
                "its address"
            ) from error
        self.address, self.work, self.record = address, work, record
        self._futures: dict[int, Any] = {}
        self._check_shared()

    def submit(self, numbers: Sequence[int]) -> tuple[str, ...]:
        """Hand chunks over; see ``Queue``."""
        place = self.work.place.absolute()
        for number in numbers:
            command = python_command(self.work.command(number))
            self._futures[number] = self.client.submit(
                dask_task.do_chunk,
                *(command, os.getcwd(), job_environment(), str(place), self.record.name, number),
                key=f"{self.record.name}-{number}-{self._rounds(number)}",
                pure=False,
                retries=0,  # ours to count: what is missing is handed over again
            )
        return ()

    def queued(self) -> Queued | None:
        """Return what is neither done nor failed; see ``Queue``."""
        states = {number: future.status for number, future in self._futures.items()}
        if self.client.status != "running" or any(state in GONE for state in states.values()):
            raise RunnerError(
                f"expected the Dask scheduler at {self.address} to live as long as its work, it is "
                "gone; all that is done is kept: start one and run the same command again"
            )
        pending = frozenset(n for n, state in states.items() if state == "pending")
        return Queued(waiting=pending, tells_which_run=False)

    def cancel(self) -> None:
        """Take back what has not begun; see ``Queue``."""
        self.client.cancel(list(self._futures.values()), force=True)

    def close(self) -> None:
        """Leave the scheduler; see ``Queue``."""
        self.client.close()

    def _rounds(self, number: int) -> int:
        return self.record.tries.get(number, 0) + (number in self._futures)

    def _check_shared(self) -> None:
        token = str(token_path(self.work.place.absolute(), self.record.name))
        workers = self.client.scheduler_info(n_workers=-1)["workers"]
        if not workers:
            return  # they may come later; a chunk that sees no folder fails
        blind = [name for name, is_seen in self.client.run(dask_task.sees, token).items()
                 if not is_seen]  # fmt: skip
        if blind:
            raise RunnerError(
                f"expected {self.work.out} to be a folder that Dask's workers share with this "
                f"machine, {blind[0]} does not see it; choose an --out that is shared"
            )
