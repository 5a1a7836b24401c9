"""A random dataset rendered, killed, resumed, shared out, and opened by the other verbs."""

import csv
import json
import pickle
import shutil
import signal
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import tomli_w

from bench import api
from bench.cli import main
from bench.random_dataset.folder import datasets_within
from bench.random_dataset.run import DatasetRequest
from bench.random_dataset.shared_frames import frames_work
from bench.runners.options import RunnerRequest
from models.dataset.dataset import open_dataset
from models.dataset.split_file import read_splits
from models.errors import DatasetError, ScenarioError, UnreadableError
from tests.support.own_meshes import textured_glb, toml_of
from tests.support.small_scenes import needs_jit
from tests.support.whole_runs import contents, identities, rvbench, scratch_files

SMALL: dict[str, Any] = {
    "name": "small",
    "frames": 12,
    "suns_per_pose": 2,
    "exposures_per_sun": 2,
    "target": [{"spacecraft": "hispasat"}],
    "camera": [
        {"name": "wide", "width": 64},
        {"name": "own", "width": 80, "height": 64, "fov_deg": 30.0, "range_factor": 1.5},
    ],
    "pose": {"range_m": [25.0, 60.0]},
    "background": {"space": 1.0, "earth": 1.0},
    "vary": {"diffuse": 0.1},
    "split": {"train": 0.34, "val": 0.33, "test": 0.33},
    "render": {"samples": 4},
}
MIXED: dict[str, Any] = {
    **SMALL,
    "name": "mixed",
    "frames": 60,
    "suns_per_pose": 5,
    "exposures_per_sun": 1,
    "target": [
        {"spacecraft": "maxar1300"},
        {"spacecraft": "xmm"},
        {"spacecraft": "hispasat", "range_m": [40.0, 90.0]},
    ],
    "camera": [
        {"name": "wide", "width": 128},
        {"name": "own", "width": 128, "height": 96, "fov_deg": 30.0, "range_factor": 1.5},
    ],
    "background": {"space": 1.0, "stars": 1.0, "earth": 1.0},
}
PARTS = ("hispasat-own", "hispasat-wide")


def write_spec(folder: Path, table: dict[str, Any]) -> Path:
    path = folder / f"{table['name']}.toml"
    path.write_text(tomli_w.dumps(table))
    return path


def files(out: Path) -> dict[str, str]:
    """Return a hash of every file."""
    return contents(out)


@pytest.fixture(scope="module")
def spec(tmp_path_factory: pytest.TempPathFactory) -> Path:
    needs_jit()
    return write_spec(tmp_path_factory.mktemp("spec"), SMALL)


