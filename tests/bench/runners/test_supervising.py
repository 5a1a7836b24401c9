"""A job waited for: what dies is done again, what never works is told, and nothing is forgotten."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import pytest
from rich.console import Console

from bench.runners.job_record import cancelled_path, log_path, new_record, read_record
from bench.runners.supervising import TRIES, Patience, Supervision
from models.errors import RunnerError
from tests.support.pretended_cluster import PretendedQueue, do, piece_work

CHUNKS = 3


def supervised(
    out: Path, does: Callable[[int, int], None], **queue: object
) -> tuple[Supervision, PretendedQueue, io.StringIO]:
    work = piece_work(out, CHUNKS)
    pretended = PretendedQueue(does, **queue)  # type: ignore[arg-type]
    said = io.StringIO()
    own = Supervision(
        work,
        pretended,
        new_record("slurm", work),
        Console(file=said, width=200),
        Patience(),
        lambda: pretended.now_s,
        pretended.sleep,
    )
    own.submit(sorted(work.missing()))
    return own, pretended, said


def test_what_is_done_at_once_is_submitted_once(tmp_path: Path) -> None:
    own, queue, said = supervised(tmp_path, lambda number, _: do(tmp_path, number))
    own.wait()
    assert queue.submitted == [[0, 1, 2]]
    assert "pieces: 6 of 6" in said.getvalue()
    record = read_record(tmp_path / "runner")
    assert record is not None
    assert record.ids == ("1",)
    assert record.tries == {0: 1, 1: 1, 2: 1}


def test_a_chunk_that_dies_is_submitted_again_alone(tmp_path: Path) -> None:
    def dies_twice(number: int, time: int) -> None:
        if number != 1 or time > 2:
            do(tmp_path, number)

    own, queue, said = supervised(tmp_path, dies_twice)
    own.wait()
    assert queue.submitted == [[0, 1, 2], [1], [1]]
    assert "1 of 3 jobs ended without all of their work" in said.getvalue()


def test_a_chunk_that_half_works_keeps_its_half(tmp_path: Path) -> None:
    def half(number: int, time: int) -> None:
        (tmp_path / f"{number}-{time - 1}").touch()

    own, queue, _ = supervised(tmp_path, half)
    own.wait()
    assert sorted(number for each in queue.submitted for number in each) == [0, 0, 1, 1, 2, 2]


def test_a_chunk_that_never_works_is_told_with_its_log_once_the_others_are_done(
    tmp_path: Path,
) -> None:
    def never(number: int, _: int) -> None:
        if number != 1:
            do(tmp_path, number)
        log_path(tmp_path / "runner", number).write_text("all well\nno memory\n\n")

    own, queue, _ = supervised(tmp_path, never)
    with pytest.raises(RunnerError, match=r"chunk 1 of 3 .*ended 4 times .*1\.log.*: no memory"):
        own.wait()
    assert queue.submitted == [[0, 1, 2], *([[1]] * (TRIES - 1))]
    assert own.work.missing() == {1: 2}


def test_a_job_that_writes_nothing_at_all_raises_the_question_of_the_folder(tmp_path: Path) -> None:
    own, _, _ = supervised(tmp_path, lambda number, _: None)
    with pytest.raises(RunnerError, match="is the folder shared"):
        own.wait()


def test_a_cluster_that_is_silent_is_waited_for(tmp_path: Path) -> None:
    own, queue, said = supervised(tmp_path, lambda number, _: do(tmp_path, number), silent=2)
    own.wait()
    assert queue.submitted == [[0, 1, 2]]
    assert said.getvalue().count("the cluster does not answer") == 1


def test_a_folder_that_a_job_does_not_share_is_told_and_the_job_ended(tmp_path: Path) -> None:
    own, queue, _ = supervised(tmp_path, lambda number, _: None, stuck=frozenset({0}))
    with pytest.raises(RunnerError, match="choose an --out that is shared"):
        own.wait()
    assert queue.cancelled


def test_a_job_that_has_left_its_token_may_take_its_time(tmp_path: Path) -> None:
    own, queue, _ = supervised(
        tmp_path, lambda number, _: do(tmp_path, number), stuck=frozenset({0})
    )
    (tmp_path / "runner" / "started").mkdir()
    (tmp_path / "runner" / "started" / "0").write_text(f"{own.record.name} node7\n")
    sleep = queue.sleep

    def at_last(seconds: float) -> None:
        sleep(seconds)
        if queue.now_s > 2.0 * own.patience.shared_s:
            queue.stuck = frozenset()

    own.sleep = at_last
    own.wait()
    assert not queue.cancelled
    assert queue.submitted == [[0, 1, 2]]


def test_a_cancelled_job_is_not_submitted_again(tmp_path: Path) -> None:
    def cancelled(number: int, _: int) -> None:
        cancelled_path(tmp_path / "runner", own.record.name).touch()

    own, queue, _ = supervised(tmp_path, cancelled)
    with pytest.raises(RunnerError, match="it was cancelled"):
        own.wait()
    assert queue.submitted == [[0, 1, 2]]
    assert queue.cancelled
