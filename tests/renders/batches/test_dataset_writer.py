"""Each file of a dataset is whole or not there; an exposure is there only with all its parts."""

from __future__ import annotations

import os
import shutil
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from models.arrays import Image
from models.atomic_file import link_or_copy
from models.dataset.frame_table import FrameEntry
from models.dataset.image_file import encode_image, read_image
from models.errors import DatasetError, StorageError
from models.pose import RigidTransform
from renders.batches.dataset_writer import DatasetWriter, image_path, is_whole_png
from renders.batches.public_half import dataset_info, public_files
from renders.scenario.scenario import RenderRequest, resolve
from renders.store.radiance_store import RadianceStore, entry_key
from renders.store.sealed_exr import read_exr
from renders.truth.exposure_truth import ExposureTruth, read_exposures, read_part_names
from renders.truth.pixel_truth import PixelTruth
from renders.world.build import world_of
from renders.world.world import World
from tests.support.small_scenes import activate_best

SHAPE = (48, 64)
KEY = entry_key({"what": "geometry"})
ENTRIES = [FrameEntry(0, 10.0, 1.5), FrameEntry(1, 12.5, 1.25)]


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    activate_best()  # the writer's file names the types of the labels' file, which loads Mitsuba


@pytest.fixture(scope="module")
def world() -> World:
    return world_of(resolve(RenderRequest("maxar-demo", Path("unused"), width=64)))


def writer_at(folder: Path, world: World, scenario: str = "one") -> DatasetWriter:
    info = replace(dataset_info(world), provenance={"scenario": scenario})
    toml, labels = world.scenario.to_toml(), ("bus", "ring")
    return DatasetWriter(folder, info, public_files(world), ENTRIES, labels, toml, world.bands)


@pytest.fixture
def writer(tmp_path: Path, world: World) -> DatasetWriter:
    begun = writer_at(tmp_path / "out", world)
    begun.begin()
    return begun


def image_of(seed: int) -> Image:
    return np.random.default_rng(seed).integers(0, 4096, SHAPE, dtype=np.uint16)


def truth_of(frame: int, band: int) -> ExposureTruth:
    count = 3
    pixels = np.arange(2.0 * count).reshape(count, 2) + frame / 3.0
    pixels[1] = np.nan  # behind the camera
    return ExposureTruth(
        frame=frame,
        band=band,
        time_s=ENTRIES[frame].time_s - (0.033 if band == 800 else 0.0),
        cam_from_target=RigidTransform.identity().perturbed([0.1, 0.2, 0.3], np.ones(3) / 3.0),
        sun_dir_in_target=np.array([0.6, 0.0, 0.8]),
        markers_px=pixels,
        marker_outlines_px=pixels + 0.01,
        visible=np.array([1.0, 0.0, 0.5]),
        lamp_lit=np.ones(count),
        sun_lit=np.zeros(count),
    )


def pixel_truth(seed: int = 3) -> PixelTruth:
    rng = np.random.default_rng(seed)
    labels = rng.integers(0, 3, SHAPE, dtype=np.uint8)
    normals = rng.standard_normal((*SHAPE, 3)).astype(np.float32)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    depth = rng.uniform(1.0, 7.0, SHAPE).astype(np.float32)
    space = labels == 0
    return PixelTruth(labels, np.where(space, 0, depth), np.where(space[..., None], 0, normals))


def write_all(writer: DatasetWriter, frame: int, band: int) -> None:
    writer.write_pixel_truth(frame, band, pixel_truth(), KEY)
    writer.write_exposure(image_of(frame), truth_of(frame, band))


def test_what_is_written_reads_back(writer: DatasetWriter, tmp_path: Path) -> None:
    for entry in ENTRIES:
        for band in (850, 800):
            write_all(writer, entry.index, band)
    writer.finish()
    np.testing.assert_array_equal(read_image(image_path(writer.folder, 1, 850)), image_of(1))
    truths = read_exposures(writer.folder)
    assert list(truths) == [(0, 800), (0, 850), (1, 800), (1, 850)]
    for (frame, band), truth in truths.items():
        expected = truth_of(frame, band)
        for name, value in vars(expected).items():
            if isinstance(value, RigidTransform):
                np.testing.assert_array_equal(truth.cam_from_target.matrix(), value.matrix())
            else:
                np.testing.assert_array_equal(getattr(truth, name), value)
    assert read_part_names(writer.folder) == ("bus", "ring")


def test_geometry_keeps_labels_exactly_depth_in_floats_and_normals_in_halves(
    writer: DatasetWriter, tmp_path: Path
) -> None:
    write_all(writer, 0, 850)
    truth = pixel_truth()
    labels = cv2.imread(str(writer.labels_path(0, 850)), cv2.IMREAD_UNCHANGED)
    np.testing.assert_array_equal(labels, truth.labels)
    channels = read_exr(writer.geometry_path(0, 850))
    assert channels is not None
    np.testing.assert_array_equal(channels["Z"], truth.depth_m)
    normals = np.stack([channels[name] for name in ("NX", "NY", "NZ")], axis=-1)
    np.testing.assert_array_equal(normals, truth.normals_in_target.astype(np.float16))


