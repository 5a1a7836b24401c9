"""A case from scenario to dataset: whole, resumable, and the same to the bit however it was cut."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.dataset.dataset import open_dataset
from models.errors import DatasetError, ScenarioError
from renders.batches.dataset_writer import image_path
from renders.store.sealed_exr import read_exr
from renders.truth.exposure_truth import read_exposures, read_part_names
from tests.renders.conftest import TinyDataset
from tests.support.frame_images import at_800, at_850, stored_frames

EXPOSURES = [(frame, band) for frame in (0, 1) for band in (800, 850)]
NAMES = [f"{frame:06d}_{band}" for frame, band in EXPOSURES]


def channels(dataset: TinyDataset, name: str) -> dict[str, np.ndarray]:
    read = read_exr(dataset.folder / "truth" / "geometry" / f"{name}.exr")
    assert read is not None
    return read


# What is there


def test_every_file_is_there_and_no_other(rendered_once: TinyDataset) -> None:
    public = ["camera.toml", "dataset.json", "detector.toml", "frames.csv", "markers.toml"]
    public += ["prior.toml", *(f"frames/{name}.png" for name in NAMES)]
    sealed = ["exposures.jsonl", "light.json", "parts.json", "scenario.toml"]
    sealed += [f"labels/{name}.png" for name in NAMES]
    sealed += [f"geometry/{name}.exr" for name in NAMES]
    found = {name for name in rendered_once.files() if not name.startswith("truth/exposures/")}
    assert found == {*public, *(f"truth/{name}" for name in sealed)}


def test_the_public_half_reads_back_as_what_is_known_on_board(rendered_once: TinyDataset) -> None:
    world, folder = rendered_once.world, rendered_once.folder
    dataset, expected = open_dataset(folder), world.onboard(0)
    info, known = dataset.info, dataset.onboard
    assert (info.case, info.sun, info.frames, info.target) == ("maxar-demo", "S2", 2, "maxar1300")
    assert info.provenance["scenario"] == world.scenario.fingerprint()
    assert known.camera == expected.camera
    assert known.detector == expected.detector
    assert known.prior is not None
    assert expected.prior is not None
    assert known.markers is not None
    assert expected.markers is not None
    np.testing.assert_allclose(
        known.prior.cam_from_target.matrix(), expected.prior.cam_from_target.matrix(), atol=1e-12
    )
    np.testing.assert_array_equal(known.markers.points_in_target, expected.markers.points_in_target)
    assert info.chain == "retroreflector_pairs"
    offsets = {stream.name: stream.offset_s for stream in info.streams}
    assert offsets == {"image_800": -0.033, "image_850": 0.0}
    frames = list(dataset.frames())
    assert [frame.time_s for frame in frames] == [240.0, 250.0]
    for frame in frames:
        assert at_800(frame).shape == (128, 128)
        assert at_800(frame).max() <= 4095


def test_the_public_half_tells_no_pose(rendered_once: TinyDataset) -> None:
    """Neither the motion's numbers nor the scenario's; the hash of it is not the scenario."""
    public = [data for name, data in rendered_once.files().items() if not name.startswith("truth")]
    for truth in read_exposures(rendered_once.folder).values():
        for number in truth.cam_from_target.translation:
            assert not any(repr(float(number)).encode() in data for data in public)
    assert not any(b"end_s" in data for data in public)


def test_the_truth_is_the_motion_at_each_exposure(rendered_once: TinyDataset) -> None:
    world, truths = rendered_once.world, read_exposures(rendered_once.folder)
    assert list(truths) == EXPOSURES  # in order of time
    for exposure in world.exposures:
        truth = truths[exposure.frame, exposure.band]
        assert truth.time_s == exposure.time_s
        pose = world.trajectory.cam_from_target(exposure.time_s)
        np.testing.assert_allclose(truth.cam_from_target.matrix(), pose.matrix(), atol=1e-12)
        assert world.target.markers is not None
        points = world.target.markers.points_in_target
        np.testing.assert_allclose(truth.markers_px, world.camera.project(pose @ points))
        np.testing.assert_allclose(truth.sun_dir_in_target, world.sun.direction_in_target)
        # A circle seen aslant: its centre of area lies off its centre's image by little.
        offsets = np.linalg.norm(truth.marker_outlines_px - truth.markers_px, axis=1)
        assert 0.0 < offsets.max() < 0.05
        inside = world.camera.contains(truth.markers_px, margin_px=2.0)
        assert inside.sum() >= 6
        assert (truth.visible[inside] > 0.95).all()
        assert (truth.lamp_lit > 0.95).sum() >= 8


def test_labels_depth_and_normals_agree(rendered_once: TinyDataset) -> None:
    import cv2

    parts = read_part_names(rendered_once.folder)
    assert len(parts) == len(set(parts))
    seen: set[str] = set()
    for name in NAMES:
        path = rendered_once.folder / "truth" / "labels" / f"{name}.png"
        labels = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        geometry = channels(rendered_once, name)
        np.testing.assert_array_equal(labels, geometry["label"])
        np.testing.assert_array_equal(labels > 0, geometry["Z"] > 0)
        normals = np.stack([geometry[key] for key in ("NX", "NY", "NZ")], axis=-1).astype(float)
        half_floats = 2e-3
        lengths = np.linalg.norm(normals[labels > 0], axis=1)
        np.testing.assert_allclose(lengths, 1.0, atol=half_floats)
        seen |= {parts[label - 1] for label in np.unique(labels[labels > 0])}
    assert {"launch_adaptor_ring", "retroreflectors"} <= seen
    assert len(seen) >= 6  # a spacecraft, not a box
    assert "chaser" not in seen  # it stands behind its own camera


def test_frames_look_like_a_spacecraft_in_space(rendered_once: TinyDataset) -> None:
    """Space at the bias within the noise; markers bright at 850 nm and dark at 800 nm."""
    detector = rendered_once.world.scenario.simulated_detector
    for frame in stored_frames(rendered_once.folder):
        saturated = (at_850(frame) >= detector.saturation_dn - 1).mean()
        assert saturated < 0.01
        for band, image in ((800, at_800(frame)), (850, at_850(frame))):
            labels = channels(rendered_once, f"{frame.index:06d}_{band}")["label"]
            space = image[labels == 0].astype(float)
            if len(space) > 100:
                four_sigma = 4.0 * detector.noise_dn(np.array([100.0]))[0] / np.sqrt(len(space))
                # Light of the craft's edge may blur into a few of these pixels.
                assert np.median(space) == pytest.approx(100.0, abs=max(four_sigma, 0.5))
        truth = read_exposures(rendered_once.folder)[frame.index, 850]
        column, row = np.rint(truth.markers_px[truth.visible > 0.95]).astype(int).T
        gain = at_850(frame)[row, column].astype(int) - at_800(frame)[row, column]
        # At 128 columns a marker is half a pixel wide, and yet far above the noise.
        assert (gain > 5.0 * detector.noise_dn(at_850(frame)[row, column])).mean() > 0.8


# Again


def test_nothing_is_done_twice(tiny: TinyDataset, traced: Callable[[], int]) -> None:
    before = tiny.files()
    images = [image_path(tiny.folder, *exposure) for exposure in EXPOSURES]
    ages = [path.stat().st_mtime_ns for path in images]
    assert "4 of 4 exposures are there already" in tiny.render()
    assert traced() == 0
    assert tiny.files() == before
    assert [path.stat().st_mtime_ns for path in images] == ages


LOST: dict[str, Callable[[Path], None]] = {
    "a frame deleted": lambda out: (out / "frames/000000_850.png").unlink(),
    "a frame truncated": lambda out: cut(out / "frames/000001_800.png"),
    "labels truncated": lambda out: cut(out / "truth/labels/000001_850.png"),
    "a frame's truth truncated": lambda out: cut(
        next((out / "truth/exposures").glob("*_800.json"))
    ),
    "geometry deleted": lambda out: (out / "truth/geometry/000000_800.exr").unlink(),
    "the joined truth deleted": lambda out: (out / "truth/exposures.jsonl").unlink(),
    "frames deleted": lambda out: [path.unlink() for path in (out / "frames").iterdir()] and None,
}


def cut(path: Path) -> None:
    data = path.read_bytes()
    path.unlink()  # a link to the store must not cut what is there
    path.write_bytes(data[: len(data) * 2 // 3])


@pytest.mark.parametrize("lose", LOST.values(), ids=LOST.keys())
def test_what_was_lost_comes_back_bit_by_bit_and_no_light_is_traced(
    tiny: TinyDataset, traced: Callable[[], int], lose: Callable[[Path], None]
) -> None:
    before = tiny.files()
    lose(tiny.folder)
    assert tiny.files() != before
    tiny.render()
    assert tiny.files() == before
    assert traced() == 0


def test_a_damaged_store_entry_is_traced_again_to_the_same_bits(
    tiny: TinyDataset, traced: Callable[[], int]
) -> None:
    before = tiny.files()
    light = json.loads((tiny.folder / "truth" / "light.json").read_text())
    entry = tiny.store.path(light["exposures"]["000001_850"]["lamps_850"])
    whole = entry.read_bytes()
    entry.write_bytes(whole[:-50])
    tiny.render()
    assert traced() == 0  # its frame is there: nobody misses it
    image_path(tiny.folder, 1, 850).unlink()
    tiny.render()
    assert traced() == 1
    assert entry.read_bytes() == whole
    assert tiny.files() == before


def test_without_store_or_frames_all_is_rendered_to_the_same_bits(
    tiny: TinyDataset, rendered_once: TinyDataset, traced: Callable[[], int]
) -> None:
    """An uninterrupted run's dataset, and one rendered anew: nothing depends on the order."""
    import shutil

    shutil.rmtree(tiny.store.folder)
    shutil.rmtree(tiny.folder / "frames")
    tiny.render()
    assert traced() == 4
    again, once = tiny.files(), rendered_once.files()
    assert again.keys() == once.keys()
    for name in once.keys() - {"truth/light.json"}:  # it names the store's folder
        assert again[name] == once[name], name


