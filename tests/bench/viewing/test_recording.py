"""A recording for Rerun's viewer: cameras where they were, errors as scored, or what to install.

What its SDK is given is looked at here; the file itself, with the real one, by hand.
"""

from __future__ import annotations

import sys

import cv2
import numpy as np
import pytest

from bench import api, cli
from tests.support import recording_sdk
from tests.support.synthetic_dataset import (
    lost_estimate,
    perfect_estimate,
    solved_estimate,
    write_dataset,
    write_variant,
)

LOST = 1


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    made = write_dataset(tmp_path_factory.mktemp("recorded") / "set", 3, width_px=64)
    rng = np.random.default_rng(2)
    write_variant(
        made, "best",
        lambda truth: lost_estimate(truth) if truth.frame == LOST else perfect_estimate(truth),
    )  # fmt: skip
    write_variant(made, "paper", lambda truth: solved_estimate(made, truth, np.full(2, 0.3), rng))
    return made


@pytest.fixture(scope="module")
def score(dataset):
    return api.score(dataset.folder)


@pytest.fixture
def stream(dataset, score, tmp_path, monkeypatch, capsys):
    sdk = recording_sdk.install(monkeypatch)
    path = tmp_path / "of it.rrd"
    assert cli.main(["view", str(dataset.folder), "--rerun", str(path)]) == 0
    assert str(path) in capsys.readouterr().out
    assert path.read_bytes() == b"a recording"
    assert sdk.streams[0].now == {"ended": 1.0}
    return sdk.streams[0]


def test_a_marker_seen_through_the_recorded_camera_lies_in_its_pixel(dataset, stream):
    (markers, _), = stream.of("Points3D", "target", "markers")  # fmt: skip
    poses = stream.of("Transform3D", "camera", "true")
    lenses = stream.of("Pinhole", "camera", "true")
    assert [when["frame"] for _, when in poses] == [0, 1, 2]
    for truth, (pose, _), (lens, _) in zip(dataset.truths, poses, lenses, strict=True):
        away = np.asarray(markers.given[0]) - pose.named["translation"]
        in_camera = away @ pose.named["mat3x3"]  # its transpose, from the left
        homogeneous = in_camera @ np.asarray(lens.named["image_from_camera"]).T
        pixels = homogeneous[:, :2] / homogeneous[:, 2:]
        np.testing.assert_allclose(pixels, truth.markers_px + 0.5, atol=1e-5)
        assert lens.named["resolution"] == [dataset.camera.width, dataset.camera.height]


def test_a_lost_frame_has_no_camera_and_its_reason(dataset, stream):
    assert [when["frame"] for _, when in stream.of("Transform3D", "camera", "best")] == [0, 2]
    assert [when["frame"] for _, when in stream.of("Clear", "camera", "best")] == [LOST]
    (said, when), = stream.of("TextLog", "lost", "best")  # fmt: skip
    assert (said.given, when) == (
        (lost_estimate(dataset.truths[LOST]).reason,),
        {"frame": LOST, "time": dataset.entries[LOST].time_s},
    )
    assert stream.of("TextLog", "lost", "paper") == []


@pytest.mark.parametrize("label", ["best", "paper"])
def test_errors_are_those_of_the_score(score, stream, label):
    there = stream.of("Scalars", "plots", "position error [mm]", label)
    rows = [row for row in score["pipelines"][label]["per_frame"] if row["reason"] is None]
    assert [(shown.given[0], when["frame"]) for shown, when in there] == [
        ([row["position_error_mm"]], row["frame"]) for row in rows
    ]
    bands = stream.of("Scalars", "plots", "position along x [mm]", f"{label}: 3 sigma stated")
    assert bands
    assert all(upper == -lower > 0 for (shown, _) in bands for upper, lower in shown.given)


def test_the_pictures_are_those_of_the_cameras_with_their_marks(dataset, stream):
    for name in ("850 nm", "800 nm"):
        pictures = stream.of("EncodedImage", "camera", "true", name)
        assert len(pictures) == 3
        image = cv2.imdecode(np.frombuffer(pictures[0][0].named["contents"], np.uint8), 0)
        assert image.shape == (dataset.camera.height, dataset.camera.width)
    lit = cv2.imdecode(np.frombuffer(
        stream.of("EncodedImage", "camera", "true", "850 nm")[0][0].named["contents"], np.uint8), 0
    )  # fmt: skip
    (marks, _), *_ = stream.of("Points2D", "camera", "true", "marks", "detections")
    rows_columns = np.floor(marks.given[0]).astype(int)[:, ::-1]
    assert min(lit[row, column] for row, column in rows_columns) > 2 * np.median(lit)


def test_without_the_package_it_says_what_to_install(dataset, score, tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "rerun", None)
    assert cli.main(["view", str(dataset.folder), "--rerun", str(tmp_path / "x.rrd")]) == 2
    assert "pip install rerun-sdk" in capsys.readouterr().err
    assert not (tmp_path / "x.rrd").exists()


def test_one_too_old_is_told(dataset, score, tmp_path, monkeypatch, capsys):
    recording_sdk.install(monkeypatch).__version__ = "0.29.2"
    assert cli.main(["view", str(dataset.folder), "--rerun", str(tmp_path / "x.rrd")]) == 2
    assert "found 0.29.2" in capsys.readouterr().err


def test_what_has_no_score_says_so(tmp_path, monkeypatch, capsys):
    recording_sdk.install(monkeypatch)
    folder = write_dataset(tmp_path / "set", 1, images=False, width_px=64).folder
    assert cli.main(["view", str(folder), "--rerun", str(tmp_path / "x.rrd")]) == 2
    assert "rvbench score" in capsys.readouterr().err
    assert not (tmp_path / "x.rrd").exists()
