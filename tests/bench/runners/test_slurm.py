"""SLURM's commands as they are asked, a submitter that comes back, and the script of a job."""

from __future__ import annotations

import io
import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console

from bench.cli import main
from bench.runners.cluster_run import have_done, only_submitter
from bench.runners.job_record import JobRecord, new_record, read_record, started, write_record
from bench.runners.job_script import NOT_SHARED_CODE, job_script
from bench.runners.options import RunnerRequest
from bench.runners.queue import Queued
from bench.runners.slurm_queue import SlurmQueue, ranges, sbatch_options
from bench.runners.supervising import Patience
from models.errors import DatasetError, RunnerError, ScenarioError
from tests.support.pretended_cluster import PretendedSlurm, do, piece_work

CHUNKS = 3
AT_ONCE = Patience(0.01, 0.01, 0.0, 1e9)
REQUEST = RunnerRequest("slurm", CHUNKS, 2, ("partition=short", "exclusive"))
QUIET = Console(file=io.StringIO())


@pytest.fixture
def slurm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> PretendedSlurm:
    folder = tmp_path / "bin"
    folder.mkdir()
    return PretendedSlurm(folder, monkeypatch.setenv)


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "the out"


def under_way(out: Path, slurm: PretendedSlurm) -> JobRecord:
    """Return the record of a job whose submitter was killed, with one task in the queue."""
    work = piece_work(out, CHUNKS)
    record = new_record("slurm", work).tried([0, 1, 2])
    write_record(work.place, record)
    slurm.has("17|2|R|None")
    do(out, 0), do(out, 1)
    return record


def test_numbers_are_written_as_ranges() -> None:
    assert ranges([7, 0, 1, 2, 9, 8, 4]) == "0-2,4,7-9"


def test_an_array_is_submitted_with_what_was_asked_for(out: Path, slurm: PretendedSlurm) -> None:
    work = piece_work(out, CHUNKS)
    do(out, 1)
    with pytest.raises(RunnerError, match="ended 4 times"):  # no node is there to do any of it
        have_done(REQUEST, work, QUIET, AT_ONCE)
    asked = slurm.asked_of("sbatch")
    assert len(asked) == 4
    for word in ("--array=0,2", "--cpus-per-task=2", "--partition=short", "--exclusive",
                 "--requeue", f"--output={out}/runner/logs/%a.log"):  # fmt: skip
        assert word in asked[0]
    record = read_record(work.place)
    assert record is not None
    assert record.ids == ("4711",) * 4
    assert all(f"--job-name={record.name}" in line for line in asked)


def test_nothing_is_submitted_where_nothing_is_missing(out: Path, slurm: PretendedSlurm) -> None:
    work = piece_work(out, CHUNKS)
    for number in range(CHUNKS):
        do(out, number)
    have_done(REQUEST, work, QUIET, AT_ONCE)
    assert slurm.asked == []


def test_a_submitter_that_comes_back_waits_for_its_job(out: Path, slurm: PretendedSlurm) -> None:
    """Even if it was killed before it could write down the array's number."""
    record = under_way(out, slurm)
    said = io.StringIO()
    work = piece_work(out, CHUNKS)
    look = work.missing

    def missing() -> dict[int, int]:
        if slurm.asked_of("squeue"):  # it has asked: now the job ends
            do(out, 2)
        return look()

    object.__setattr__(work, "missing", missing)
    have_done(REQUEST, work, Console(file=said, width=200), AT_ONCE)
    assert f"job {record.name} is under way" in said.getvalue()
    assert slurm.asked_of("sbatch") == []
    assert f"--name={record.name}" in slurm.asked_of("squeue")[0]


def test_a_job_of_another_command_is_not_mixed_with(out: Path, slurm: PretendedSlurm) -> None:
    under_way(out, slurm)
    with pytest.raises(RunnerError, match=r"no other job at work .* in 3 jobs; wait for it, or"):
        have_done(REQUEST, piece_work(out, CHUNKS + 1), QUIET, AT_ONCE)
    assert slurm.asked_of("sbatch") == []


