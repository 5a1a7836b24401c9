"""A dataset opened: frames as a flight computer gets them, whole or refused, old or new."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.dataset.dataset import open_dataset
from models.dataset.description import DatasetInfo, Stream, info_to_json, read_info
from models.dataset.estimates_file import write_estimates
from models.dataset.frame_table import frames_to_csv
from models.dataset.image_file import encode_image
from models.errors import DatasetError, ScenarioError
from models.estimate import Estimate, PoseEstimate
from models.frame import (
    CHASER_ORBIT,
    IMAGE,
    IMAGE_800,
    IMAGE_850,
    Frame,
    ImageReading,
    TableReading,
)
from models.pose import RigidTransform
from tests.support.public_halves import (
    CAMERA,
    ENTRIES,
    IMAGES,
    ORBIT,
    PAIRS,
    as_version_1,
    noise_image,
    write_pairs,
    write_single_images,
)

FORMATS: dict[str, tuple[Callable[[Path], Path], DatasetInfo]] = {
    "rvbench-pairs": (write_pairs, PAIRS),
    "rvbench-images": (write_single_images, IMAGES),
}


@pytest.fixture(params=FORMATS)
def name(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture
def folder(tmp_path: Path, name: str) -> Path:
    return FORMATS[name][0](tmp_path / "data")


@pytest.fixture
def pairs(tmp_path: Path) -> Path:
    return write_pairs(tmp_path / "pairs")


def assert_same_frames(one: list[Frame], other: list[Frame]) -> None:
    assert [(f.index, f.time_s) for f in one] == [(f.index, f.time_s) for f in other]
    for ours, theirs in zip(one, other, strict=True):
        assert ours.readings.keys() == theirs.readings.keys()
        for stream, reading in ours.readings.items():
            same = theirs.readings[stream]
            assert type(reading) is type(same)
            for name, value in vars(reading).items():
                np.testing.assert_array_equal(value, getattr(same, name))


# What is written comes back.


def test_pairs_come_back_in_order(pairs: Path) -> None:
    dataset = open_dataset(pairs)
    assert dataset.info == PAIRS
    assert tuple(dataset.entries) == ENTRIES
    assert dataset.indices == [0, 3]
    for frame, entry in zip(dataset.frames(), ENTRIES, strict=True):
        assert (frame.index, frame.time_s) == (entry.index, entry.time_s)
        assert list(frame.readings) == [IMAGE_800, IMAGE_850]
        for number, (stream, after_s) in enumerate([(IMAGE_800, -0.033), (IMAGE_850, 0.0)]):
            reading = frame.image(stream)
            assert reading.exposure_ms == entry.exposure_ms
            assert reading.time_s == entry.time_s + after_s
            np.testing.assert_array_equal(reading.image, noise_image(10 * entry.index + number))


def test_images_come_back_with_what_the_chaser_believes(tmp_path: Path) -> None:
    dataset = open_dataset(write_single_images(tmp_path))
    for frame, entry in zip(dataset.frames(), ENTRIES, strict=True):
        np.testing.assert_array_equal(frame.image(IMAGE).image, noise_image(10 * entry.index))
        orbit = frame.table(CHASER_ORBIT)
        np.testing.assert_array_equal(orbit.rows, ORBIT[entry.index].rows)
        assert orbit.time_s.tolist() == [entry.time_s]


def test_one_frame_is_that_of_all(folder: Path) -> None:
    dataset = open_dataset(folder)
    assert_same_frames([dataset.frame(3)], list(dataset.frames())[1:])
    with pytest.raises(DatasetError, match=r"one of its 2 frames \(0 to 3\), got 1"):
        dataset.frame(1)
    with pytest.raises(DatasetError, match="got 4"):
        dataset.entry(4)


def test_rewriting_gives_the_same_bytes(folder: Path) -> None:
    dataset = open_dataset(folder)
    assert (folder / "dataset.json").read_text() == info_to_json(dataset.info)
    assert (folder / "frames.csv").read_text() == frames_to_csv(dataset.entries)
    for frame in dataset.frames():
        for stream in dataset.info.image_streams:
            data = encode_image(frame.image(stream.name).image)
            assert stream.path(folder, frame.index).read_bytes() == data


def test_version_1_gives_the_same_frames(folder: Path, name: str) -> None:
    new = open_dataset(folder)
    before = list(new.frames())
    as_version_1(folder, name)
    old = open_dataset(folder)
    assert old.info.chain == new.info.chain
    assert old.onboard.camera == new.onboard.camera
    assert (old.onboard.markers is None) == (new.onboard.markers is None)
    assert (old.onboard.wireframe is None) == (new.onboard.wireframe is None)
    assert_same_frames(list(old.frames()), before)


# Whole, or refused.


@pytest.mark.parametrize("rows", [0, 1, 3])
def test_a_frame_list_of_another_length_is_refused(folder: Path, rows: int) -> None:
    entries = [*ENTRIES, replace(ENTRIES[-1], index=7, time_s=9.0)][:rows]
    (folder / "frames.csv").write_text(frames_to_csv(entries))
    with pytest.raises(DatasetError, match=rf"frames\.csv: expected the 2 frames .*, got {rows}"):
        open_dataset(folder)


@pytest.mark.parametrize("stream", [IMAGE_800, IMAGE_850])
def test_images_of_another_size_than_the_cameras_are_refused(pairs: Path, stream: str) -> None:
    dataset = open_dataset(pairs)
    dataset.check_images()
    path = dataset.info.stream(stream).path(pairs, 3)
    path.write_bytes(encode_image(noise_image(0)[:10]))
    said = rf"{path.name}: expected 32 x 32 pixels, as camera\.toml has, got 32 x 10"
    with pytest.raises(DatasetError, match=said):
        dataset.check_images()
    with pytest.raises(DatasetError, match=said):
        list(dataset.frames())


def test_where_no_camera_is_on_board_images_may_have_any_size(pairs: Path) -> None:
    info = replace(PAIRS, onboard=("prior.toml",))
    (pairs / "dataset.json").write_text(info_to_json(info))
    dataset = open_dataset(pairs)
    info.image_streams[0].path(pairs, 3).write_bytes(encode_image(noise_image(0)[:10]))
    dataset.check_images()
    assert dataset.frame(3).image(IMAGE_800).image.shape == (10, CAMERA.width)
    assert dataset.frame(3).image(IMAGE_850).image.shape == (CAMERA.height, CAMERA.width)


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir, lambda path: None])
def test_an_image_that_is_no_file_is_named(folder: Path, make: Callable[[Path], object]) -> None:
    dataset = open_dataset(folder)
    path = dataset.info.image_streams[-1].path(folder, 3)
    path.unlink()
    make(path)
    for read in (dataset.check_images, lambda: list(dataset.frames())):
        with pytest.raises(DatasetError, match=rf"expected an image at .*{path.name}, got: "):
            read()


@pytest.mark.parametrize("share", [0.0, 0.5, 0.99])
def test_a_truncated_image_is_refused(folder: Path, share: float) -> None:
    dataset = open_dataset(folder)
    path = dataset.info.image_streams[0].path(folder, 0)
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    with pytest.raises(DatasetError, match=rf"whole PNG at .*{path.name}.*render again"):
        dataset.frame(0)


@pytest.mark.parametrize("name", ["dataset.json", "frames.csv", "camera.toml"])
def test_a_list_that_is_a_pipe_is_not_waited_for(pairs: Path, name: str) -> None:
    (pairs / name).unlink()
    os.mkfifo(pairs / name)
    with pytest.raises((DatasetError, ScenarioError), match=rf"{name}.*a pipe"):
        list(open_dataset(pairs).frames())


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


ORBIT_ROW = f"\n3,{ENTRIES[1].time_s!r}"
DAMAGE: dict[str, tuple[str, str, str]] = {
    "without a column": ("vz_m_s", "w", r"missing: vz_m_s; unknown: 'w'"),
    "of other frames": (ORBIT_ROW, ORBIT_ROW.replace("3,", "7,", 1), "number of a frame .*, got 7"),
    "of another time": (ORBIT_ROW, "\n3,3.5", r"up to frame 3's, .*; got 3\.5 s"),
    "not finite": (ORBIT_ROW, "\n3,nan", "time_s to be a number, got 'nan'"),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_table_is_named(tmp_path: Path, damage: str) -> None:
    folder = write_single_images(tmp_path)
    old, new, said = DAMAGE[damage]
    edit(folder / "navigation.csv", old, new)
    with pytest.raises(DatasetError, match=rf"navigation\.csv.*{said}"):
        list(open_dataset(folder).frames())


# Estimates of another pipeline as readings.


def said_at(frame: int, time_s: float) -> Estimate:
    pose = PoseEstimate(RigidTransform(np.eye(3), np.array([0.0, 0.0, 5.0 + time_s])))
    return Estimate(frame, time_s, pose, mode="tracked")


def with_estimates(folder: Path, estimates: list[Estimate]) -> None:
    stream = Stream("coarse", "estimates", "estimates/coarse.jsonl")
    info = read_info(folder)
    (folder / "dataset.json").write_text(
        info_to_json(replace(info, streams=(*info.streams, stream)))
    )
    write_estimates(stream.path(folder), estimates)


def test_another_pipelines_estimates_are_readings(folder: Path) -> None:
    """The last one that is not later than the frame: what is not yet said cannot be known."""
    early, late = said_at(0, 0.1), said_at(3, 1 / 3)
    with_estimates(folder, [early, late, said_at(4, 0.5)])
    first, second = open_dataset(folder).frames()
    assert "coarse" not in first.readings  # nothing was said by then
    assert second.estimate("coarse").frame == 3
    write_estimates(folder / "estimates" / "coarse.jsonl", [said_at(0, -1.0), said_at(1, 0.1)])
    first, second = open_dataset(folder).frames()
    assert first.estimate("coarse").time_s == -1.0
    pose = second.estimate("coarse").pose
    assert pose is not None
    assert pose.cam_from_target.translation[2] == 5.1


def test_estimates_that_are_not_there_are_told(folder: Path) -> None:
    with_estimates(folder, [])
    assert all("coarse" not in frame.readings for frame in open_dataset(folder).frames())
    (folder / "estimates" / "coarse.jsonl").unlink()
    with pytest.raises(DatasetError, match=r"expected an estimates file at .*coarse\.jsonl"):
        list(open_dataset(folder).frames())


# Fingerprints.


def test_a_fingerprint_changes_with_any_file_that_it_stands_for(folder: Path) -> None:
    dataset = open_dataset(folder)
    info, before = dataset.info, (dataset.fingerprint(), dataset.content_fingerprint())
    tables = [each.files for each in info.streams if each.kind != "image"]
    for name in ("dataset.json", "frames.csv", *info.onboard, *tables):
        data = (folder / name).read_bytes()
        (folder / name).write_bytes(data + b"\n")
        assert dataset.fingerprint() != before[0], name
        assert dataset.content_fingerprint() != before[1], name
        (folder / name).write_bytes(data)
    assert (dataset.fingerprint(), dataset.content_fingerprint()) == before
    info.image_streams[-1].path(folder, 3).write_bytes(encode_image(noise_image(99)))
    assert dataset.fingerprint() == before[0]
    assert dataset.content_fingerprint() != before[1]


def test_truth_and_estimates_are_of_no_fingerprint(folder: Path) -> None:
    before = open_dataset(folder).content_fingerprint()
    (folder / "truth").mkdir()
    (folder / "truth" / "exposures.jsonl").write_text("{}\n")
    write_estimates(folder / "estimates" / "best.jsonl", [said_at(0, 0.0)])
    assert open_dataset(folder).content_fingerprint() == before


def test_the_kinds_of_readings_are_those_of_the_streams(folder: Path) -> None:
    kinds = {"image": ImageReading, "table": TableReading}
    dataset = open_dataset(folder)
    table = json.loads((folder / "dataset.json").read_text())["streams"]
    for frame in dataset.frames():
        found = {name: type(reading) for name, reading in frame.readings.items()}
        assert found == {name: kinds[told["kind"]] for name, told in table.items()}
    assert dataset.onboard.camera == CAMERA
