"""Methods side by side: who is better, whether the frames can tell, and where."""

import csv
import json
import re
import shutil

import numpy as np
import pytest

from bench import api
from bench.cli import main
from bench.compare.conditions import Conditions, groups
from models.errors import DatasetError, ScenarioError
from models.pose import RigidTransform
from tests.support.foreign_files import write_bop, write_own, write_speed, write_tum
from tests.support.said_truth import said_truth
from tests.support.synthetic_images import write_images

FAST = {"vsd_px": 0, "resamples": 200}


def off_by(metres: float):
    """Return what moves a pose aside, a little more the nearer it turns to the camera."""

    def change(pose: RigidTransform) -> RigidTransform:
        return pose.perturbed(np.zeros(3), np.array([metres, 0.0, 0.0]))

    return change


@pytest.fixture(scope="session")
def files(tumble, tmp_path_factory):
    """Three methods: the truth, one off by 10 cm with a frame missing, one off by 30 cm."""
    folder = tmp_path_factory.mktemp("methods")
    return [
        write_speed(folder / "exact.csv", said_truth(tumble)),
        write_bop(folder / "near.csv", said_truth(tumble, off_by(0.1), without=(3,))),
        write_tum(folder / "far.txt", said_truth(tumble, off_by(0.3))),
    ]


@pytest.fixture(scope="session")
def compared(tumble, files, tmp_path_factory):
    out = tmp_path_factory.mktemp("compared") / "out"
    _, paths = api.compare(files, tumble.folder, out, vsd_px=32, resamples=300)
    names = {"comparison.json", "comparison.csv", "comparison.html"}
    assert {path.name for path in paths.values()} == names
    return out


@pytest.fixture(scope="session")
def table(compared):
    return json.loads((compared / "comparison.json").read_text())


def test_the_better_stands_before_the_worse(table):
    assert [each["label"] for each in table["standings"]] == ["exact", "far", "near"]
    assert table["rank_by"] == "speed"
    # One lost frame of eight costs more than 30 cm at 30 m in all of them.
    far, near = (table["methods"][label]["measures"]["speed"] for label in ("far", "near"))
    assert near["score_estimated"] < far["score_estimated"]
    assert near["score"] > far["score"]


def test_pairs_are_of_the_same_frames(table):
    pairs = {(pair["one"], pair["other"]): pair for pair in table["pairs"]}
    assert set(pairs) == {("exact", "far"), ("exact", "near"), ("far", "near")}
    far = pairs["exact", "far"]
    assert far["better_share"]["value"] == 1.0
    # 0.3 m over a range that changes by 3 cm in 30 m: a difference almost without a spread.
    assert far["difference"]["value"] == pytest.approx(-0.01, rel=1e-3)
    low, high = far["difference"]["interval"]
    assert high - low < 1e-3 * 0.01
    assert not far["told_apart"]  # of four blocks of two frames: too few to say it
    assert far["blocks"] == 4
    near = pairs["far", "near"]
    assert near["better_share"]["value"] == 0.125  # in the frame that near has lost
    assert not near["told_apart"]


def test_what_it_was_made_of_is_recorded(table, files):
    assert table["bootstrap"] == {
        "seed": 0, "resamples": 300, "block_frames": 2, "confidence": 0.95,
    }  # fmt: skip
    near = table["methods"]["near"]
    assert (near["file"], near["format"], near["missing"]) == ("near.csv", "bop", 1)
    assert len(near["sha256"]) == 64
    assert table["made_by"]["vsd"]["every_nth_pixel"] == 2
    assert table["made_by"]["shape"] == "the mesh of xmm"
    rows = table["conditions"]
    assert [row["frame"] for row in rows] == list(range(8))
    assert all(row["tumble_deg_s"] > 0.0 and 0.0 <= row["phase_deg"] <= 180.0 for row in rows)


def test_the_table_says_what_the_json_says(compared, table):
    rows = list(csv.DictReader((compared / "comparison.csv").read_text().splitlines()))
    assert [row["method"] for row in rows[:3]] == ["exact", "far", "near"]
    for row, standing in zip(rows, table["standings"], strict=False):
        assert row["by"] == ""
        assert float(row["speed"]) == standing["values"]["speed"]["value"]
        assert float(row["ar_high"]) == standing["values"]["ar"]["interval"][1]
    assert len(rows) == 3 + len(table["groups"])
    assert [int(row["lost"]) for row in rows[:3]] == [0, 0, 1]


