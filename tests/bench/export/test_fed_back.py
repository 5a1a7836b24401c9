"""What an export says, said back by its own numbers: perfect; and off by what it was moved by."""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench import api
from bench.cli import main
from bench.export.exporter import export_datasets
from bench.export.request import ExportRequest
from models.pose import RigidTransform
from tests.support.foreign_files import words, wxyz

A_DEGREE, A_CENTIMETRE = np.deg2rad([0.6, 0.0, 0.8]), np.array([0.0, 0.006, -0.008])
NOTHING = np.zeros(3)
WITHIN_DEG, WITHIN_M = 1e-6, 1e-6
SPLIT = (0.4, 0.3, 0.3)
LISTS = ("train.json", "validation.json", "test.json")


@pytest.fixture(scope="module")
def merged(tmp_path_factory, tumble, pairs) -> Path:
    """Return pairs of Maxar, then the tumble of XMM, in one BOP export."""
    out = tmp_path_factory.mktemp("merged") / "bop"
    export_datasets(ExportRequest((pairs, tumble), "bop", out, split=SPLIT))
    return out


def moved(told: RigidTransform, turn, shift) -> RigidTransform:
    return told.perturbed(turn, shift)


def bop_results(out: Path, path: Path, turn=NOTHING, shift=NOTHING) -> Path:
    """Write the poses of all splits as results: of pairs those of the last exposure."""
    rows = ["scene_id,im_id,obj_id,score,R,t,time"]
    for place in sorted(out.glob("t*/0*")) + sorted(out.glob("val/0*")):
        if place.parent.name not in ("train", "val", "test"):
            continue
        table = sorted(place.glob("scene_gt_image*.json"))[-1]
        for image, (pose,) in json.loads(table.read_text()).items():
            at = RigidTransform(
                np.reshape(pose["cam_R_m2c"], (3, 3)), 1e-3 * np.array(pose["cam_t_m2c"])
            )
            at = moved(at, turn, shift)
            cells = [int(place.name), image, pose["obj_id"], 1.0, words(at.rotation.ravel())]
            rows.append(",".join(map(str, [*cells, words(1e3 * at.translation), -1])))
    path.write_text("\n".join(rows) + "\n")
    return path


def speed_submission(out: Path, path: Path, turn=NOTHING, shift=NOTHING) -> Path:
    """Write the poses of all lists under the names that the lists have."""
    rows = []
    for name in LISTS:
        if (out / "synthetic" / name).is_file():
            for own in json.loads((out / "synthetic" / name).read_text()):
                turned = Rotation.from_quat(own["q_vbs2tango_true"], scalar_first=True)
                at = RigidTransform(turned.as_matrix(), np.array(own["r_Vo2To_vbs_true"]))
                at = moved(at, turn, shift)
                numbers = words([*wxyz(at.rotation), *at.translation]).replace(" ", ",")
                rows.append(f"{own['filename']},{numbers}")
    path.write_text("\n".join(rows) + "\n")
    return path


def trajectory(out: Path, path: Path, scene: int, turn=NOTHING, shift=NOTHING) -> Path:
    """Write the labels of a scene as a trajectory of the target, at the times of its frames."""
    with (out / "tables" / f"{scene:06d}" / "frames.csv").open() as file:
        times = {row["index"]: row["time_s"] for row in csv.DictReader(file)}
    last: dict[str, str] = {}
    with (out / "tables" / "labels.csv").open() as file:
        for row in csv.DictReader(file):
            if int(row["scene"]) == scene:
                quaternion = [float(row[f"q{part}_cam_from_target"]) for part in "wxyz"]
                turned = Rotation.from_quat(quaternion, scalar_first=True).as_matrix()
                place = np.array([float(row[f"t{axis}_m_cam_from_target"]) for axis in "xyz"])
                at = moved(RigidTransform(turned, place), turn, shift)
                w, x, y, z = wxyz(at.rotation)
                told = words([*at.translation, x, y, z, w])
                last[row["frame"]] = f"{times[row['frame']]} {told}"  # later streams replace it
    path.write_text("\n".join(last.values()) + "\n")
    return path


def scored(dataset: Path, path: Path, **options):
    _, table = api.score_estimates(dataset, path, path.with_suffix(".json"), **options)
    (own,) = table["methods"].values()
    return own


def assert_perfect(own, frames: int) -> None:
    told = own["measures"]
    assert (told["frames"], told["estimated"], told["lost"], told["wrong"]) == (
        frames,
        frames,
        {},
        0,
    )
    assert told["position_error_m"]["p95"] < WITHIN_M
    assert told["attitude_error_deg"]["p95"] < WITHIN_DEG
    assert told["speed"]["score_floored"] == 0.0
    assert told["bop"] == {"ar_vsd": 1.0, "ar_mssd": 1.0, "ar_mspd": 1.0, "ar": 1.0}
    assert {recall["share"] for recall in told["recall"]} == {1.0}


def assert_moved(own, deg: float, m: float) -> None:
    for row in own["per_frame"]:
        assert abs(row["attitude_deg"] - deg) < WITHIN_DEG
        assert abs(row["position_m"] - m) < WITHIN_M


WAYS = {
    "bop": lambda outs, path, dataset, *by: bop_results(outs["merged"], path, *by),
    "speed": lambda outs, path, dataset, *by: speed_submission(outs[dataset], path, *by),
    "tum": lambda outs, path, dataset, *by: trajectory(
        outs["merged"], path, {"pairs": 1, "tumble": 2}[dataset], *by
    ),
}


