"""Through a real SLURM: the bytes of one machine, and whatever is killed, finished work stands."""

from __future__ import annotations

import time
from pathlib import Path

from bench.runners.job_record import read_record
from tests.cluster.conftest import CASE, SUITE, SWEEP, run, start
from tests.cluster.small_slurm import SmallSlurm
from tests.support.patience import HANGS_S
from tests.support.whole_runs import contents, identities

SLURM = ("--runner", "slurm", "--jobs", 4, "--sbatch", "time=60")
TIMES = "seconds.json"


def bytes_of(out: Path) -> dict[str, str]:
    """Return a hash of each file but times, which no two runs have alike, and the runner's."""
    return {
        name: value
        for name, value in contents(out).items()
        if not name.startswith("runner/") and not name.endswith(TIMES)
    }


def until(is_so) -> None:
    give_up_s = time.monotonic() + HANGS_S
    while not is_so() and time.monotonic() < give_up_s:
        time.sleep(0.1)


def frames(out: Path) -> int:
    return len(list(out.glob("*/frames/*.png")))


def ended(process) -> str:
    said = process.communicate(timeout=HANGS_S)[0]
    assert process.returncode == 0, said
    return said


def arrays(out: Path) -> tuple[str, ...]:
    record = read_record(out / "runner")
    return record.ids if record is not None else ()


def test_a_suite_is_that_of_one_machine(slurm: SmallSlurm, suite_alone: Path, tmp_path) -> None:
    out = tmp_path / "out"
    code, said = run(*SUITE, "--out", out, *SLURM, environment=slurm.environment)
    assert code == 0, said
    assert bytes_of(out) == bytes_of(suite_alone)
    assert len(list((out / "runner" / "started").iterdir())) == 4
    assert "units are done already" not in said  # here: the jobs did them all


def test_a_sweep_of_188_suns_is_that_of_one_machine(
    slurm: SmallSlurm, sweep_alone: Path, tmp_path: Path
) -> None:
    out, store = tmp_path / "out", ("--store", tmp_path / "store")
    code, said = run(*SWEEP, "--out", out, *store, *SLURM, environment=slurm.environment)
    assert code == 0, said
    assert "to trace: 0 light groups" in said  # here: the jobs did them all
    assert bytes_of(out) == bytes_of(sweep_alone)


def test_a_case_is_that_of_one_machine(slurm: SmallSlurm, case_alone: Path, tmp_path: Path) -> None:
    out, store = tmp_path / "out", ("--store", tmp_path / "store")
    code, said = run(*CASE, "--out", out, *store, *SLURM, environment=slurm.environment)
    assert code == 0, said
    assert bytes_of(out) == bytes_of(case_alone)


def test_a_node_dies_and_its_work_goes_on_elsewhere(
    slurm: SmallSlurm, spec: Path, dataset_alone: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    running = start("dataset", spec, "--out", out, *SLURM, environment=slurm.environment)
    until(lambda: frames(out) >= 4 and slurm.runs("node2"))
    slurm.kill_node("node2")
    kept = identities(out, "[0-9]*.png")
    assert len(kept) >= 4
    said = ended(running)
    assert kept.items() <= identities(out, "[0-9]*.png").items(), said
    assert bytes_of(out) == bytes_of(dataset_alone)
    slurm.start_node("node2")
    slurm.wait_for(lambda: slurm.states()["node2"] == "idle")


def test_the_submitter_dies_and_the_next_waits_for_the_same_jobs(
    slurm: SmallSlurm, spec: Path, dataset_alone: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    command = ("dataset", spec, "--out", out, *SLURM)
    killed = start(*command, environment=slurm.environment)
    until(lambda: frames(out) >= 1)
    killed.kill()
    killed.communicate()
    before = frames(out)
    until(lambda: frames(out) > before)  # nobody waits, and it goes on
    said = ended(start(*command, environment=slurm.environment))
    assert "is under way; waiting for it" in said
    assert len(arrays(out)) == 1, said
    assert bytes_of(out) == bytes_of(dataset_alone)


def test_the_scheduler_dies_and_is_waited_for(
    slurm: SmallSlurm, spec: Path, dataset_alone: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    running = start("dataset", spec, "--out", out, *SLURM, environment=slurm.environment)
    until(lambda: frames(out) >= 1)
    slurm.kill_scheduler()
    time.sleep(5.0)
    slurm.start_scheduler()
    ended(running)
    assert bytes_of(out) == bytes_of(dataset_alone)


def test_jobs_that_are_cancelled_end_and_the_rest_can_be_asked_for_again(
    slurm: SmallSlurm, spec: Path, dataset_alone: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    command = ("dataset", spec, "--out", out, *SLURM)
    running = start(*command, environment=slurm.environment)
    until(lambda: frames(out) >= 1)
    code, said = run("cancel", out, environment=slurm.environment)
    assert code == 0, said
    assert "it was cancelled" in running.communicate(timeout=HANGS_S)[0]
    assert running.returncode == 2
    slurm.wait_for(lambda: not slurm.ask("squeue", "--noheader"))
    kept = identities(out, "[0-9]*.png")
    assert 0 < frames(out) < 48
    ended(start(*command, environment=slurm.environment))
    assert kept.items() <= identities(out, "[0-9]*.png").items()
    assert bytes_of(out) == bytes_of(dataset_alone)


def test_a_job_that_cannot_work_is_told_with_its_log(
    slurm: SmallSlurm, spec: Path, tmp_path: Path
) -> None:
    """A dataset that was damaged since: every job refuses it."""
    out = tmp_path / "out"
    running = start(
        "dataset", spec, "--out", out, "--runner", "slurm", "--jobs", 1,
        environment=slurm.environment,
    )  # fmt: skip
    until(lambda: (out / "runner" / "job.sh").exists())
    broken = out / "hispasat-wide" / "dataset.json"
    until(broken.exists)
    broken.write_text("{}")  # which every job will refuse
    said = running.communicate(timeout=HANGS_S)[0]
    assert running.returncode == 2, said
    assert "its job ended 4 times without; its log is" in said
    assert "dataset.json" in said
