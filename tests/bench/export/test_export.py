"""Every format, whole: reopened, gone on with after a kill, refused where it should be."""

from __future__ import annotations

import hashlib
import json
import shutil
import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

from bench.cli import main
from bench.export import exporter
from bench.export.check import check_export
from bench.export.exporter import export_datasets
from bench.export.folder import all_files, listed
from bench.export.formats.catalogue import FORMATS
from bench.export.labels import label_of
from bench.export.picture import picture_of
from bench.export.plan import make_plan
from bench.export.record import record_from_json
from bench.export.request import ExportRequest
from bench.export.source import open_source
from models.errors import DatasetError, RvbenchError, ScenarioError
from models.sensors.camera_chip import Detector

KINDS = list(FORMATS)


def contents(folder: Path) -> dict[str, str]:
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in files
    }


@pytest.mark.parametrize("kind", KINDS)
def test_every_format_reopens_with_nothing_wrong(kind, exported):
    name, found = check_export(exported(kind))
    assert name == kind
    assert found.faults == []
    assert found.images == 3
    assert found.objects == 3
    assert found.reprojection_px < 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_every_file_is_listed_and_nothing_is_left_over(kind, exported):
    out = exported(kind)
    assert sorted(name for name, _ in listed(out)) == sorted(all_files(out))
    assert not (out / ".rvbench-export").exists()
    for name in ("README.md", "card/frames.png", "card/spread.png", "targets.json"):
        assert (out / name).is_file()
    assert (out / "tables" / "000001" / "chaser_orbit.csv").is_file()
    assert len((out / "tables" / "labels.csv").read_text().splitlines()) == 4


def test_an_export_that_is_there_is_left_alone(exported, tumble, tmp_path, capsys):
    out = tmp_path / "out"
    shutil.copytree(exported("coco"), out)
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*")}
    split = ["--split", "0.4", "0.3", "0.3"]
    assert main(["export", str(tumble), "--as", "coco", "--out", str(out), *split]) == 0
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*")} == before
    assert main(["export", str(tumble), "--as", "bop", "--out", str(out), *split]) == 2
    told = capsys.readouterr().err
    assert "it holds another: as 'coco' instead of 'bop'" in told
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*")} == before


@pytest.mark.parametrize("kind", ["bop", "webdataset", "coco"])
@pytest.mark.parametrize("stage", ["_export", "_finish"])
def test_a_stopped_export_goes_on_and_ends_the_same(kind, stage, exported, tumble, tmp_path):
    out, calls = tmp_path / "out", []
    request = ExportRequest((tumble,), kind, out, split=(0.4, 0.3, 0.3))
    with pytest.MonkeyPatch.context() as patch:
        if stage == "_export":
            whole = exporter._export

            def stopped(*given):
                if len(calls) == 2:
                    raise KeyboardInterrupt
                calls.append(given)
                whole(*given)

            patch.setattr(exporter, "_export", stopped)
        else:

            def halfway(*given):
                for number, told in enumerate(finish(*given)):
                    if number == 2:
                        raise KeyboardInterrupt
                    yield told

            finish = exporter._finish
            patch.setattr(exporter, "_finish", halfway)
        with pytest.raises(KeyboardInterrupt):
            export_datasets(request)
    with pytest.raises(DatasetError, match="goes on where it stopped"):
        check_export(out)
    with pytest.MonkeyPatch.context() as patch:
        again = []
        whole = exporter._export
        patch.setattr(exporter, "_export", lambda *given: (again.append(given), whole(*given)))
        export_datasets(request)
    assert len(again) == (1 if stage == "_export" else 0)
    assert contents(out) == contents(exported(kind))


def test_a_folder_of_somebody_else_is_refused(tumble, tmp_path, capsys):
    theirs = tmp_path / "theirs"
    theirs.mkdir()
    (theirs / "README.md").write_text("mine")
    assert main(["export", str(tumble), "--as", "coco", "--out", str(theirs)]) == 2
    assert "what rvbench did not make: README.md" in capsys.readouterr().err
    assert contents(theirs) == {"README.md": hashlib.sha256(b"mine").hexdigest()}


def test_sixteen_bits_leave_as_recorded(exported, tumble):
    for path in sorted((exported("bop")).glob("*/000001/gray/*.png")):
        assert path.read_bytes() == (tumble / "frames" / path.name).read_bytes()


def test_eight_bits_follow_the_curve_that_is_written_down(exported, tumble):
    out = exported("yolo-pose")
    told = json.loads((out / "tone_curves.json").read_text())["1"]
    assert told["formula"] == "round(255 sqrt(x))"
    for path in sorted((out / "images").rglob("*.png")):
        number = path.stem.split("_")[1]
        raw = cv2.imread(str(tumble / "frames" / f"{number}.png"), -1).astype(np.float64)
        share = (raw - told["black_dn"]) / (told["white_dn"] - told["black_dn"])
        expected = np.rint(255.0 * np.sqrt(np.clip(share, 0.0, 1.0)))
        assert (cv2.imread(str(path), -1) == expected).all()
    assert told["black_dn"] == Detector().bias_dn


