from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from models.arrays import Image
from models.atomic_file import write_bytes, write_text
from models.camera import CAMERAS
from models.dataset.dataset import (
    DatasetInfo,
    FrameEntry,
    detector_to_toml,
    encode_image,
    frames_to_csv,
    image_path,
    info_to_json,
    markers_to_toml,
    prior_to_toml,
    read_detector,
    read_frame,
    read_frame_entries,
    read_frames,
    read_image,
    read_info,
    read_knowledge,
    read_markers,
)
from models.errors import DatasetError, ScenarioError
from models.pose import RigidTransform, rotation_from_euler_321
from models.sensors.camera_chip import Detector
from models.spacecraft.retroreflector_layout import RETROREFLECTORS
from pipelines.chaser_fixed.knowledge import FlightKnowledge

EULER_ROUNDING = 1e-14  # the prior's attitude goes through three angles and back

INFO = DatasetInfo("maxar-demo", "S2", 2, "maxar1300", {"rvbench": "0.1.0"})
ENTRIES = [FrameEntry(0, 0.0, 41.5), FrameEntry(3, 1 / 3, 1e-3 / 7)]
KNOWLEDGE = FlightKnowledge(
    camera=replace(CAMERAS["chaser_fixed"], k1=-0.1),
    detector=replace(Detector(), read_noise_e=1 / 3),
    markers=RETROREFLECTORS,
    prior=RigidTransform(rotation_from_euler_321([-179.3, 1.2, 0.4]), np.array([0.1, 0.8, 6.6])),
    prior_sigma_m=np.array([0.017, 0.017, 0.05]),
    prior_sigma_deg=np.array([1.0, 1.0, 1.0]),
)


