"""No verb writes into what it did not make: every file of the user's stays, to the byte."""

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest
from rich.console import Console

from bench.cli import main
from bench.suites.catalogue import suite_by_name
from bench.suites.folder import begin
from bench.suites.request import SuiteRequest
from models.atomic_file import MACHINE
from models.errors import DatasetError, ScenarioError
from models.folder_kinds import kind_of
from renders.store.radiance_store import RadianceStore

SPECIFICATION = """
name = "few"
frames = 2
[[target]]
spacecraft = "hispasat"
[[camera]]
name = "wide"
width = 64
[pose]
range_m = [20.0, 80.0]
"""

MINE = {
    "camera.toml": "mine",
    "frames.csv": "mine",
    "report.html": "mine",
    "estimates/best.jsonl": "mine\n",
    "frames/000000_800.png": "mine",
    "sun_map_of_mine.png": "mine",
}
VERBS = {
    "run": "run maxar-demo --out OUT",
    "render": "render maxar-demo --out OUT",
    "render a tumble": "render xmm-tumble --out OUT",
    "sweep": "sweep maxar-demo --time-s 250 --suns S1 --out OUT",
    "suite": "suite pesce2019 --quick --out OUT",
    "a store": "render maxar-demo --out NEW --store OUT",
}


@pytest.fixture
def theirs(tmp_path) -> Path:
    """Return a folder of the user's own, with names that we would write."""
    folder = tmp_path / "theirs"
    for name, text in MINE.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


@pytest.mark.parametrize("verb", VERBS)
def test_a_folder_that_is_not_ours_is_left_alone(verb, theirs, tmp_path, capsys):
    before = contents(tmp_path)
    command = VERBS[verb].replace("OUT", str(theirs)).replace("NEW", str(tmp_path / "new"))
    assert main(command.split()) == 2
    told = capsys.readouterr().err
    assert "what rvbench did not make: camera.toml, estimates/, frames.csv, frames/, " in told
    assert (
        f"nothing was changed: choose another {'--store' if verb == 'a store' else '--out'}" in told
    )
    after = contents(tmp_path)
    assert {name: after[name] for name in before} == before
    assert contents(theirs) == {name: text.encode() for name, text in MINE.items()}


@pytest.mark.parametrize("named", ["{}", '{"format": "coco"}', "[]", "none"])
def test_somebody_elses_dataset_json_is_no_mark_of_ours(named, theirs):
    (theirs / "dataset.json").write_text(named)
    before = contents(theirs)
    assert main(["run", "maxar-demo", "--out", str(theirs)]) == 2
    assert contents(theirs) == before


@pytest.mark.parametrize("option", [["--out", ""], ["--out="], ["--out", " "]])
def test_an_empty_name_is_not_the_working_directory(option, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["run", "maxar-demo", *option]) == 2
    assert "expected a value after --out, got an empty text" in capsys.readouterr().err
    assert main(["estimate", ""]) == 2
    assert not list(tmp_path.iterdir())


# Estimates of image pairs


@pytest.fixture
def pairs(scored_dataset, tmp_path) -> Path:
    """Return a folder of pairs with a prior and a camera."""
    folder = tmp_path / "pairs"
    shutil.copytree(scored_dataset.folder / "frames", folder)
    for name in ("prior.toml", "camera.toml"):
        shutil.copy(scored_dataset.folder / name, folder / name)
    return folder


def estimate(pairs: Path, *more: str) -> int:
    return main(["estimate", "--frames", str(pairs), "--camera", str(pairs / "camera.toml"), *more])


def test_estimates_go_beside_pairs_and_may_be_made_again(pairs):
    assert estimate(pairs) == 0
    first = contents(pairs)
    assert estimate(pairs) == 0
    assert set(contents(pairs)) == set(first)


@pytest.mark.parametrize("name", ["best.jsonl", "notes.txt", "best.runtime.csv"])
def test_somebody_elses_estimates_are_left_alone(name, pairs, capsys):
    (pairs / "estimates").mkdir()
    (pairs / "estimates" / name).write_text('{"mine": 1}\n')
    before = contents(pairs)
    assert estimate(pairs) == 2
    assert f"it holds what rvbench did not make: {name}" in capsys.readouterr().err
    assert contents(pairs) == before