@pytest.mark.parametrize(
    ("damage", "told"),
    [
        (lambda out: (out / "targets.json").write_text("{}"), "expected the bytes that were"),
        (lambda out: (out / "targets.json").unlink(), "expected the file that"),
        (lambda out: (out / "more.txt").write_text("x"), "a file that was not exported"),
    ],
)
def test_the_check_can_fail(damage, told, exported, tmp_path, capsys):
    out = tmp_path / "out"
    shutil.copytree(exported("coco"), out)
    damage(out)
    assert main(["export", "--check", "--out", str(out)]) == 1
    assert told in capsys.readouterr().out


def test_both_boxes_of_coco_are_given_alike(exported):
    """What is seen lies within the whole, both as x, y, width and height."""
    table = json.loads((exported("coco") / "annotations" / "train.json").read_text())
    for own in table["annotations"]:
        (x, y, w, h), (left, top, width, height) = own["bbox"], own["box_of_whole"]
        assert left <= x
        assert top <= y
        assert x + w <= left + width
        assert y + h <= top + height


def test_the_check_sees_a_moved_keypoint_and_a_false_box(exported, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(exported("coco"), out)
    path = out / "annotations" / "train.json"
    table = json.loads(path.read_text())
    table["annotations"][0]["keypoints"][0] += 0.02
    table["annotations"][0]["bbox"][2] += 1
    path.write_text(json.dumps(table))
    found = FORMATS["coco"].check(out)
    assert found.reprojection_px == pytest.approx(0.02)
    assert len(found.faults) == 2


def test_one_target_and_one_camera_for_speedplus(tumble, pairs, tmp_path):
    with pytest.raises(ScenarioError, match="datasets of one target"):
        export_datasets(ExportRequest((tumble, pairs), "speedplus", tmp_path / "out"))
    assert not (tmp_path / "out").exists()


def test_estimates_and_runs_leave_as_tables(pairs, tmp_path):
    out = tmp_path / "out"
    export_datasets(ExportRequest((pairs,), "huggingface", out))
    rows = (out / "tables" / "000001" / "estimates" / "best.csv").read_text().splitlines()
    assert rows[0].startswith("frame,time_s,mode,qw_cam_from_target")
    assert len(rows) == 3
    assert check_export(out)[1].faults == []


@pytest.mark.parametrize(
    ("typed", "told"),
    [
        ([], "got neither"),
        (["DATA"], "expected --as with the datasets"),
        (["DATA", "--as", "voc"], "expected --as as one of bop, bop-imagewise, webdataset, "),
        (["DATA", "--as", "coco", "--bits", "12"], "expected --bits as one of 8, 16, got 12"),
        (["DATA", "--as", "coco", "--demosaic", "rgb"], "one of rggb, grbg, gbrg, bggr, got"),
        (["DATA", "--as", "coco", "--split", "0.5", "0.4", "0.3"], "shares that add up to 1"),
        (["DATA", "--as", "coco", "--split-block", "0"], "expected --split-block from 1"),
        (["DATA", "--as", "coco", "--licence", "a\nb"], "without control characters"),
        (["nowhere", "--as", "coco"], "expected a dataset in nowhere"),
    ],
)
def test_what_cannot_be_asked(typed, told, tumble, tmp_path, capsys):
    words = [str(tumble) if word == "DATA" else word for word in typed]
    assert main(["export", *words, "--out", str(tmp_path / "out")]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


# Hostile input


@pytest.fixture
def theirs(tumble, tmp_path) -> Path:
    """Return a copy of the dataset, to be spoiled."""
    shutil.copytree(tumble, tmp_path / "data")
    return tmp_path / "data"


def spoil_line(theirs: Path, key: str, value: object) -> None:
    path = theirs / "truth" / "exposures.jsonl"
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    lines[0][key] = value
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))


def png_of(width: int, height: int) -> bytes:
    """Return a PNG that claims a size and holds nothing of it."""
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(bytes(1000))), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in chunks
    )


SPOILS = {
    "NaN pose": (
        lambda d: spoil_line(d, "t_cam_from_target_m", [float("nan"), 0.0, 1.0]),
        "exposures.jsonl:1",
    ),
    "no rotation": (
        lambda d: spoil_line(d, "R_cam_from_target", [[2, 0, 0], [0, 1, 0], [0, 0, 1]]),
        "as a rotation matrix",
    ),
    "nested too deep": (
        lambda d: (d / "truth" / "exposures.jsonl").write_text("[" * 100_000),
        "exposures.jsonl",
    ),
    "frame twice": (lambda d: spoil_line(d, "frame", 1), "got those of line 1 again"),
    "path out of the dataset": (
        lambda d: (d / "dataset.json").write_text(
            (d / "dataset.json").read_text().replace("frames/{index", "../frames/{index")
        ),
        "dataset.json",
    ),
    "an image that is none": (
        lambda d: (d / "frames" / "000001.png").write_bytes(b"GIF89a" + bytes(100)),
        "000001.png",
    ),
    "labels of another size": (
        lambda d: cv2.imwrite(
            str(d / "truth" / "labels" / "000000.png"), np.zeros((9, 9), np.uint8)
        ),
        "expected part labels of 96 x 96",
    ),
    "labels of a billion pixels": (
        lambda d: (d / "truth" / "labels" / "000000.png").write_bytes(png_of(100_000, 100_000)),
        "expected part labels of 96 x 96",
    ),
    "depth cut short": (
        lambda d: (d / "truth" / "geometry" / "000000.exr").write_bytes(b"v/1\x01"),
        "expected a whole EXR",
    ),
    "a truth that never ends": (
        lambda d: (
            (d / "truth" / "exposures.jsonl").unlink(),
            (d / "truth" / "exposures.jsonl").symlink_to("/dev/zero"),
        ),
        "a device",
    ),
}  # fmt: skip