def test_an_interrupted_run_leaves_whole_exposures_and_goes_on(
    tiny: TinyDataset, monkeypatch: pytest.MonkeyPatch, traced: Callable[[], int]
) -> None:
    """Killed while it exposes the third: two are kept, and two are made."""
    before = tiny.files()
    for exposure in EXPOSURES:
        image_path(tiny.folder, *exposure).unlink()
    from renders.batches import case_rendering as batch

    really, calls = batch.compose, []

    def killed(*arguments: object, **named: object) -> object:
        calls.append(1)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return really(*arguments, **named)  # type: ignore[arg-type]

    with monkeypatch.context() as patched:
        patched.setattr(batch, "compose", killed)
        with pytest.raises(KeyboardInterrupt):
            tiny.render()
    there = [image_path(tiny.folder, *exposure).is_file() for exposure in EXPOSURES]
    assert there == [True, True, False, False]
    assert "2 of 4 exposures are there already" in tiny.render()
    assert tiny.files() == before
    assert traced() == 0


def test_no_scratch_is_left(rendered_once: TinyDataset) -> None:
    for folder in (rendered_once.folder, rendered_once.store.folder):
        assert not [path for path in folder.rglob("*") if ".part" in path.name]


# Refusals


@pytest.mark.parametrize(
    "options",
    [{"sun": "S1"}, {"width": 256}, {"spp": 9}, {"rate_hz": 0.2}, {"case": "maxar-approach"}],
    ids=["Sun", "width", "samples", "rate", "case"],
)
def test_a_folder_holds_one_scenario(tiny: TinyDataset, options: dict[str, str]) -> None:
    before = tiny.files()
    other = TinyDataset(replace(tiny.request, **options))  # type: ignore[arg-type]
    with pytest.raises(DatasetError, match="choose another --out"):
        other.render()
    assert tiny.files() == before


