"""A case rendered in shares: the same files as by one process, whoever did which share."""

from __future__ import annotations

from pathlib import Path

import pytest
import tomli_w

from bench.cli import main
from bench.runners.chunks import Chunk
from bench.runners.missing_files import MissingFiles
from bench.runners.options import RunnerRequest
from bench.runners.shared_case import case_work, frames_of
from models.errors import ScenarioError
from renders.scenario.scenario import RenderRequest
from tests.support.small_scenes import needs_jit
from tests.support.tumble_scenario import tumble_table

JOBS = 2


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """Return a scenario of three single images."""
    path = tmp_path / "small.toml"
    path.write_text(tomli_w.dumps(tumble_table()))
    return path


def files(folder: Path) -> dict[str, bytes]:
    """Return what a dataset holds, but for what a runner keeps in it."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.relative_to(folder).parts[0] != "runner"
    }


def test_jobs_render_what_one_process_renders(
    case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The cluster is this process, which does each job's command; one job is done twice."""
    needs_jit()
    store = ("--store", str(tmp_path / "store"))
    alone, shared = tmp_path / "alone", tmp_path / "shared"
    assert main(["render", str(case), "--out", str(alone), *store]) == 0
    missing = []

    def have_done(request, work, console) -> None:
        missing.append(work.missing())
        for number in (1, 0, 1):
            assert main(work.command(number)) == 0
            missing.append(work.missing())

    monkeypatch.setattr("bench.runners.cluster_run.have_done", have_done)
    typed = ["render", str(case), "--out", str(shared), *store, "--runner", "slurm"]
    assert main([*typed, "--jobs", str(JOBS)]) == 0
    assert missing == [{0: 2, 1: 1}, {0: 2}, {}, {}]
    assert "chunk 0/2: done, into" in capsys.readouterr().out
    assert files(shared) == files(alone)


def test_a_share_alone_is_not_the_whole(
    case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    needs_jit()
    out = tmp_path / "out"
    store = ("--store", str(tmp_path / "store"))
    assert main(["run", str(case), "--out", str(out), *store, "--chunk", "1/2"]) == 0
    assert capsys.readouterr().out == f"chunk 1/2: done, into {out}\n"
    assert [path.name for path in (out / "frames").iterdir()] == ["000002.png"]
    assert not (out / "estimates").exists()


def test_frames_that_wait_for_one_another_are_not_shared_out(tmp_path: Path) -> None:
    path = tmp_path / "metered.toml"
    path.write_text(tomli_w.dumps(tumble_table(exposure={"mode": "auto", "exposure_ms": 4.0})))
    request = RenderRequest(str(path), tmp_path / "out", store=tmp_path / "store")
    with pytest.raises(ScenarioError, match="each metered from the image before"):
        frames_of(request, Chunk(0, 2))
    with pytest.raises(ScenarioError, match="each metered from the image before"):
        case_work(request, RunnerRequest("slurm", JOBS), ())
    assert not (tmp_path / "out").exists()


def test_each_frame_is_in_one_share(case: Path, tmp_path: Path) -> None:
    request = RenderRequest(str(case), tmp_path / "out", store=tmp_path / "store")
    shares = [frames_of(request, Chunk(number, 4)) for number in range(4)]
    assert sorted(frame for own in shares for frame in own) == [0, 1, 2]


def test_what_was_there_is_not_looked_for_again(tmp_path: Path) -> None:
    one, other = tmp_path / "a" / "1", tmp_path / "b" / "2"
    missing = MissingFiles([[[one, other]], [[other]], []])
    assert missing() == {0: 1, 1: 1}
    for path in (one, other):
        path.parent.mkdir()
        path.touch()
    assert missing() == {}
    one.unlink()
    assert missing() == {}


def test_options_of_a_runner_need_one(case: Path, tmp_path: Path, capsys) -> None:
    out = str(tmp_path / "out")
    assert main(["render", str(case), "--out", out, "--jobs", "3"]) == 2
    assert "expected --jobs with --runner slurm or dask alone" in capsys.readouterr().err
    assert main(["run", str(case), "--out", out, "--runner", "dask"]) == 2
    assert "expected --scheduler tcp://HOST:PORT" in capsys.readouterr().err