@pytest.fixture(scope="module")
def whole(spec: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One that nothing interrupted, by one process; a test may read it, not change it."""
    out = tmp_path_factory.mktemp("whole") / "out"
    result = api.dataset(spec, out, workers=1)
    assert result.left == 0
    assert [folder.name for folder in result.folders] == sorted(PARTS, reverse=True)
    return out


@pytest.mark.slow
def test_killed_twice_and_ended_by_two_processes_its_bytes_are_the_same(
    whole: Path, spec: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    command = ["dataset", spec, "--out", out, "--workers", 1]
    code, _ = rvbench(*command, struck=("SIGKILL", f"{out}/*/frames/000001.png"))
    assert code == -signal.SIGKILL
    assert scratch_files(out)
    code, said = rvbench(*command, struck=("SIGINT", f"{out}/*/truth/geometry/000003.exr"))
    assert code == 130
    assert "1 are there already" in said
    assert "the same command goes on" in said
    kept = identities(out, "[0-9]*.png")
    assert 0 < len([name for name in kept if "/frames/" in name]) < 12
    code, said = rvbench(*command[:-1], 2)
    assert code == 0, said
    assert "2 processes" in said
    assert "frames an hour" in said
    assert kept.items() <= identities(out, "[0-9]*.png").items()
    assert not scratch_files(out)
    assert files(out) == files(whole)


def test_a_frame_alone_is_that_of_the_whole(whole: Path, spec: Path, tmp_path: Path) -> None:
    """Rendered first, with nothing before it; then the others, in any order."""
    out = tmp_path / "out"
    result = api.dataset(spec, out, workers=1, only=(6, 6))
    assert result.left == 11
    frames = [path.relative_to(out) for path in out.glob("*/frames/*.png")]
    assert len(frames) == 1
    assert (out / frames[0]).read_bytes() == (whole / frames[0]).read_bytes()
    row = rows(whole / "index.csv")[6]
    assert str(frames[0]) == f"{row['folder']}/frames/{int(row['frame']):06d}.png"
    assert "11 frames are not there yet" in (out / "README.md").read_text()
    assert api.dataset(spec, out, workers=1, only=(8, 11)).left == 7
    assert api.dataset(spec, out, workers=1).left == 0
    assert files(out) == files(whole)


def test_chunks_in_any_order_are_the_whole(whole: Path, spec: Path, tmp_path: Path) -> None:
    """Each renders whole poses of its own; what is made of all is left to the command alone."""
    out = tmp_path / "out"
    for number in (1, 0):
        assert main(["dataset", str(spec), "--out", str(out), "--chunk", f"{number}/2"]) == 0
        assert len(list(out.glob("*/frames/*.png"))) == (4, 12)[1 - number]
        assert not (out / "README.md").exists()
    assert api.dataset(spec, out, workers=1).left == 0
    assert files(out) == files(whole)


def test_what_is_missing_on_a_cluster_is_counted_by_chunk(
    whole: Path, spec: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    shutil.copytree(whole, out)
    gone = sorted(out.glob("*/frames/*.png"))[0]
    gone.unlink()
    work = frames_work(DatasetRequest(spec, out), RunnerRequest("slurm", 3), ["dataset"])
    assert work.pieces == 12
    assert len(work.missing()) == 1
    shutil.copy(whole / gone.relative_to(out), gone)
    assert work.missing() == {}


def test_another_specification_is_refused_with_what_differs(
    whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = identities(whole)
    other = write_spec(tmp_path, {**SMALL, "seed": 7, "pose": {"range_m": [25.0, 70.0]}})
    assert main(["dataset", str(other), "--out", str(whole)]) == 2
    said = capsys.readouterr().err
    assert "seed is 1, now 7" in said
    assert "pose.range_m.1 is 60.0, now 70.0" in said
    assert "nothing was changed" in said
    assert identities(whole) == before


def test_a_folder_of_somebody_elses_is_left_alone(spec: Path, tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(DatasetError, match=r"thesis\.txt"):
        api.dataset(spec, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_frames_that_there_are_not_cannot_be_asked_for(spec: Path, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="--only as first and last frame, from 0 to 11"):
        api.dataset(spec, tmp_path / "out", only=(3, 12))
    with pytest.raises(ScenarioError, match="--workers"):
        api.dataset(spec, tmp_path / "out", workers=0)
    assert not (tmp_path / "out").exists()


def test_splits_are_recorded_and_leave_with_an_export(whole: Path, tmp_path: Path) -> None:
    index = rows(whole / "index.csv")
    poses = {row["split"]: set[str]() for row in index}
    for row in index:
        poses[row["split"]].add(row["pose"])
    assert set(poses) == {"train", "val", "test"}
    assert not poses["train"] & poses["test"]
    for folder in datasets_within(whole):
        recorded = read_splits(folder)
        own = {int(r["frame"]): r["split"] for r in index if r["folder"] == folder.name}
        assert recorded == own
    plan = api.export([whole], "coco", tmp_path / "coco", split=(1.0, 0.0, 0.0))
    assert [source.folder.name for source in plan.sources] == sorted(PARTS)
    left = sorted((plan.source(shot).folder.name, shot.frame, shot.split) for shot in plan.shots)
    assert left == sorted((r["folder"], int(r["frame"]), r["split"]) for r in index)
    assert "`splits.csv`" in (tmp_path / "coco" / "README.md").read_text()
    assert main(["export", "--check", "--out", str(tmp_path / "coco")]) == 0


def test_each_folder_is_a_dataset_that_other_verbs_open(whole: Path, tmp_path: Path) -> None:
    folder = tmp_path / "hispasat-wide"
    shutil.copytree(whole / folder.name, folder)
    dataset = open_dataset(folder)
    dataset.check_images()
    assert main(["show", str(folder), "1", "--out", str(tmp_path / "show.png")]) == 0
    lines = (folder / "truth" / "exposures.jsonl").read_text().splitlines()
    truth = [json.loads(line) for line in lines]
    estimates = [
        {
            "frame": each["frame"],
            "time_s": each["time_s"],
            "pose": {key: each[key] for key in ("R_cam_from_target", "t_cam_from_target_m")},
        }
        for each in truth
    ]
    own = tmp_path / "mine.jsonl"
    head = {"format": "rvbench-estimates", "version": 2}
    own.write_text("".join(json.dumps(each) + "\n" for each in [head, *estimates]))
    assert main(["score", str(folder), "--estimates", str(own)]) == 0
    case = folder / "truth" / "scenario.toml"
    before = identities(folder, "[0-9]*.png")
    assert main(["render", str(case), "--out", str(folder), "--keep-light", "none"]) == 0
    assert identities(folder, "[0-9]*.png") == before
    (folder / "estimates").mkdir()
    shutil.copy(own, folder / "estimates" / "mine.jsonl")
    assert main(["score", str(folder)]) == 0
    assert main(["report", str(folder)]) == 0
    assert read_splits(folder) is not None


def test_pictures_and_card_tell_what_was_drawn(whole: Path) -> None:
    for name in ("coverage.png", "frames.png"):
        picture = cv2.imread(str(whole / name))
        assert picture is not None
        assert picture.std() > 5.0
    card = (whole / "README.md").read_text()
    assert "12 frames of 3 poses, 2 Suns a pose, drawn with seed 1" in card
    assert "| hispasat-wide |" in card
    drawn = rows(whole / "truth" / "draws.csv")
    assert len(drawn) == 12
    assert {row["background"] for row in drawn} <= {"space", "earth"}
    assert all(0.0 <= float(row["phase_deg"]) <= 100.0 for row in drawn)


def test_image_pairs_of_a_target_with_markers_are_drawn_too(tmp_path: Path) -> None:
    needs_jit()
    table = {
        **SMALL,
        "images": "pairs",
        "frames": 2,
        "exposures_per_sun": 1,
        "target": [{"spacecraft": "maxar1300", "aim_m": [0.0, 0.0, 0.0]}],
        "camera": [{"name": "wide", "width": 64}],
        "pose": {"attitude": "approach", "cone_deg": 10.0, "range_m": [6.0, 9.0]},
        "background": {},
        "render": {"samples": 4, "marker_samples": 64},
    }
    result = api.dataset(write_spec(tmp_path, table), tmp_path / "out", workers=1)
    frames = sorted(path.name for path in (result.folders[0] / "frames").iterdir())
    assert frames == ["000000_800.png", "000000_850.png", "000001_800.png", "000001_850.png"]


def test_what_cannot_be_rendered_claims_no_folder(tmp_path: Path) -> None:
    table = {
        **SMALL,
        "images": "pairs",
        "target": [{"spacecraft": "maxar1300"}, {"spacecraft": "xmm"}],
    }
    with pytest.raises(ScenarioError, match=r'small\.toml: expected .* images = "pairs", xmm has'):
        api.dataset(write_spec(tmp_path, table), tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_mixed_dataset_killed_twice_with_its_processes_is_the_same(tmp_path: Path) -> None:
    """Sixty frames of three spacecraft and two cameras, five Suns a pose."""
    needs_jit()
    spec = write_spec(tmp_path, MIXED)
    assert api.dataset(spec, tmp_path / "whole", workers=2).left == 0
    out = tmp_path / "out"
    command = ["dataset", spec, "--out", out, "--workers", 2]
    for _ in range(2):
        kill_after_some_frames(command, out)
    code, said = rvbench(*command)
    assert code == 0, said
    assert files(out) == files(tmp_path / "whole")
    row = rows(out / "index.csv")[37]
    alone = tmp_path / "alone"
    api.dataset(spec, alone, workers=1, only=(37, 37))
    place = Path(row["folder"]) / "frames" / f"{int(row['frame']):06d}.png"
    assert (alone / place).read_bytes() == (out / place).read_bytes()


def kill_after_some_frames(command: list[object], out: Path) -> None:
    """Kill the process that leads as soon as it has some frames more."""
    import time

    from tests.support.patience import HANGS_S
    from tests.support.whole_runs import start

    there = len(list(out.glob("*/frames/*.png")))
    process = start(*command)
    until = time.monotonic() + HANGS_S
    while len(list(out.glob("*/frames/*.png"))) < there + 8:
        assert time.monotonic() < until
        assert process.poll() is None
        time.sleep(0.05)
    process.kill()
    process.communicate(timeout=HANGS_S)


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_spacecraft_of_ones_own_stand_beside_the_specification(tmp_path: Path) -> None:
    needs_jit()
    (tmp_path / "craft").mkdir()
    toml_of(textured_glb(tmp_path / "craft" / "boxsat.glb"))
    table = {
        **SMALL,
        "frames": 2,
        "exposures_per_sun": 1,
        "target": [{"spacecraft": "craft/boxsat.toml"}],
        "camera": [{"name": "bent", "width": 64, "height": 64, "fov_deg": 40.0, "k1": -0.1}],
        "pose": {"range_m": [6.0, 9.0], "in_view": "whole"},
    }
    spec = write_spec(tmp_path, table)
    result = api.dataset(spec, tmp_path / "out", workers=1)
    assert [folder.name for folder in result.folders] == ["boxsat-bent"]
    image = cv2.imread(str(result.folders[0] / "frames" / "000000.png"), cv2.IMREAD_UNCHANGED)
    assert image.max() > 3 * np.median(image)
    before = identities(tmp_path / "out")
    case = tmp_path / "out" / "truth" / "cases" / "boxsat-bent.toml"
    case.write_text(case.read_text().replace('files_sha256 = "', 'files_sha256 = "00')[:-2])
    with pytest.raises(DatasetError, match=r"boxsat-bent as it was .* files of its spacecraft"):
        api.dataset(spec, tmp_path / "out", workers=1)
    changed = identities(tmp_path / "out").items() - before.items()
    assert [name for name, _ in changed] == ["truth/cases/boxsat-bent.toml"]


def test_what_a_process_says_is_said_by_the_one_that_leads() -> None:
    error = pickle.loads(pickle.dumps(UnreadableError("place", "no text", 3)))
    assert (str(error), error.told, error.line) == ("place:3: no text", "in line 3: no text", 3)
