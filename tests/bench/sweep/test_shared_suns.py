"""A sweep in shares: each job has some of the Suns, and all come to the same as one process."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from bench.cli import main
from bench.status.readers import ASKED_NAME
from tests.bench.sweep.conftest import SUNS, SmallSweep

JOBS = 2


def shots(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted((folder / "shots").iterdir())}


def test_jobs_sweep_what_one_process_sweeps(
    swept_once: SmallSweep,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The cluster is this process, which does each job's command: three Suns, two jobs."""
    out, missing = tmp_path / "out", []

    def have_done(request, work, console) -> None:
        missing.append(work.missing())
        for number in range(JOBS):
            assert main(work.command(number)) == 0
            missing.append(work.missing())
        assert len(json.loads((out / ASKED_NAME).read_text())["asked"]) == len(SUNS)

    monkeypatch.setattr("bench.runners.cluster_run.have_done", have_done)
    typed = [
        "sweep", swept_once.request.case, "--out", str(out), "--time-s", "250", "--suns", *SUNS,
        "--draws", "1", "--store", str(tmp_path / "store"),
    ]  # fmt: skip
    assert main([*typed, "--runner", "slurm", "--jobs", str(JOBS)]) == 0
    assert missing == [{0: 2, 1: 1}, {1: 1}, {}]
    assert "chunk 1/2: done, into" in capsys.readouterr().out
    assert shots(out) == shots(swept_once.out)
    assert (out / "sweep.html").is_file()
    capsys.readouterr()
    assert main([*typed, "--chunk", "0/1"]) == 0
    told = capsys.readouterr()
    assert "to trace: 0 light groups" in told.err
    assert told.out == f"chunk 0/1: done, into {out}\n"


def test_options_of_a_runner_need_one(
    swept_once: SmallSweep, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    typed = ["sweep", swept_once.request.case, "--out", str(tmp_path / "out"), "--time-s", "250"]
    assert main([*typed, "--sbatch", "time=1:00:00"]) == 2
    assert "expected --sbatch with --runner slurm alone" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