@pytest.fixture(scope="module")
def outs(tmp_path_factory, merged, tumble, pairs) -> dict[str, Path]:
    """Return the merged export, and each dataset's own in SPEED+'s format."""
    found = {"merged": merged}
    for name, data in (("tumble", tumble), ("pairs", pairs)):
        found[name] = tmp_path_factory.mktemp("speed") / name
        export_datasets(ExportRequest((data,), "speedplus", found[name], split=SPLIT))
    return found


@pytest.mark.parametrize("dataset", ["tumble", "pairs"])
@pytest.mark.parametrize("way", list(WAYS))
def test_truth_from_an_export_is_perfect(way, dataset, outs, tmp_path, request):
    data = request.getfixturevalue(dataset)
    path = WAYS[way](outs, tmp_path / "mine.csv", dataset)
    options = {"trajectory_of": "target"} if way == "tum" else {}
    export = outs[dataset] if way == "speed" else outs["merged"]
    own = scored(data, path, exported=export, vsd_px=64, **options)
    assert_perfect(own, 3 if dataset == "tumble" else 2)
    assert own["missing"] == 0


@pytest.mark.parametrize("by", [(A_DEGREE, NOTHING, 1.0, 0.0), (NOTHING, A_CENTIMETRE, 0.0, 0.01)])
@pytest.mark.parametrize("dataset", ["tumble", "pairs"])
@pytest.mark.parametrize("way", list(WAYS))
def test_what_it_is_moved_by_is_its_error(way, dataset, by, outs, tmp_path, request):
    turn, shift, deg, m = by
    data = request.getfixturevalue(dataset)
    path = WAYS[way](outs, tmp_path / "mine.csv", dataset, turn, shift)
    options = {"trajectory_of": "target"} if way == "tum" else {}
    export = outs[dataset] if way == "speed" else outs["merged"]
    assert_moved(scored(data, path, exported=export, vsd_px=0, **options), deg, m)


def test_one_split_is_judged_alone(merged, tumble, tmp_path, capsys):
    path = bop_results(merged, tmp_path / "mine.csv")
    rows = path.read_text().splitlines()
    (kept,) = json.loads((merged / "test" / "000002" / "scene_gt_image.json").read_text())
    path.write_text("\n".join([rows[0], *(r for r in rows if r.startswith(f"2,{kept},"))]) + "\n")
    whole = scored(tumble, path, vsd_px=0)
    assert (whole["measures"]["frames"], whole["missing"]) == (3, 2)
    typed = ["score", str(tumble), "--estimates", str(path), "--exported", str(merged)]
    assert main([*typed, "--split", "test"]) == 0
    assert "have no row" not in capsys.readouterr().out
    own = json.loads((tmp_path / "mine.csv.score.json").read_text())["methods"]["mine"]
    assert_perfect(own, 1)
    assert [row["frame"] for row in own["per_frame"]] == [int(kept)]


@pytest.mark.parametrize(("typed", "told"), [
    (["--split", "test"], "expected --split only with --exported"),
    (["--exported", "EXPORT", "--split", "tset"], "expected a split with frames of scene 2"),
    (["--exported", "DATA"], "expected an export of rvbench in"),
    (["--exported", "OTHER"], "got one of 1 other datasets"),
])  # fmt: skip
def test_an_export_that_is_not_of_the_dataset_is_refused(
    typed, told, merged, outs, tumble, tmp_path, capsys
):
    path = bop_results(merged, tmp_path / "mine.csv")
    places = {"EXPORT": merged, "DATA": tumble, "OTHER": outs["pairs"]}
    words_typed = [str(places.get(word, word)) for word in typed]
    assert main(["score", str(tumble), "--estimates", str(path), *words_typed]) == 2
    message = capsys.readouterr().err
    assert told in message
    assert message.count("rvbench: ") == 1
    assert not (tmp_path / "mine.csv.score.json").exists()


def test_an_exports_own_lists_are_believed_only_as_far_as_they_can_be(
    merged, tumble, tmp_path, capsys
):
    path = bop_results(merged, tmp_path / "mine.csv")
    out = tmp_path / "out"
    shutil.copytree(merged, out)
    for name, text in (
        ("export.json", "[" * 100_000),
        ("export.json", '{"format": "rvbench-export", "datasets": [1]}'),
        ("export.json", '{"format": "rvbench-export", "datasets": [{"target": 3}]}'),
        ("tables/labels.csv", "scene,frame,split\n2,1,test\n"),
        ("tables/labels.csv", (merged / "tables/labels.csv").read_text().replace(",2,", ",nan,")),
    ):
        (out / name).write_text(text)
        typed = ["score", str(tumble), "--estimates", str(path), "--exported", str(out)]
        assert main([*typed, "--split", "test"]) == 2
        message = capsys.readouterr().err
        assert name.rpartition("/")[2] in message
        assert message.count("rvbench: ") == 1
        shutil.copy(merged / name, out / name)


def test_poses_of_the_first_exposure_are_told_apart(outs, pairs, tmp_path):
    path = speed_submission(outs["pairs"], tmp_path / "mine.csv")
    assert scored(pairs, path, vsd_px=0)["remarks"] == [
        "2 poses of other images than image_850 left out"
    ]
    rows = [row for row in path.read_text().splitlines() if "_image_800" in row]
    path.write_text("\n".join(rows) + "\n")
    assert scored(pairs, path, vsd_px=0)["remarks"] == [
        "poses of image_800, judged at the frame's last exposure, image_850"
    ]