def test_another_version_of_the_format_is_refused(tiny: TinyDataset) -> None:
    path = tiny.folder / "dataset.json"
    path.write_text(path.read_text().replace('"version": 2', '"version": 99'))
    before = tiny.files()
    with pytest.raises(DatasetError, match=r"of version 2, .* of version 99"):
        tiny.render()
    assert tiny.files() == before


def test_a_dataset_of_version_1_is_not_gone_on_with(tiny: TinyDataset) -> None:
    """Half rendered by an earlier rvbench: it is kept, and another folder is to be chosen."""
    path = tiny.folder / "dataset.json"
    table = json.loads(path.read_text()) | {"format": "rvbench-pairs", "version": 1}
    for key in ("chain", "streams", "onboard"):
        del table[key]
    path.write_text(json.dumps(table))
    image_path(tiny.folder, 1, 850).unlink()
    before = tiny.files()
    with pytest.raises(DatasetError, match=r"one of version 1, .* choose another --out"):
        tiny.render()
    assert tiny.files() == before


def test_a_file_in_the_datasets_place_is_refused(tiny: TinyDataset, tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("not a folder")
    with pytest.raises(DatasetError, match="expected a folder"):
        TinyDataset(replace(tiny.request, out=tmp_path / "taken")).render()


def test_a_camera_inside_the_target_is_refused_before_anything_is_made(
    tiny: TinyDataset, tmp_path: Path
) -> None:
    out = tmp_path / "inside"
    request = replace(tiny.request, out=out, start_s=460.0, end_s=480.0)
    with pytest.raises(ScenarioError, match="inside maxar1300"):
        TinyDataset(request).render()
    assert not out.exists()


def test_the_same_light_under_another_sun_is_not_traced_again(
    tiny: TinyDataset, tmp_path: Path, traced: Callable[[], int]
) -> None:
    """``maxar-approach`` renders seven Suns in one pass: the next Sun costs a detector."""
    scenario = tmp_path / "shared.toml"
    text = tiny.world.scenario.to_toml()
    scenario.write_text(text.replace("shared = []", 'shared = ["S1", "S2"]'))
    store = tmp_path / "other_store"
    request = replace(tiny.request, case=str(scenario), end_s=240.0, store=store)
    first = TinyDataset(replace(request, out=tmp_path / "S2"))
    second = TinyDataset(replace(request, out=tmp_path / "S1", sun="S1"))
    first.render()
    assert traced() == 2
    second.render()
    assert traced() == 2
    images = [at_850(stored_frames(dataset.folder)[0]) for dataset in (first, second)]
    assert (images[0] != images[1]).mean() > 0.5
