"""``rvbench status`` counts what is there of each kind of folder, and tells who runs and failed."""

from __future__ import annotations

import json
import shutil

import pytest

from bench.cli import main
from bench.status.readers import status_of
from bench.suites.folder import begin
from bench.suites.spread import do_units
from bench.suites.units import outcome_path
from models.at_work import at_work
from models.errors import DatasetError, StorageError
from tests.support.suite_work import draw_units

EXPOSURES = 8  # 4 pairs
UNITS = 3


@pytest.fixture
def folder(scored_dataset, tmp_path):
    return shutil.copytree(scored_dataset.folder, tmp_path / "data")


def stages(status):
    return {stage.name: (stage.done, stage.of) for stage in status.stages}


def test_a_whole_run_is_done(folder):
    status = status_of(folder)
    assert (status.kind, status.state, status.running) == ("dataset", "done", False)
    assert stages(status)["exposures"] == (EXPOSURES, EXPOSURES)


def test_what_is_missing_is_named_and_its_run_stopped(folder):
    (folder / "frames" / "000002_850.png").unlink()
    (folder / "score.json").unlink()
    status = status_of(folder)
    assert status.state == "stopped"
    assert stages(status)["exposures"] == (EXPOSURES - 1, EXPOSURES)
    assert status.stages[0].left == ("frames/000002_850.png",)
    assert stages(status)["score"] == (0, 1)


def test_who_is_at_work_is_told(folder):
    with at_work(folder, "run"):
        assert status_of(folder).state == "running"
    assert status_of(folder).state == "done"


def test_why_the_last_command_failed_is_told(folder, capsys):
    (folder / "frames" / "000000_850.png").unlink()
    with pytest.raises(StorageError), at_work(folder, "render"):
        raise StorageError("expected to write x, got: No space left on device")
    assert main(["status", str(folder)]) == 0
    told = capsys.readouterr().out
    assert ": failed\n" in told
    assert "failed: render: expected to write x, got: No space left on device\n" in told


def test_json_says_the_same(folder, capsys):
    assert main(["status", str(folder), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["state"] == "done"
    assert told["stages"][0] == {
        "name": "exposures", "done": EXPOSURES, "of": EXPOSURES, "left": [], "needed": True,
        "is_done": True,
    }  # fmt: skip


def test_units_of_a_suite_are_counted_by_those_asked_for(tmp_path):
    begin(tmp_path, "small")
    units = draw_units(UNITS)
    do_units(units, tmp_path / "units", 1)
    status = status_of(tmp_path)
    assert (status.kind, status.name, status.state) == ("suite", "small", "stopped")  # no tables
    assert stages(status) == {"units": (UNITS, UNITS), "tables": (0, 1)}
    (tmp_path / "suite.json").write_text("{}")
    assert status_of(tmp_path).state == "done"
    outcome_path(tmp_path / "units", units[1]).unlink()
    assert status_of(tmp_path).stages[0].left == (units[1].name,)


def test_an_export_that_was_stopped_is_counted_by_its_records(tmp_path):
    mark = {"as": "coco", "datasets": [{"frames": 3}], "complete": False}
    (tmp_path / "export.json").write_text(json.dumps(mark))
    records = tmp_path / ".rvbench-export" / "records" / "0000"
    records.mkdir(parents=True)
    for name in ("000001_000000_image_800", "000001_000000_image_850", "000001_000002_image_800"):
        (records / f"{name}.json").write_text("{}")
    status = status_of(tmp_path)
    assert (status.state, stages(status)["frames"]) == ("stopped", (2, 3))


def test_a_sweep_knows_its_shots(tmp_path):
    (tmp_path / "truth").mkdir()
    (tmp_path / "truth" / "scenario.toml").write_text('name = "mine"\n')
    (tmp_path / "shots").mkdir()
    (tmp_path / "shots" / "aa.json").write_text("{}")
    (tmp_path / "asked.json").write_text('{"asked": ["aa", "bb"]}')
    status = status_of(tmp_path)
    assert (status.kind, status.name, stages(status)["shots"]) == ("sweep", "mine", (1, 2))
    (tmp_path / "asked.json").unlink()  # of an earlier version
    for name in ("csv", "json", "html"):
        (tmp_path / f"sweep.{name}").write_text("")
    assert status_of(tmp_path).state == "done"


def test_frames_of_a_random_dataset_that_have_not_begun_are_left(tmp_path):
    (tmp_path / "random_dataset.json").write_text('{"spec": {"name": "few"}}')
    rows = ["number,folder,frame,pose,split", "0,xmm-wide,0,0,train", "1,xmm-wide,1,0,train"]
    (tmp_path / "index.csv").write_text("\n".join(rows) + "\n")
    status = status_of(tmp_path)
    assert (status.name, status.state, stages(status)["xmm-wide"]) == ("few", "stopped", (0, 2))


@pytest.mark.parametrize("make", [lambda path: None, lambda path: path.mkdir()])
def test_a_folder_of_others_is_refused(tmp_path, make):
    make(tmp_path / "theirs")
    with pytest.raises(DatasetError, match="expected a folder"):
        status_of(tmp_path / "theirs")
