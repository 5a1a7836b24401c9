"""``score.json`` read back: whole, of the estimates that are there, or refused with what to do."""

import json
import os
import shutil
from dataclasses import replace

import pytest

from bench import api
from bench.cli import main
from bench.scoring.score import read_score
from models.dataset.estimates_file import read_estimates, write_estimates
from models.errors import DatasetError
from tests.support.synthetic_dataset import perfect_estimate, write_dataset, write_variant


@pytest.fixture(scope="module")
def scored(tmp_path_factory):
    dataset = write_dataset(tmp_path_factory.mktemp("file") / "data", frames=2, width_px=64)
    write_variant(dataset, "best", perfect_estimate)
    write_variant(dataset, "paper", perfect_estimate)
    write_variant(dataset, "best", perfect_estimate, run=1)
    api.score(dataset.folder)
    return dataset


@pytest.fixture
def folder(scored, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(scored.folder, copy)
    return copy


def rewrite(path) -> None:
    """Move one estimate by a nanometre."""
    first, *others = read_estimates(path)
    pose = first.pose.cam_from_target.perturbed([0.0, 0.0, 0.0], [1e-9, 0.0, 0.0])
    moved = replace(first, pose=replace(first.pose, cam_from_target=pose))
    write_estimates(path, [moved, *others])


@pytest.mark.parametrize(
    "change",
    [
        lambda d: rewrite(d / "estimates/best.jsonl"),
        lambda d: rewrite(d / "seeds/001/estimates/best.jsonl"),
        lambda d: (d / "estimates/best.jsonl").unlink(),
        lambda d: shutil.rmtree(d / "seeds"),
        lambda d: shutil.copytree(d / "seeds/001", d / "seeds/002"),
    ],
    ids=["run 0", "run 1", "gone", "fewer runs", "more runs"],
)
def test_a_report_of_changed_estimates_is_refused(folder, change):
    read_score(folder)
    change(folder)
    with pytest.raises(DatasetError, match=r"best's have changed since; run `rvbench score"):
        api.report(folder)


def test_a_report_without_estimates_that_came_later_is_refused(folder):
    shutil.copy(folder / "estimates/best.jsonl", folder / "estimates/mine.jsonl")
    with pytest.raises(DatasetError, match="but mine came later; run `rvbench score"):
        api.report(folder)
    api.score(folder)
    assert api.report(folder).is_file()


def paths_of(value, path=()):
    """Return the path of every key of every table, however deep."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield (*path, key)
            yield from paths_of(inner, (*path, key))
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            yield from paths_of(inner, (*path, place))


def test_a_score_that_lacks_any_key_is_refused(folder):
    """Each of them in turn: whatever a report may look up is there, or it is not a score."""
    path = folder / "score.json"
    whole = path.read_text()
    paths = list(paths_of(json.loads(whole)))
    assert len(paths) > 200
    for keys in paths:
        table = json.loads(whole)
        inner = table
        for key in keys[:-1]:
            inner = inner[key]
        del inner[keys[-1]]
        path.write_text(json.dumps(table))
        with pytest.raises(DatasetError, match=r"run `rvbench score .*` again"):
            read_score(folder)
    path.write_text(whole)
    read_score(folder)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"median"', '"medium"'),
        ('"frames": 2', '"frames": "2"'),
        ('"runs": 2', '"runs": 3'),
        ('"recall": 1.0', '"recall": 0.5'),
    ],
)
def test_a_score_that_was_edited_is_refused(folder, old, new):
    path = folder / "score.json"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(DatasetError, match="expected a whole score, but"):
        read_score(folder)


def test_another_runtime_is_no_other_score(folder):
    """Runtimes differ from machine to machine; the rest is compared without them."""
    path = folder / "score.json"
    table = json.loads(path.read_text())
    table["pipelines"]["best"]["core"]["runtime_ms"] = {"median": 3.5, "p95": 4}
    path.write_text(json.dumps(table))
    assert read_score(folder)["pipelines"]["best"]["core"]["runtime_ms"]["p95"] == 4
    table["pipelines"]["best"]["core"]["runtime_ms"] = {"median": "fast", "p95": 4}
    path.write_text(json.dumps(table))
    with pytest.raises(DatasetError, match="runtime_ms has not two numbers"):
        read_score(folder)


@pytest.mark.parametrize("instead", ["ring", "link to nothing", "folder", "pipe"])
def test_estimates_that_are_no_file_are_refused_and_not_left_out(folder, instead, capsys):
    """By the score that is made anew, and by who reads the old one."""
    path = folder / "estimates" / "best.jsonl"
    shutil.rmtree(folder / "seeds")
    path.unlink()
    if instead == "folder":
        path.mkdir()
    elif instead == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to("best.jsonl" if instead == "ring" else "nowhere")
    for verb in ("score", "report"):
        assert main([verb, str(folder)]) == 2
        message = capsys.readouterr().err
        assert str(path) in message
        assert message.count("\n") == 1