def test_the_same_again_is_the_same_bytes(tumble, files, compared, tmp_path):
    api.compare(files, tumble.folder, tmp_path / "again", vsd_px=32, resamples=300)
    for name in ("comparison.json", "comparison.csv", "comparison.html"):
        assert (tmp_path / "again" / name).read_bytes() == (compared / name).read_bytes()


def test_the_page_tells_it_all_and_fetches_nothing(compared):
    page = (compared / "comparison.html").read_text()
    assert "3 methods on painted" in page
    titles = re.findall("<h2>(.*?)</h2>", page)
    assert titles[:2] == ["Leaderboard", "Every measure, method by method"]
    assert "By range, phase angle and tumble rate" in titles
    assert page.count("<img ") == 3
    assert "<script" not in page
    assert not re.search(r'(src|href)="(?!data:|#)', page)
    assert "no row in near.csv" in page


def test_a_dataset_stands_for_all_that_have_spoken(tumble, files, tmp_path, capsys):
    folder = tmp_path / "data"
    shutil.copytree(tumble.folder, folder)
    (folder / "estimates").mkdir()
    write_own(folder / "estimates" / "best.jsonl", said_truth(tumble))
    write_own(folder / "estimates" / "mine.jsonl", said_truth(tumble, off_by(0.2)))
    again = folder / "seeds" / "001" / "estimates"
    again.mkdir(parents=True)
    write_own(again / "best.jsonl", said_truth(tumble, off_by(0.05)))
    typed = ["compare", str(folder), str(folder / "seeds" / "001"), str(files[1])]
    assert main([*typed, "--out", str(tmp_path / "out"), "--vsd-px", "0"]) == 0
    out = capsys.readouterr().out
    assert "near: 1 of 8 frames have no row: lost" in out
    told = json.loads((tmp_path / "out" / "comparison.json").read_text())
    assert set(told["methods"]) == {"best", "mine", "best, run 1", "near"}
    one = [str(folder / "estimates" / name) for name in ("best.jsonl", "mine.jsonl")]
    assert main(["compare", *one, "--out", str(tmp_path / "two"), "--vsd-px", "0"]) == 0


def test_files_of_one_name_are_told_apart(tumble, tmp_path):
    paths = []
    for name in ("ours", "theirs"):
        (tmp_path / name).mkdir()
        paths.append(write_bop(tmp_path / name / "run.csv", said_truth(tumble)))
    comparison, _ = api.compare([*paths, paths[0]], tumble.folder, tmp_path / "out", **FAST)
    labels = [method.label for method in comparison.methods]
    assert labels == ["run (ours)", "run (theirs)", "run (ours) #2"]
    assert not any(pair.told_apart for pair in comparison.board.pairs)


def test_what_is_not_of_the_same_frames_is_refused(tumble, files, tmp_path):
    other = write_images(tmp_path / "other", 3, width_px=64)
    (other.folder / "estimates").mkdir()
    write_own(other.folder / "estimates" / "best.jsonl", said_truth(other))
    with pytest.raises(DatasetError, match="only methods on the same frames are compared"):
        api.compare([other.folder, files[0]], tumble.folder, tmp_path / "out")
    with pytest.raises(DatasetError, match="name it with --dataset DIR"):
        api.compare(files, None, tmp_path / "out")
    for few in (files[:1], []):
        with pytest.raises(ScenarioError, match="expected at least two methods"):
            api.compare(few, tumble.folder, tmp_path / "out")
    with pytest.raises(DatasetError, match="with no estimates"):
        api.compare([tumble.folder, files[0]], None, tmp_path / "out")
    with pytest.raises(ScenarioError, match="--vsd-px above 0 with --rank-by ar"):
        api.compare(files, tumble.folder, tmp_path / "out", rank_by="ar", vsd_px=0)
    assert not (tmp_path / "out").exists()


def test_a_folder_of_somebody_else_is_left_alone(tumble, files, tmp_path):
    theirs = tmp_path / "theirs"
    theirs.mkdir()
    (theirs / "notes.txt").write_text("mine")
    with pytest.raises(DatasetError, match=r"did not make: notes\.txt"):
        api.compare(files, tumble.folder, theirs, **FAST)
    (theirs / "notes.txt").unlink()
    (theirs / "comparison.json").write_text("{}")
    with pytest.raises(DatasetError, match="did not make"):
        api.compare(files, tumble.folder, theirs, **FAST)
    assert (theirs / "comparison.json").read_text() == "{}"