@pytest.mark.parametrize("spoil", SPOILS)
def test_what_cannot_be_is_one_message(spoil, theirs, tmp_path, capsys):
    do, told = SPOILS[spoil]
    do(theirs)
    assert main(["export", str(theirs), "--as", "coco", "--out", str(tmp_path / "out")]) == 2
    message = capsys.readouterr().err
    assert told in message
    assert message.count("rvbench: ") == 1
    assert "Traceback" not in message


def test_names_of_others_are_told_literally(theirs, tmp_path):
    path = theirs / "dataset.json"
    table = json.loads(path.read_text())
    table["case"] = "<script>alert(1)</script> | ![x](y) `z`"
    path.write_text(json.dumps(table))
    out = tmp_path / "out"
    export_datasets(ExportRequest((theirs,), "bop", out))
    card = (out / "README.md").read_text()
    assert "<script>" not in card
    assert "![x]" not in card
    assert check_export(out)[1].faults == []


def test_a_list_of_hashes_that_leads_out_is_refused(exported, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(exported("coco"), out)
    with (out / "files.sha256").open("a") as file:
        file.write(f"{'0' * 64}  ../secret\n")
    with pytest.raises(RvbenchError, match="a path within the export"):
        check_export(out)


@pytest.mark.parametrize("target", ["/dev/zero", None])
def test_hashes_that_never_end_are_refused(target, exported, tmp_path, capsys):
    out = tmp_path / "out"
    shutil.copytree(exported("coco"), out)
    if target is None:
        (out / "files.sha256").write_text("0" * 10_000_000)
    else:
        (out / "files.sha256").unlink()
        (out / "files.sha256").symlink_to(target)
    assert main(["export", "--check", "--out", str(out)]) == 2
    message = capsys.readouterr().err
    assert "files.sha256" in message
    assert message.count("rvbench: ") == 1


@pytest.fixture
def stopped(exported, tmp_path) -> Path:
    """Return an export that lacks nothing but its end."""
    out = tmp_path / "out"
    shutil.copytree(exported("coco"), out)
    mark = json.loads((out / "export.json").read_text())
    (out / "export.json").write_text(json.dumps({**mark, "complete": False}))
    return out


def test_a_stopped_export_is_not_gone_on_with_through_a_link(stopped, tumble, tmp_path, capsys):
    theirs = tmp_path / "theirs"
    shutil.move(stopped / "images", theirs)
    (stopped / "images").symlink_to(theirs)
    before = contents(theirs)
    split = ["--split", "0.4", "0.3", "0.3"]
    assert main(["export", str(tumble), "--as", "coco", "--out", str(stopped), *split]) == 2
    assert "expected an export without links" in capsys.readouterr().err
    assert contents(theirs) == before


@pytest.mark.parametrize("text", [
    "[" * 100_000, '{"files": 3}', "null", '{"files": {"../../secret": [1, "0"]}}', "\x00",
])  # fmt: skip
def test_a_record_that_cannot_be_is_made_anew(text, stopped, exported, tumble):
    path = stopped / ".rvbench-export" / "records" / "0000" / "000001_000000.json"
    path.parent.mkdir(parents=True)
    path.write_text(text)
    export_datasets(ExportRequest((tumble,), "coco", stopped, split=(0.4, 0.3, 0.3)))
    assert contents(stopped) == contents(exported("coco"))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("rotation", [1.0, 0.0]),
        ("files", {"../secret": [1, "0"]}),
        ("files", {"/etc/passwd": [1, "0"]}),
        ("width", "96"),
        ("translation_m", [0.0, 0.0, float("nan")]),
        ("more", 1),
    ],
)
def test_a_record_with_an_odd_value_is_none(key, value, tumble):
    plan = make_plan([open_source(1, tumble)], (0.8, 0.1, 0.1), 0, 1)
    picture = picture_of(plan.image_path(plan.shots[0]), None, None)
    told = json.loads(label_of(plan, plan.shots[0], picture.image).record.to_json())
    assert record_from_json(json.dumps(told), "here").width == 96
    with pytest.raises(DatasetError, match=f"here: expected a label record, got: .*{key}"):
        record_from_json(json.dumps({**told, key: value}), "here")