def test_a_cluster_that_does_not_answer_is_given_nothing_twice(
    out: Path, slurm: PretendedSlurm
) -> None:
    under_way(out, slurm)
    slurm.turn("silent")
    with pytest.raises(RunnerError, match="nothing was submitted"):
        have_done(REQUEST, piece_work(out, CHUNKS), QUIET, AT_ONCE)
    assert slurm.asked_of("sbatch") == []


def test_two_submitters_of_one_folder_are_one_too_many(out: Path, slurm: PretendedSlurm) -> None:
    work = piece_work(out, CHUNKS)
    with only_submitter(work.place), pytest.raises(RunnerError, match="nobody else to wait"):
        have_done(REQUEST, work, QUIET, AT_ONCE)
    assert slurm.asked == []


def test_what_sbatch_says_is_told(out: Path, slurm: PretendedSlurm) -> None:
    slurm.turn("refuses")
    with pytest.raises(RunnerError, match="got: invalid partition specified"):
        have_done(REQUEST, piece_work(out, CHUNKS), QUIET, AT_ONCE)


def test_the_queue_is_read_whatever_state_its_tasks_are_in(
    tmp_path: Path, slurm: PretendedSlurm
) -> None:
    queue = SlurmQueue("rvbench-0", tmp_path / "job.sh", tmp_path)
    slurm.has("9|0|R|None", "9|1|PD|Resources", "9|2|CG|None", "9|3|F|NonZeroExitCode", "9|4|CD|")
    assert queue.queued() == Queued(frozenset({1}), frozenset({0, 2}), "Resources")
    slurm.turn("silent")
    assert queue.queued() is None


def test_where_there_is_no_slurm_that_is_told(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(RunnerError, match="expected SLURM's sbatch on the path"):
        SlurmQueue("rvbench-0", tmp_path / "job.sh", tmp_path)


@pytest.mark.parametrize("option", ["array=0-3", "--time=1", "job-name=x", "a b", "", "output=x"])
def test_options_that_are_ours_or_none_are_refused(option: str) -> None:
    with pytest.raises(ScenarioError, match="expected --sbatch"):
        sbatch_options([option])


def test_cancelling_asks_slurm_and_leaves_word(
    out: Path, slurm: PretendedSlurm, capsys: pytest.CaptureFixture[str]
) -> None:
    record = under_way(out, slurm)
    assert main(["cancel", str(out)]) == 0
    assert record.name in capsys.readouterr().out
    assert slurm.asked_of("scancel") == [f"scancel --name={record.name}"]
    assert (out / "runner" / f"{record.name}.cancelled").exists()


def test_where_nothing_was_submitted_nothing_is_cancelled(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["cancel", str(tmp_path)]) == 2
    assert "has no job" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"format": "rvbench-job", "version": 1, "name": "x; rm -r"}']
)
def test_a_record_that_is_none_is_told(tmp_path: Path, text: str) -> None:
    (tmp_path / "job.json").write_text(text)
    with pytest.raises(DatasetError, match=r"job\.json: expected the job that was submitted last"):
        read_record(tmp_path)


def run_script(out: Path, monkeypatch: pytest.MonkeyPatch) -> subprocess.CompletedProcess[str]:
    """Run a job's script with an ``echo`` for a Python."""
    work = piece_work(out, CHUNKS)
    monkeypatch.setattr(sys, "executable", "/bin/echo")
    script = out / "runner" / "job.sh"
    script.write_text(job_script(work, "rvbench-abc"))
    return subprocess.run(
        ["/bin/sh", str(script)],
        env={"SLURM_ARRAY_TASK_ID": "2", "PATH": "/bin:/usr/bin"},
        capture_output=True,
        text=True,
        check=False,
    )


def test_a_job_runs_its_share_of_the_same_command_and_leaves_its_token(
    out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = JobRecord("rvbench-abc", "slurm", ("suite", "mine"), CHUNKS)
    write_record(out / "runner", record)
    done = run_script(out, monkeypatch)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "-P -m bench suite mine --chunk 2/3\n"
    assert started(out / "runner", record) == {2}


def test_a_job_that_sees_another_folder_does_nothing(
    out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = run_script(out, monkeypatch)
    assert done.returncode == NOT_SHARED_CODE
    assert "found it not shared" in done.stderr
    assert not (out / "runner" / "started").exists()