def test_all_frames_of_all_methods_may_be_lost_but_one(tumble, tmp_path):
    """No number that a table needs is infinite in a file, or missing on a page."""
    gone = tuple(range(1, 8))
    paths = [write_bop(tmp_path / f"{name}.csv", said_truth(tumble, without=gone)) for name in "ab"]
    for rank_by in ("position", "attitude", "speed"):
        out = tmp_path / rank_by
        api.compare(paths, tumble.folder, out, rank_by=rank_by, **FAST)
        told = json.loads((out / "comparison.json").read_text())
        assert told["standings"][0]["values"]["position"]["value"] is None
        assert told["pairs"][0]["better_share"]["value"] == 0.5


def test_ranked_by_bop_more_is_better(tumble, files, tmp_path):
    comparison, _ = api.compare(
        files, tumble.folder, tmp_path / "out", rank_by="ar", vsd_px=32, resamples=200
    )
    assert comparison.board.standings[0].label == "exact"
    assert comparison.board.pairs[0].difference.value >= 0.0


def test_frames_are_grouped_by_their_conditions():
    count = 24
    told = Conditions(
        range_m=np.linspace(10.0, 100.0, count),
        phase_deg=np.linspace(0.0, 180.0, count),
        tumble_deg_s=np.full(count, 0.3),
    )
    found = groups(told)
    by = {own.by for own in found}
    assert by == {"range", "phase angle"}  # all tumble alike
    for condition in by:
        own = [group.frames for group in found if group.by == condition]
        assert np.sum(own, axis=0).tolist() == [1] * count  # each frame in one group
    ranges = [group.frames.sum() for group in found if group.by == "range"]
    assert ranges == [6, 6, 6, 6]
    assert groups(Conditions(np.array([1.0, 2.0]), None, None)) == []


def with_target(tumble, folder, name: str, **wireframe) -> None:
    """Copy a dataset for a target of another name, with other keys in its wireframe."""
    shutil.copytree(tumble.folder, folder)
    for file, changes in (("dataset.json", {"target": name}), ("wireframe.json", wireframe)):
        told = json.loads((folder / file).read_text())
        (folder / file).write_text(json.dumps({**told, **changes}))


def test_a_target_of_unknown_shape_has_the_measures_that_need_none(tumble, files, tmp_path):
    folder = tmp_path / "data"
    with_target(tumble, folder, "mine", triangles_in_target_m=[])
    api.compare(files, folder, tmp_path / "out", resamples=200)
    told = json.loads((tmp_path / "out" / "comparison.json").read_text())
    assert told["made_by"]["shape"] is None
    own = told["methods"]["far"]["measures"]
    assert (own["add_m"], own["bop"], own["vsd"]) == (None, None, None)
    assert own["speed"]["score"] == pytest.approx(0.01, rel=1e-3)
    assert not any("ADD" in each["what"] for each in own["recall"])
    with pytest.raises(DatasetError, match="whose shape is known for --rank-by ar"):
        api.compare(files, folder, tmp_path / "two", rank_by="ar")


def test_a_target_of_ones_own_has_the_shape_and_the_symmetries_of_its_wireframe(tumble, tmp_path):
    half_turn = np.diag([-1.0, -1.0, 1.0])
    folder = tmp_path / "data"
    with_target(tumble, folder, "mine", symmetries=[half_turn.tolist()])

    def turned(pose: RigidTransform) -> RigidTransform:
        return RigidTransform(pose.rotation @ half_turn, pose.translation)

    path = write_bop(tmp_path / "turned.csv", said_truth(tumble, turned))
    _, table = api.score_estimates(folder, path, tmp_path / "out.json", vsd_px=0)
    assert table["made_by"]["shape"] == "data/wireframe.json"
    assert table["made_by"]["symmetries"] == 1
    own = table["methods"]["turned"]["measures"]
    assert own["bop"]["ar_mssd"] == own["bop"]["ar_mspd"] == 1.0
    assert own["attitude_error_deg"]["median"] == pytest.approx(180.0)
    assert own["add_m"]["median"] > 1.0  # ADD knows no symmetry


def test_a_single_frame_is_compared(tmp_path):
    one = write_images(tmp_path / "one", 1, width_px=64)
    paths = [write_bop(tmp_path / f"{name}.csv", said_truth(one)) for name in "ab"]
    _, files = api.compare(paths, one.folder, tmp_path / "out", vsd_px=32, resamples=100)
    assert all(path.is_file() for path in files.values())