def test_a_file_where_the_estimates_would_lie(pairs):
    (pairs / "estimates").write_text("mine")
    assert estimate(pairs) == 2
    assert (pairs / "estimates").read_text() == "mine"


def test_estimates_elsewhere_want_a_folder_of_their_own(pairs, theirs, tmp_path):
    shutil.rmtree(theirs / "estimates")
    before = contents(theirs)
    assert estimate(pairs, "--out", str(theirs)) == 2
    assert contents(theirs) == before
    for _ in range(2):
        assert estimate(pairs, "--out", str(tmp_path / "new")) == 0


# Pictures


def test_a_picture_replaces_none_but_ours(scored_dataset, tmp_path, capsys):
    show = ["show", str(scored_dataset.folder), "0", "--out"]
    out = tmp_path / "frame.png"
    for _ in range(2):
        assert main([*show, str(out)]) == 0
    assert cv2.imread(str(out)).shape[2] == 3  # the mark in its header harms no reader
    mine = tmp_path / "mine.png"
    cv2.imwrite(str(mine), np.zeros((9, 9), np.uint8))
    before = mine.read_bytes()
    frame = scored_dataset.folder / "frames" / "000000_800.png"
    for place in (mine, frame, tmp_path):
        assert main([*show, str(place)]) == 2
    assert "expected a picture of ours or nothing" in capsys.readouterr().err
    assert mine.read_bytes() == before


# Suites


def test_a_suite_marks_its_folder_first_and_goes_on(tmp_path):
    units = tmp_path / "suite" / "units"
    units.mkdir(parents=True)
    (units / f".made_by.json.{MACHINE}-99999999.part").touch()  # killed at its first file
    for _ in range(2):
        begin(tmp_path / "suite", "pesce2019")
    with pytest.raises(DatasetError, match="hold the suite another, it holds pesce2019"):
        begin(tmp_path / "suite", "another")


def test_a_finished_suite_of_before_is_ours(tmp_path):
    told = {"format": "rvbench-suite", "version": 1, "suite": "pesce2019"}
    (tmp_path / "suite.json").write_text(json.dumps(told))
    (tmp_path / "suite.html").write_text("its page")
    begin(tmp_path, "pesce2019")


def test_every_suite_minds_its_folder(theirs):
    request = SuiteRequest("pesce2019", theirs, 1, runs=0)
    with pytest.raises(DatasetError, match="what rvbench did not make"):
        suite_by_name("pesce2019").run(request, Console(stderr=True))
    new = SuiteRequest("pesce2019", theirs.parent / "new", 1, runs=0)
    with pytest.raises(ScenarioError, match="--runs"):
        suite_by_name("pesce2019").run(new, Console(stderr=True))


def test_another_kind_of_folder_of_ours_is_called_what_it_is(scored_dataset, tmp_path, capsys):
    spec = tmp_path / "spec.toml"
    spec.write_text(SPECIFICATION)
    before = contents(scored_dataset.folder)
    assert main(["dataset", str(spec), "--out", str(scored_dataset.folder)]) == 2
    told = capsys.readouterr().err
    assert "it holds another kind of folder of rvbench's, a dataset; nothing was changed" in told
    assert "did not make" not in told
    assert contents(scored_dataset.folder) == before


@pytest.mark.parametrize(
    ("mark", "text", "kind"),
    [
        ("random_dataset.json", '{"format": "rvbench-random-dataset"}', "random dataset"),
        ("export.json", '{"format": "rvbench-export"}', "export"),
        ("units/made_by.json", '{"format": "rvbench-suite"}', "suite"),
        ("comparison.json", '{"format": "rvbench-comparison"}', "comparison"),
        ("truth/scenario.toml", "", "sweep"),
        ("dataset.json", '{"format": "theirs"}', None),
        ("dataset.json", "[" * 9, None),
        ("CACHEDIR.TAG", "Signature: 8a477f597d28d172789f06886806bc55\n# theirs", None),
    ],
)
def test_a_folders_kind_is_told_by_its_mark(tmp_path, mark, text, kind):
    (tmp_path / mark).parent.mkdir(exist_ok=True)
    (tmp_path / mark).write_text(text)
    assert kind_of(tmp_path) == kind


def test_a_store_is_one(tmp_path):
    RadianceStore(tmp_path / "store").open_for_writing()
    assert kind_of(tmp_path / "store") == "store of light"