def test_all_255_labels_survive(writer: DatasetWriter, tmp_path: Path) -> None:
    truth = pixel_truth()
    labels = np.resize(np.arange(256, dtype=np.uint8), SHAPE)
    truth = PixelTruth(labels, truth.depth_m, truth.normals_in_target)
    writer.write_pixel_truth(0, 800, truth, KEY)
    read = cv2.imread(str(writer.labels_path(0, 800)), cv2.IMREAD_UNCHANGED)
    np.testing.assert_array_equal(read, labels)


def test_an_exposure_is_there_only_with_all_its_parts(
    writer: DatasetWriter, tmp_path: Path
) -> None:
    assert not writer.has_exposure(0, 850)
    write_all(writer, 0, 850)
    assert writer.has_exposure(0, 850)
    assert not writer.has_exposure(0, 800)
    for path in (
        image_path(writer.folder, 0, 850),
        writer.labels_path(0, 850),
        writer.truth_path(0, 850),
        writer.geometry_path(0, 850),
    ):
        aside = path.with_suffix(".aside")
        path.rename(aside)
        assert not writer.has_exposure(0, 850)
        aside.rename(path)
        assert writer.has_exposure(0, 850)


@pytest.mark.parametrize("kept", [0, 5, 100, -1])
def test_a_truncated_png_is_not_whole(tmp_path: Path, kept: int) -> None:
    data = encode_image(image_of(1))
    path = tmp_path / "image.png"
    path.write_bytes(data)
    assert is_whole_png(path)
    path.write_bytes(data[:kept])
    assert not is_whole_png(path)
    assert not is_whole_png(tmp_path / "absent.png")


def test_another_scenario_in_the_folder_is_refused_and_nothing_touched(
    writer: DatasetWriter, world: World
) -> None:
    before = {path: path.read_bytes() for path in writer.folder.rglob("*") if path.is_file()}
    writer_at(writer.folder, world).begin()  # the same again is no harm
    with pytest.raises(DatasetError, match="choose another --out"):
        writer_at(writer.folder, world, scenario="two").begin()
    after = {path: path.read_bytes() for path in writer.folder.rglob("*") if path.is_file()}
    assert after == before


def test_pixel_truth_is_taken_from_the_store_as_it_was_put_there(
    writer: DatasetWriter, tmp_path: Path
) -> None:
    store = RadianceStore(tmp_path / "store")
    assert not writer.take_pixel_truth(0, 850, store, KEY)
    writer.write_pixel_truth(0, 800, pixel_truth(), KEY)
    store.take(KEY, writer.geometry_path(0, 800))
    assert writer.take_pixel_truth(0, 850, store, KEY)
    for path in (writer.geometry_path, writer.labels_path):
        assert path(0, 850).read_bytes() == path(0, 800).read_bytes()
    assert os.path.samefile(writer.geometry_path(0, 850), store.path(KEY))


def test_a_damaged_geometry_entry_is_not_taken(writer: DatasetWriter, tmp_path: Path) -> None:
    store = RadianceStore(tmp_path / "store")
    writer.write_pixel_truth(0, 800, pixel_truth(), KEY)
    store.take(KEY, writer.geometry_path(0, 800))
    entry = store.path(KEY)
    entry.write_bytes(entry.read_bytes()[:-40])
    assert not writer.take_pixel_truth(0, 850, store, KEY)
    assert not writer.geometry_path(0, 850).exists()


def test_an_entry_that_goes_while_it_is_taken_is_not_there(
    writer: DatasetWriter, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another process prunes between the look and the link."""
    store = RadianceStore(tmp_path / "store")
    answers = iter([True, False])
    monkeypatch.setattr(store, "has", lambda _: next(answers))
    assert not writer.take_pixel_truth(0, 850, store, KEY)
    assert not writer.geometry_path(0, 850).exists()


# Links


def test_a_link_spends_no_disk_and_replaces_what_was_there(tmp_path: Path) -> None:
    source, place = tmp_path / "source", tmp_path / "deep" / "place"
    source.write_bytes(b"new")
    for _ in range(2):
        link_or_copy(source, place)
        assert place.read_bytes() == b"new"
        assert os.path.samefile(source, place)
    place.unlink()
    place.write_bytes(b"old")
    link_or_copy(source, place)
    assert place.read_bytes() == b"new"
    assert [path.name for path in place.parent.iterdir()] == ["place"]


def test_across_disks_it_copies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError(18, "Invalid cross-device link")

    monkeypatch.setattr(os, "link", refuse)
    source, place = tmp_path / "source", tmp_path / "place"
    source.write_bytes(b"new")
    link_or_copy(source, place)
    assert place.read_bytes() == b"new"
    assert not os.path.samefile(source, place)


def test_where_neither_can_be_done_it_is_told_and_the_old_file_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "link", full)
    monkeypatch.setattr(shutil, "copyfile", full)
    source, place = tmp_path / "source", tmp_path / "place"
    source.write_bytes(b"new")
    place.write_bytes(b"old")
    with pytest.raises(StorageError, match="No space left on device"):
        link_or_copy(source, place)
    assert place.read_bytes() == b"old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["place", "source"]
