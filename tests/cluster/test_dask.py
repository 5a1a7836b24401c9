"""Through a real Dask scheduler: the same bytes, and whatever is killed, finished work stands."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.cluster.conftest import SUITE, run, start
from tests.cluster.test_slurm import bytes_of, ended, frames, until
from tests.support.whole_runs import identities

distributed = pytest.importorskip("distributed")


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Any]:
    """Two workers of one thread each, on this machine."""
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        host="127.0.0.1",
        dashboard_address=None,
        local_directory=str(tmp_path / "scratch"),
        silence_logs=50,
    ) as own:
        yield own


def by_dask(cluster: Any) -> tuple[object, ...]:
    return "--runner", "dask", "--jobs", 4, "--scheduler", cluster.scheduler_address


def test_a_suite_is_that_of_one_machine(cluster: Any, suite_alone: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    code, said = run(*SUITE, "--out", out, *by_dask(cluster))
    assert code == 0, said
    assert bytes_of(out) == bytes_of(suite_alone)
    assert "units are done already" not in said


def test_a_worker_dies_and_its_work_goes_on_elsewhere(
    cluster: Any, spec: Path, dataset_alone: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    running = start("dataset", spec, "--out", out, *by_dask(cluster))
    until(lambda: frames(out) >= 4)
    os.kill(cluster.workers[0].pid, signal.SIGKILL)
    kept = identities(out, "[0-9]*.png")
    ended(running)
    assert kept.items() <= identities(out, "[0-9]*.png").items()
    assert bytes_of(out) == bytes_of(dataset_alone)


def test_who_handed_it_over_dies_and_the_next_hands_over_the_rest(
    cluster: Any, spec: Path, dataset_alone: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    killed = start("dataset", spec, "--out", out, *by_dask(cluster))
    until(lambda: frames(out) >= 4)
    killed.kill()
    killed.communicate()
    ended(start("dataset", spec, "--out", out, *by_dask(cluster)))
    assert bytes_of(out) == bytes_of(dataset_alone)


def test_the_scheduler_goes_and_that_is_told(cluster: Any, spec: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    running = start("dataset", spec, "--out", out, *by_dask(cluster))
    until(lambda: frames(out) >= 1)
    cluster.close()
    said = running.communicate()[0]
    assert running.returncode == 2, said
    assert "it is gone" in said


def test_a_job_that_is_cancelled_ends(cluster: Any, spec: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    running = start("dataset", spec, "--out", out, *by_dask(cluster))
    until(lambda: frames(out) >= 1)
    assert run("cancel", out)[0] == 0
    said = running.communicate()[0]
    assert running.returncode == 2, said
    assert "it was cancelled" in said


@pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning"
)  # it waits for no job
def test_a_cluster_that_is_started_by_jobs(spec: Path, dataset_alone: Path, tmp_path: Path) -> None:
    """dask-jobqueue submits the workers as jobs; here they are processes, for want of a queue."""
    local = pytest.importorskip("dask_jobqueue.local")
    out = tmp_path / "out"
    with local.LocalCluster(
        cores=1,
        processes=1,
        memory="2GB",
        scheduler_options={"dashboard_address": None, "host": "127.0.0.1"},
        local_directory=str(tmp_path / "scratch"),
    ) as cluster:
        cluster.scale(jobs=2)
        ended(start("dataset", spec, "--out", out, *by_dask(cluster)))
    assert bytes_of(out) == bytes_of(dataset_alone)
