"""Anybody's image pairs: taken as they come, or refused with a reason that can be acted on."""

import os
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from bench.estimating.estimation import estimate_dataset
from bench.estimating.foreign_frames import (
    estimate_frames,
    find_frames,
    read_frames,
)
from bench.estimating.foreign_images import read_foreign_image
from bench.estimating.foreign_knowledge import (
    GivenFiles,
    guessed_detector,
    markers_and_wireframe,
)
from models.camera import Camera
from models.dataset.estimates_file import read_estimates
from models.errors import DatasetError, ScenarioError
from models.frame import IMAGE_850
from models.pose import pose_error
from tests.support.synthetic_dataset import SyntheticDataset, image_path, write_dataset
from tests.support.synthetic_images import SyntheticImages, write_images

THREE_MILLIMETRES = 3e-3  # eight bits leave 256 levels: about ten times the bound at 3 m
RATE_HZ = 0.1  # of the synthetic dataset


@pytest.fixture
def pairs(tmp_path) -> tuple[SyntheticDataset, object]:
    """Write the synthetic frames as 8-bit pairs with names of their own, and a prior beside."""
    dataset = write_dataset(tmp_path / "data", frames=3)
    folder = tmp_path / "pairs"
    folder.mkdir()
    for entry in dataset.entries:
        for band in (800, 850):
            image = cv2.imread(
                str(image_path(dataset.folder, entry.index, band)), cv2.IMREAD_UNCHANGED
            )
            name = folder / f"shot{entry.index + 9}_{band}.png"
            cv2.imwrite(str(name), (image // 16).astype(np.uint8))
    (tmp_path / "prior.toml").write_text((dataset.folder / "prior.toml").read_text())
    return dataset, folder


def run(dataset: SyntheticDataset, folder, **changes) -> list:
    options = {"given": GivenFiles("maxar1300"), "rate_hz": RATE_HZ, "out": folder}
    return estimate_frames(folder, dataset.camera, **{**options, **changes})


def test_eight_bit_pairs_of_any_name(pairs):
    dataset, folder = pairs
    paths = run(dataset, folder)
    assert [path.name for path in paths] == ["paper.jsonl", "best.jsonl"]
    estimates = read_estimates(paths[1])
    assert [estimate.frame for estimate in estimates] == [0, 1, 2]
    for estimate, truth in zip(estimates, dataset.truths, strict=True):
        assert estimate.pose, estimate
        error = pose_error(estimate.pose.cam_from_target, truth.cam_from_target)
        assert np.linalg.norm(error.position_m) < THREE_MILLIMETRES


def test_pairs_are_taken_in_the_order_of_their_numbers(pairs):
    _, folder = pairs
    names = [pair.paths[IMAGE_850].name for pair in find_frames(folder, RATE_HZ)]
    assert names == ["shot9_850.png", "shot10_850.png", "shot11_850.png"]


def test_times_come_from_the_rate_or_from_a_file(pairs):
    dataset, folder = pairs
    assert [pair.entry.time_s for pair in find_frames(folder, 0.5)] == [0.0, 2.0, 4.0]
    (folder / "frames.csv").write_text((dataset.folder / "frames.csv").read_text())
    assert [pair.entry.time_s for pair in find_frames(folder, 0.5)] == [0.0, 10.0, 20.0]
    (folder / "frames.csv").write_text("index,time_s,exposure_ms\n0,0.0,1.0\n")
    with pytest.raises(DatasetError, match="one row for each of 3 frames, got 1"):
        find_frames(folder, 0.5)


def test_markers_from_a_file(pairs):
    dataset, _ = pairs
    named, _ = markers_and_wireframe("maxar1300")
    from_file, _ = markers_and_wireframe(str(dataset.folder / "markers.toml"))
    assert named is not None
    assert from_file is not None
    assert from_file.names == named.names
    assert np.array_equal(from_file.points_in_target, named.points_in_target)
    with pytest.raises(ScenarioError, match="which has none"):
        markers_and_wireframe("chaser")
    with pytest.raises(ScenarioError, match="expected a spacecraft among"):
        markers_and_wireframe("maxar1400")


def test_no_prior_is_said_so(pairs, tmp_path):
    dataset, folder = pairs
    (tmp_path / "prior.toml").unlink()
    with pytest.raises(
        DatasetError, match=r"expected prior\.toml .*, got none; it tracks from a first pose"
    ):
        run(dataset, folder)
    assert not (folder / "estimates").exists()


def test_a_pair_without_its_other_image(pairs):
    dataset, folder = pairs
    (folder / "shot10_800.png").unlink()
    with pytest.raises(DatasetError, match=r"expected shot10_800\.png beside shot10_850\.png"):
        run(dataset, folder)


def test_no_pairs_at_all(tmp_path):
    with pytest.raises(DatasetError, match="found none"):
        find_frames(tmp_path, 1.0)


def test_another_cameras_images(pairs):
    dataset, folder = pairs
    with pytest.raises(DatasetError, match="expected 256 x 256 pixels, as the camera has"):
        list(read_frames(find_frames(folder, 1.0), dataset.camera.resized(256)))


def rewritten(folder: Path, suffix: str) -> None:
    """Write every image of a folder again as another kind of file."""
    for path in list(folder.glob("*.png")):
        image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        path.unlink()
        ok, data = cv2.imencode(suffix.lower(), image, [cv2.IMWRITE_JPEG_QUALITY, 100])
        assert ok
        path.with_suffix(suffix).write_bytes(data.tobytes())


@pytest.mark.parametrize("suffix", [".PNG", ".tif", ".TIFF", ".jpg", ".JPEG"])
def test_pairs_of_other_kinds_and_cases(pairs, suffix, capsys):
    dataset, folder = pairs
    rewritten(folder, suffix)
    best = read_estimates(run(dataset, folder)[1])
    for estimate, truth in zip(best, dataset.truths, strict=True):
        error = pose_error(estimate.pose.cam_from_target, truth.cam_from_target)
        assert np.linalg.norm(error.position_m) < THREE_MILLIMETRES
    warned = "there are JPEGs among these images" in capsys.readouterr().err
    assert warned == suffix.lower().startswith(".jp")


def test_what_was_seen_instead_is_told(pairs):
    _, folder = pairs
    for path in list(folder.iterdir()):
        path.rename(path.with_suffix(".bmp"))
    (folder / "notes.txt").touch()
    with pytest.raises(DatasetError, match=r"none among 6 \.bmp, 1 \.txt, such as notes"):
        find_frames(folder, 1.0)


def test_two_images_for_one_place(pairs):
    _, folder = pairs
    shutil.copy(folder / "shot9_850.png", folder / "shot9_850.PNG")
    with pytest.raises(DatasetError, match=r"expected one image shot9_850, found .*; take one"):
        find_frames(folder, 1.0)


@pytest.mark.parametrize("suffix", [".png", ".tif"])
def test_one_detector_took_them_all(pairs, suffix):
    """A PNG of other bits is refused before the first frame, another file when it is read."""
    dataset, folder = pairs
    rewritten(folder, suffix)
    last = folder / f"shot11_800{suffix}"
    image = cv2.imread(str(last), cv2.IMREAD_UNCHANGED).astype(np.uint16)
    cv2.imwrite(str(last), 257 * image)
    with pytest.raises(DatasetError, match=f"shot11_800{suffix}: expected 8 bits, .*, got 16"):
        run(dataset, folder)
    assert not (folder / "estimates").exists()


def test_a_later_image_of_another_size_is_found_before_the_first_is_read(pairs, monkeypatch):
    dataset, folder = pairs
    cv2.imwrite(str(folder / "shot11_850.png"), np.zeros((64, 64), np.uint8))
    monkeypatch.setattr("bench.estimating.foreign_frames.estimate_run", None)
    with pytest.raises(DatasetError, match=r"shot11_850\.png: expected 512 x 512 pixels"):
        run(dataset, folder)


def test_a_pipe_is_no_image(tmp_path):
    os.mkfifo(tmp_path / "a_850.png")
    with pytest.raises(DatasetError, match="found something that is no file"):
        read_foreign_image(tmp_path / "a_850.png")


@pytest.mark.parametrize("rate_hz", [0.0, -1.0, float("nan")])
def test_a_rate_that_is_none(pairs, rate_hz):
    dataset, folder = pairs
    with pytest.raises(ScenarioError, match="rate in Hz above zero"):
        run(dataset, folder, rate_hz=rate_hz)


def test_kinds_of_image(tmp_path):
    grey = (np.arange(12).reshape(3, 4) * 20).astype(np.uint8)
    cases = {
        "grey8": grey,
        "grey16": grey.astype(np.uint16),
        "three_equal_channels": np.repeat(grey[:, :, None], 3, axis=2),
    }
    for name, image in cases.items():
        path = tmp_path / f"{name}.png"
        cv2.imwrite(str(path), image)
        assert read_foreign_image(path).pixels.dtype == np.uint16
        assert np.array_equal(read_foreign_image(path).pixels, grey)
    colour = np.stack([grey, 2 * grey, grey], axis=2)
    cv2.imwrite(str(tmp_path / "colour.png"), colour)
    with pytest.raises(DatasetError, match="expected a grey image of 8 or 16 bits"):
        read_foreign_image(tmp_path / "colour.png")
    for kind, suffix in {"PNG": ".png", "JPEG": ".jpg", "TIFF": ".tif"}.items():
        half = tmp_path / f"half{suffix}"
        cv2.imwrite(str(half), np.tile(grey, (50, 50)))
        half.write_bytes(half.read_bytes()[: half.stat().st_size // 2])
        with pytest.raises(DatasetError, match=f"expected a whole {kind}"):
            read_foreign_image(half)
    with pytest.raises(DatasetError, match="expected an image at"):
        read_foreign_image(tmp_path / "absent.png")


@pytest.mark.parametrize(("largest", "bits"), [(0, 8), (255, 8), (256, 10), (4095, 12), (4096, 14)])
def test_bits_are_guessed_from_the_largest_number(largest, bits):
    image = np.zeros((4, 4), np.uint16)
    image[1, 2] = largest
    detector = guessed_detector(image)
    assert detector.bits == bits
    assert detector.saturation_dn <= detector.max_dn


# Single images


@pytest.fixture
def images(tmp_path) -> tuple[SyntheticImages, Path]:
    """Write the images of a synthetic tumble under names of their own, and what is known beside."""
    dataset = write_images(tmp_path / "data", 1, start_s=100.0, width_px=128)
    folder = tmp_path / "images"
    folder.mkdir()
    for path in sorted((dataset.folder / "frames").glob("*.png")):
        shutil.copy(path, folder / f"IMG{path.stem}.PNG")
    for name in ("navigation.csv", "knowledge.toml"):
        shutil.copy(dataset.folder / name, tmp_path / name)
    shutil.copy(dataset.folder / "frames.csv", folder / "frames.csv")
    return dataset, folder


def test_single_images_are_estimated_as_the_dataset_that_they_come_from(images):
    dataset, folder = images
    given = GivenFiles(
        str(dataset.folder / "wireframe.json"), detector=dataset.folder / "detector.toml"
    )
    camera = Camera.from_toml(dataset.folder / "camera.toml")
    ours = estimate_frames(folder, camera, given, RATE_HZ, folder, ["best"])
    theirs = estimate_dataset(dataset.folder, ["best"])
    assert [path.name for path in ours] == ["best.jsonl"]
    for own, other in zip(read_estimates(ours[0]), read_estimates(theirs[0]), strict=True):
        assert own.time_s == other.time_s
        assert (own.pose is None) == (other.pose is None)
        if own.pose is not None:
            assert np.array_equal(
                own.pose.cam_from_target.matrix(), other.pose.cam_from_target.matrix()
            )


def test_images_without_the_orbit_that_a_pipeline_needs(images, tmp_path):
    dataset, folder = images
    (tmp_path / "navigation.csv").unlink()
    camera = Camera.from_toml(dataset.folder / "camera.toml")
    with pytest.raises(ScenarioError, match=r"uncooperative lacks chaser_orbit.*navigation\.csv"):
        estimate_frames(folder, camera, GivenFiles("xmm"), RATE_HZ, folder)


def test_images_without_how_the_camera_is_mounted(images, tmp_path):
    dataset, folder = images
    (tmp_path / "knowledge.toml").unlink()
    camera = Camera.from_toml(dataset.folder / "camera.toml")
    with pytest.raises(DatasetError, match=r"expected knowledge\.toml .* R_cam_from_lvlh"):
        estimate_frames(folder, camera, GivenFiles("xmm"), RATE_HZ, folder)
    assert not (folder / "estimates").exists()
