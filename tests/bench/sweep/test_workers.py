"""Processes that share work: one that is killed is told in a message, and the others end."""

import os
import signal

import pytest

from bench.sweep.workers import Workers
from models.errors import StorageError


def dies(number: int) -> int:
    if number == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def test_a_worker_that_is_lost_is_one_message():
    with Workers(2) as workers:
        for _ in range(2):  # those of before are no more when it is asked again
            with pytest.raises(StorageError, match="one was killed, perhaps for want of memory"):
                list(workers.run(dies, [(0,), (1,), (2,)]))