def noise_image(seed: int) -> Image:
    return np.random.default_rng(seed).integers(0, 4096, (24, 32)).astype(np.uint16)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Write a whole public half with two frames."""
    write_text(tmp_path / "dataset.json", info_to_json(INFO))
    write_text(tmp_path / "camera.toml", KNOWLEDGE.camera.to_toml())
    write_text(tmp_path / "detector.toml", detector_to_toml(KNOWLEDGE.detector))
    write_text(tmp_path / "markers.toml", markers_to_toml(KNOWLEDGE.markers))
    write_text(tmp_path / "prior.toml", prior_to_toml(KNOWLEDGE))
    write_text(tmp_path / "frames.csv", frames_to_csv(ENTRIES))
    for entry in ENTRIES:
        for band in (800, 850):
            image = noise_image(entry.index + band)
            write_bytes(image_path(tmp_path, entry.index, band), encode_image(image))
    return tmp_path


# Round trips


def test_the_info_comes_back(folder: Path) -> None:
    assert read_info(folder) == INFO


def test_flight_knowledge_comes_back(folder: Path) -> None:
    back = read_knowledge(folder)
    assert back.camera == KNOWLEDGE.camera
    assert back.detector == KNOWLEDGE.detector
    assert back.markers.names == RETROREFLECTORS.names
    assert back.markers.radius_m == RETROREFLECTORS.radius_m
    for ours, theirs in (
        (back.markers.points_in_target, RETROREFLECTORS.points_in_target),
        (back.markers.normals_in_target, RETROREFLECTORS.normals_in_target),
        (back.prior.translation, KNOWLEDGE.prior.translation),
        (back.prior_sigma_m, KNOWLEDGE.prior_sigma_m),
        (back.prior_sigma_deg, KNOWLEDGE.prior_sigma_deg),
    ):
        np.testing.assert_array_equal(ours, theirs)
    np.testing.assert_allclose(back.prior.rotation, KNOWLEDGE.prior.rotation, atol=EULER_ROUNDING)


def test_frames_come_back_in_order(folder: Path) -> None:
    assert read_frame_entries(folder) == ENTRIES
    for frame, entry in zip(read_frames(folder), ENTRIES, strict=True):
        assert (frame.index, frame.time_s, frame.exposure_ms) == (
            entry.index,
            entry.time_s,
            entry.exposure_ms,
        )
        np.testing.assert_array_equal(frame.image_800, noise_image(entry.index + 800))
        np.testing.assert_array_equal(frame.image_850, noise_image(entry.index + 850))


@given(arrays(np.uint16, st.tuples(st.integers(1, 9), st.integers(1, 9))))
def test_any_16_bit_image_survives_and_encodes_alike(image: Image) -> None:
    data = encode_image(image)
    assert data == encode_image(image.copy())
    decoded = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    np.testing.assert_array_equal(decoded, image)


def test_rewriting_gives_the_same_bytes(folder: Path) -> None:
    """All but the prior, whose angles round; its text is written once."""
    back = read_knowledge(folder)
    for name, text in (
        ("dataset.json", info_to_json(read_info(folder))),
        ("camera.toml", back.camera.to_toml()),
        ("detector.toml", detector_to_toml(back.detector)),
        ("markers.toml", markers_to_toml(back.markers)),
        ("frames.csv", frames_to_csv(read_frame_entries(folder))),
    ):
        assert (folder / name).read_text() == text
    for frame in read_frames(folder):
        path = image_path(folder, frame.index, 850)
        assert path.read_bytes() == encode_image(frame.image_850)


# dataset.json


def test_a_folder_without_a_dataset_is_told(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"expected a dataset in .*dataset\.json"):
        read_info(tmp_path)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"version": 2}, "expected version 1, got 2; render it again"),
        ({"version": None}, "expected version 1, got None"),
        ({"format": "bop"}, "expected format 'rvbench-pairs'"),
        ({"frames": "two"}, "expected frames as int, got 'two'"),
        ({"frames": True}, "expected frames as int, got True"),
        ({"case": None}, "expected case as str, got None"),
        ({"provenance": []}, r"expected provenance as dict, got \[\]"),
    ],
)
def test_another_kind_of_dataset_is_refused(
    folder: Path, change: dict[str, object], said: str
) -> None:
    table = json.loads((folder / "dataset.json").read_text())
    (folder / "dataset.json").write_text(json.dumps({**table, **change}))
    with pytest.raises(DatasetError, match=said):
        read_info(folder)


def test_a_missing_key_is_named(folder: Path) -> None:
    table = json.loads((folder / "dataset.json").read_text())
    del table["target"]
    (folder / "dataset.json").write_text(json.dumps(table))
    with pytest.raises(DatasetError, match="expected target as str, got 'none'"):
        read_info(folder)


@pytest.mark.parametrize("data", [b"", b"{", b"[1, 2]", b"\xff\xfe", b'"rvbench-pairs"'])
def test_an_info_that_is_not_ours_is_refused(folder: Path, data: bytes) -> None:
    (folder / "dataset.json").write_bytes(data)
    with pytest.raises(DatasetError, match=r"expected a dataset|expected format"):
        read_info(folder)


# Flight knowledge


@pytest.mark.parametrize("name", ["camera", "detector", "markers", "prior"])
def test_a_missing_file_is_named(folder: Path, name: str) -> None:
    (folder / f"{name}.toml").unlink()
    with pytest.raises((DatasetError, ScenarioError), match=rf"{name}\.toml.*No such file"):
        read_knowledge(folder)


@pytest.mark.parametrize("name", ["camera", "detector", "markers", "prior"])
@pytest.mark.parametrize("data", [b"radius_m = ", b"\xff\xfe\x00"])
def test_a_garbled_file_is_named(folder: Path, name: str, data: bytes) -> None:
    (folder / f"{name}.toml").write_bytes(data)
    with pytest.raises((DatasetError, ScenarioError), match=rf"{name}\.toml"):
        read_knowledge(folder)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("bits = 12\n", "", r"unknown: none; missing: bits"),
        ("bits = 12", "bits = 12\nbit = 12", r"unknown: bit; missing: none"),
        ("bits = 12", 'bits = "12"', "from zero up for bits, got '12'"),
        ("bits = 12", "bits = true", "from zero up for bits, got True"),
        ("prnu = 0.005", "prnu = -0.005", "from zero up for prnu, got -0.005"),
        ("prnu = 0.005", "prnu = nan", "from zero up for prnu, got nan"),
        ("prnu = 0.005", "prnu = inf", "from zero up for prnu, got inf"),
    ],
)
def test_a_detector_that_cannot_be_is_refused(folder: Path, old: str, new: str, said: str) -> None:
    path = folder / "detector.toml"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(DatasetError, match=said):
        read_detector(path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("radius_m = 0.0127\n", "", "no radius_m"),
        ("radius_m = 0.0127", "radius_m = -0.0127", "radius in m above zero"),
        ("[[marker]]", "[[markers]]", "no marker"),
        ('name = "2"', 'name = "1"', "each marker's name once"),
        ('name = "2"', 'nom = "2"', "no name"),
        ("    1.1,\n", "", "inhomogeneous"),
        ("    1.1,\n", "    nan,\n", "finite points"),
    ],
)
def test_markers_that_cannot_be_are_refused(folder: Path, old: str, new: str, said: str) -> None:
    path = folder / "markers.toml"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(DatasetError, match=rf"markers\.toml: expected radius_m.*{said}"):
        read_markers(path)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("t_cam_from_target_m = [0.1, 0.8]", r"\(2,\)"),
        ('t_cam_from_target_m = "near"', "near"),
        ("t_cam_from_target_m = [nan, 0.0, 6.7]", "finite pose"),
        ("euler_321_deg = [180.0, 0.0]", "values to unpack"),
        ("sigma_t_m = [0.017, 0.017]", "reshape"),
        ("sigma_euler_deg = [1.0, -1.0, 1.0]", "sigmas"),
        ("sigma_euler_deg = [1.0, inf, 1.0]", "sigmas"),
    ],
)
def test_a_prior_that_cannot_be_is_refused(folder: Path, line: str, said: str) -> None:
    key = line.split(" = ")[0]
    good = {
        "t_cam_from_target_m": "[0.1, 0.8, 6.7]",
        "euler_321_deg": "[180.0, 0.0, 0.0]",
        "sigma_t_m": "[0.1, 0.1, 0.1]",
        "sigma_euler_deg": "[1.0, 1.0, 1.0]",
    }
    lines = [line if name == key else f"{name} = {value}" for name, value in good.items()]
    (folder / "prior.toml").write_text("\n".join(lines))
    with pytest.raises(DatasetError, match=rf"prior\.toml: expected .*three numbers each.*{said}"):
        read_knowledge(folder)


@pytest.mark.parametrize("ahead_m", ["0", "-3.0", "1e9"])
def test_a_prior_that_no_camera_could_see_is_refused(folder: Path, ahead_m: str) -> None:
    path = folder / "prior.toml"
    path.write_text(
        f"t_cam_from_target_m = [0, 0, {ahead_m}]\neuler_321_deg = [180.0, 0.0, 0.0]\n"
        "sigma_t_m = [0.1, 0.1, 0.1]\nsigma_euler_deg = [1.0, 1.0, 1.0]\n"
    )
    with pytest.raises(DatasetError, match=r"prior\.toml: .*t_cam_from_target_m above 0 .*got"):
        read_knowledge(folder)


# Frames


def test_numpys_times_come_back_as_numbers(folder: Path) -> None:
    entries = [
        FrameEntry(np.int64(3), np.float64(0.1), np.float64(2.5)),
        FrameEntry(np.int64(4), np.float32(0.5), np.float64(1.0) / 3.0),
    ]
    (folder / "frames.csv").write_text(frames_to_csv(entries))
    assert read_frame_entries(folder) == entries


HEADER = "index,time_s,exposure_ms\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("index,time_s\n0,0.0\n", "no exposure_ms"),
        (HEADER + "0,0.0\n", "not 'NoneType'"),
        (HEADER + "zero,0.0,1.0\n", "invalid literal"),
        (HEADER + "0,nan,1.0\n", "finite time and a positive exposure"),
        (HEADER + "0,0.0,0.0\n", "finite time and a positive exposure"),
        (HEADER + "0,0.0,inf\n", "finite time and a positive exposure"),
        (HEADER + "1,0.0,1.0\n1,0.2,1.0\n", "rising indices and times"),
        (HEADER + "0,0.2,1.0\n1,0.2,1.0\n", "rising indices and times"),
    ],
)
def test_a_frame_list_that_cannot_be_is_refused(folder: Path, text: str, said: str) -> None:
    (folder / "frames.csv").write_text(text)
    with pytest.raises(DatasetError, match=rf"frames\.csv.*{said}"):
        read_frame_entries(folder)


def test_a_missing_or_binary_frame_list_is_refused(folder: Path) -> None:
    (folder / "frames.csv").write_bytes(b"index,time_s\xff\xfe\n")
    with pytest.raises(DatasetError, match=r"expected .*frames\.csv with the columns"):
        read_frame_entries(folder)
    (folder / "frames.csv").unlink()
    with pytest.raises(DatasetError, match=r"expected .*frames\.csv with the columns"):
        read_frame_entries(folder)


def test_a_dataset_of_no_frames_yields_none(folder: Path) -> None:
    (folder / "frames.csv").write_text(frames_to_csv([]))
    assert list(read_frames(folder)) == []


def test_a_missing_image_is_named(folder: Path) -> None:
    image_path(folder, 3, 850).unlink()
    with pytest.raises(DatasetError, match=r"expected an image at .*000003_850\.png.*No such file"):
        list(read_frames(folder))


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.99])
def test_a_truncated_image_is_refused(folder: Path, share: float) -> None:
    path = image_path(folder, 0, 800)
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    with pytest.raises(DatasetError, match=r"whole PNG at .*000000_800\.png.*render again"):
        read_frame(folder, ENTRIES[0])


@pytest.mark.parametrize("share", [0.05, 0.3, 0.6, 0.9])
def test_an_image_with_a_flipped_bit_is_refused(folder: Path, share: float) -> None:
    path = image_path(folder, 0, 800)
    data = bytearray(path.read_bytes())
    data[int(share * len(data))] ^= 0x10
    path.write_bytes(data)
    with pytest.raises(DatasetError, match=r"whole PNG at .*000000_800\.png"):
        read_frame(folder, ENTRIES[0])


def test_an_image_with_its_middle_cut_out_is_refused(folder: Path) -> None:
    path = image_path(folder, 0, 800)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2] + data[-12:])
    with pytest.raises(DatasetError, match="expected a whole PNG"):
        read_frame(folder, ENTRIES[0])


@pytest.mark.parametrize(
    ("image", "said"),
    [
        (np.zeros((4, 4), np.uint8), "of uint8"),
        (np.zeros((4, 4, 3), np.uint16), r"shape \(4, 4, 3\)"),
    ],
)
def test_an_image_of_another_kind_is_refused(tmp_path: Path, image: Image, said: str) -> None:
    path = tmp_path / "a.png"
    path.write_bytes(encode_image(image))
    with pytest.raises(DatasetError, match=f"expected a 16-bit single-channel image .*{said}"):
        read_image(path)


def test_a_picture_that_is_no_png_is_refused(tmp_path: Path) -> None:
    ok, data = cv2.imencode(".jpg", np.zeros((8, 8), np.uint8))
    assert ok
    (tmp_path / "a.png").write_bytes(data.tobytes())
    with pytest.raises(DatasetError, match="expected a whole PNG"):
        read_image(tmp_path / "a.png")


def test_two_images_of_different_size_are_refused(folder: Path) -> None:
    image_path(folder, 0, 850).write_bytes(encode_image(noise_image(0)[:10]))
    with pytest.raises(DatasetError, match="expected two images of one size"):
        read_frame(folder, ENTRIES[0])
