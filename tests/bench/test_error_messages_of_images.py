"""What a user of single images meets, word for word: what pairs have in ``test_cli``, images get.

The messages are kept in ``error_messages_of_images.json``, and written anew in the same way.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from bench import api
from bench.cli import main
from bench.estimating.runs import estimates_path
from bench.estimating.tumble.starts import starts_path
from models.dataset.estimates_file import write_estimates
from models.estimate import Detections, Estimate, PoseEstimate
from tests.support.bad_input import (
    Spoil,
    change_json,
    compare_with_snapshot,
    cut,
    cut_last_line,
    lasting,
    make_8_bit,
    nothing,
    replace,
    shift_times,
    shrink,
)
from tests.support.synthetic_images import write_images

SNAPSHOTS = Path(__file__).with_name("error_messages_of_images.json")


@pytest.fixture(scope="module")
def scored_images(tmp_path_factory) -> Path:
    """Return a dataset whose estimates say the truth, scored."""
    dataset = write_images(tmp_path_factory.mktemp("images") / "data", frames=3, width_px=128)
    said = [
        Estimate(
            truth.frame,
            truth.time_s,
            PoseEstimate(truth.cam_from_target),
            detections=Detections.none(),
            mode="tracked",
            states=truth.state.named(None, None),
        )
        for truth in dataset.truths
    ]
    for label in ("best", "paper"):
        write_estimates(estimates_path(dataset.folder, 0, label), said)
    api.score(dataset.folder)
    return dataset.folder


@pytest.fixture
def folder(scored_images, tmp_path) -> Path:
    copy = tmp_path / "DIR"
    shutil.copytree(scored_images, copy)
    return copy


def write_starts(folder: Path, text: str) -> None:
    path = starts_path(folder, "best")
    path.parent.mkdir()
    path.write_text(text)


def add_column(path: Path) -> None:
    path.write_text("".join(f"{line},0\n" for line in path.read_text().splitlines()))


START = {
    "frame": 0, "images": 1, "pose_frame": 99, "seconds": 1.0, "reason": "",
    "cam_from_target": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 30]],
}  # fmt: skip
BAD_IMAGES: dict[str, tuple[Spoil, str]] = {
    "a dataset of another version": (
        lambda d: replace(d / "dataset.json", '"version": 2', '"version": 99'), "estimate DIR"),
    "no dataset.json": (lambda d: (d / "dataset.json").unlink(), "estimate DIR"),
    "no frames.csv": (lambda d: (d / "frames.csv").unlink(), "estimate DIR"),
    "fewer frames than told": (lambda d: cut_last_line(d / "frames.csv"), "estimate DIR"),
    "fewer frames than told, scored": (lambda d: cut_last_line(d / "frames.csv"), "score DIR"),
    "a missing frame": (lambda d: (d / "frames/000000.png").unlink(), "estimate DIR"),
    "a truncated frame": (lambda d: cut(d / "frames/000000.png"), "estimate DIR"),
    "a frame of another size": (lambda d: shrink(d / "frames/000000.png"), "estimate DIR"),
    "a frame of another size, scored": (lambda d: shrink(d / "frames/000002.png"), "score DIR"),
    "an 8-bit frame": (lambda d: make_8_bit(d / "frames/000000.png"), "estimate DIR"),
    "no frames at all": (
        lambda d: (d / "frames.csv").write_text("index,time_s,exposure_ms\n"), "estimate DIR"),
    "a camera of no width": (
        lambda d: replace(d / "camera.toml", "width = 128", "width = -128"), "estimate DIR"),
    "a detector without gain": (
        lambda d: replace(d / "detector.toml", "gain_e_dn = 26.0", "gain_e_dn = 0.0"),
        "estimate DIR"),
    "a broken camera": (
        lambda d: replace(d / "camera.toml", "fx = ", "focal = "), "estimate DIR"),
    "no mount": (
        lambda d: replace(d / "knowledge.toml", "R_cam_from_lvlh", "R_cam"), "estimate DIR"),
    "a mount that is no rotation": (
        lambda d: replace(d / "knowledge.toml", "1.0", "2.0"), "estimate DIR"),
    "a range the wrong way round": (
        lambda d: replace(d / "knowledge.toml", "29.0", "290.0"), "estimate DIR"),
    "half a wireframe": (lambda d: cut(d / "wireframe.json"), "estimate DIR"),
    "no wireframe": (lambda d: (d / "wireframe.json").unlink(), "estimate DIR"),
    "a wireframe that is not told of": (
        lambda d: change_json(
            d / "dataset.json", "onboard", to=["camera.toml", "detector.toml", "knowledge.toml"]),
        "estimate DIR"),
    "no orbit": (lambda d: (d / "navigation.csv").unlink(), "estimate DIR"),
    "an orbit with a column too many": (
        lambda d: add_column(d / "navigation.csv"), "estimate DIR"),
    "an orbit without a frame's row": (
        lambda d: (d / "navigation.csv").write_text(
            (d / "navigation.csv").read_text().splitlines()[0] + "\n"), "estimate DIR"),
    "an orbit of no number": (
        lambda d: replace(d / "navigation.csv", "\n0,0.0,", "\n0,soon,"), "estimate DIR"),
    "no such pipeline": (nothing, "estimate DIR --pipelines bset"),
    "a pipeline of other streams": (nothing, "estimate DIR --pipelines chaser_fixed"),
    "options of pairs with a dataset": (nothing, "estimate DIR --target xmm"),
    "no estimates": (lambda d: shutil.rmtree(d / "estimates"), "score DIR"),
    "no truth": (lambda d: shutil.rmtree(d / "truth"), "score DIR"),
    "a broken estimate": (
        lambda d: (d / "estimates/best.jsonl").write_text('{"frame": 0}\n'), "score DIR"),
    "estimates of other times": (
        lambda d: shift_times(d / "estimates/best.jsonl"), "score DIR"),
    "an estimate missing": (lambda d: cut_last_line(d / "estimates/best.jsonl"), "score DIR"),
    "a binary truth": (
        lambda d: (d / "truth/exposures.jsonl").write_bytes(b"\xff\xfe"), "score DIR"),
    "half a truth": (lambda d: cut(d / "truth/exposures.jsonl"), "score DIR"),
    "a truth that lacks a frame": (
        lambda d: cut_last_line(d / "truth/exposures.jsonl"), "score DIR"),
    "limits that cannot be": (
        lambda d: (d / "truth/scenario.toml").write_text(
            "[limits]\nwrong_position_m = 1.0\nwrong_attitude_deg = 181.0\n"), "score DIR"),
    "broken runtimes": (
        lambda d: (d / "estimates/best.runtime.csv").write_text("a\n1,2,3\n"), "score DIR"),
    "half of the starts": (lambda d: write_starts(d, '{"most_images": 3'), "score DIR"),
    "starts of other frames": (
        lambda d: write_starts(d, json.dumps({"most_images": 3, "starts": [START]})),
        "score DIR"),
    "half a score": (lambda d: cut(d / "score.json"), "report DIR"),
    "a score without its state": (
        lambda d: change_json(d / "score.json", "pipelines", "best", "parts", "state"),
        "report DIR"),
    "a score of version 1": (
        lambda d: [change_json(d / "score.json", "version", to=1),
                   change_json(d / "score.json", "format", to="rvbench-tumble-score")],
        "report DIR"),
    "a score of other estimates": (
        lambda d: cut_last_line(d / "estimates/best.jsonl"), "report DIR"),
    "no score": (lambda d: (d / "score.json").unlink(), "report DIR"),
    "no such frame": (nothing, "show DIR 77"),
    "no such variant": (nothing, "show DIR 0 --variant bset"),
    "another version shown": (
        lambda d: replace(d / "dataset.json", '"version": 2', '"version": 99'), "show DIR 0"),
    "a wireframe broken, shown": (lambda d: cut(d / "wireframe.json"), "show DIR 0"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD_IMAGES)
def test_bad_images_get_one_clear_message(case, folder, tmp_path, capsys, monkeypatch):
    """One message, exit code 2, no traceback; the words are those on record."""
    spoil, command = BAD_IMAGES[case]
    spoil(folder)
    monkeypatch.chdir(tmp_path)
    assert main(command.split()) == 2
    told = capsys.readouterr().err
    assert "Traceback" not in told
    message = told[told.index("rvbench: ") :].strip()
    assert "\n" not in message
    compare_with_snapshot(SNAPSHOTS, BAD_IMAGES, case, lasting(message, tmp_path))


def test_nothing_is_lost_when_estimating_fails(folder):
    cut(folder / "frames" / "000000.png")
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    assert main(["estimate", str(folder)]) == 2
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


def test_score_report_show(folder, capsys):
    assert main(["score", str(folder), "--fail-above-mm", "0.001"]) == 0
    assert "pose alone, position" in capsys.readouterr().out
    assert main(["report", str(folder)]) == 0
    assert main(["show", str(folder), "2"]) == 0
    assert (folder / "show" / "000002_best.png").is_file()
