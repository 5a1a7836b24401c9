"""Splits, depth scales and tone curves: what is decided before anything is written."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from bench.cli import main
from bench.export import exporter
from bench.export.keypoints import HIDDEN, OUTSIDE, SHADOW, VISIBLE, keypoint_model, states_of
from bench.export.picture import MOSAICS, picture_of
from bench.export.plan import depth_scale_mm, make_plan
from bench.export.source import open_source
from bench.export.tone_curve import CURVES, ToneCurve
from models.camera import Camera
from models.errors import DatasetError, ScenarioError
from models.spacecraft.wireframes import wireframe_by_name
from tests.support.synthetic_dataset import write_dataset

CAMERA = Camera(64, 48, 70.0, 70.0, 31.5, 23.5)


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plan")
    return [
        open_source(k + 1, write_dataset(folder / str(k), 20, images=True, width_px=64).folder)
        for k in range(2)
    ]


def splits(plan) -> dict[tuple[int, int], set[str]]:
    found: dict[tuple[int, int], set[str]] = {}
    for shot in plan.shots:
        found.setdefault((shot.scene, shot.frame), set()).add(shot.split)
    return found


def test_splits_are_drawn_by_the_seed_and_streams_go_together(sources):
    plan = make_plan(sources, (0.5, 0.25, 0.25), 3, 1)
    drawn = splits(plan)
    assert all(len(each) == 1 for each in drawn.values())
    for scene in (1, 2):
        held = [next(iter(own)) for (s, _), own in drawn.items() if s == scene]
        assert [held.count(name) for name in ("train", "val", "test")] == [10, 5, 5]
    assert splits(make_plan(sources, (0.5, 0.25, 0.25), 3, 1)) == drawn
    assert splits(make_plan(sources, (0.5, 0.25, 0.25), 4, 1)) != drawn
    first = [drawn[1, frame] for frame in range(20)]
    assert first != [drawn[2, frame] for frame in range(20)]
    assert len({shot.key for shot in plan.shots}) == len(plan.shots) == 80


@pytest.mark.parametrize("drawn", [False, True], ids=["case", "random"])
def test_a_dataset_that_lacks_images_is_refused_with_their_number(
    drawn, tmp_path, capsys, monkeypatch
):
    folder = write_dataset(tmp_path / "part", 3, images=True, width_px=64).folder
    for gone in sorted((folder / "frames").glob("*.png"))[1:]:
        gone.unlink()
    if drawn:
        monkeypatch.setattr(exporter, "datasets_within", lambda given: [folder])
    given, out = (tmp_path if drawn else folder), tmp_path / "out"
    assert main(["export", str(given), "--as", "coco", "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert "all 6 images of the datasets to be there, 5 are missing" in said
    assert ("without --only" in said) == drawn
    assert not out.exists()


def test_frames_of_a_block_stay_together(sources):
    drawn = splits(make_plan(sources, (0.5, 0.25, 0.25), 0, 5))
    for scene in (1, 2):
        for start in range(0, 20, 5):
            assert len(set.union(*(drawn[scene, start + k] for k in range(5)))) == 1


@pytest.mark.parametrize("shares", [(0.5, 0.5, 0.5), (1.2, -0.2, 0.0), (0.0, 0.0, 0.0)])
def test_shares_add_up(shares, sources):
    with pytest.raises(ScenarioError, match="add up to 1"):
        make_plan(sources, shares, 0, 1)


def test_an_image_without_truth_is_in_no_split(sources, tmp_path):
    folder = write_dataset(tmp_path / "blind", 3, width_px=64).folder
    path = folder / "truth" / "exposures.jsonl"
    path.write_text("".join(path.read_text().splitlines(keepends=True)[2:]))
    plan = make_plan([open_source(1, folder)], (1.0, 0.0, 0.0), 0, 1)
    assert [shot.split for shot in plan.shots] == ["unlabelled"] * 2 + ["train"] * 4


@pytest.mark.parametrize(
    ("farthest_m", "scale"),
    [(0.0, 0.1), (6.5, 0.1), (6.6, 0.2), (40.0, 1.0), (65.5, 1.0), (66.0, 2.0), (5000.0, 100.0)],
)
def test_the_depth_scale_reaches_as_far_as_the_scene(farthest_m, scale):
    assert depth_scale_mm(farthest_m) == scale
    assert 65535 * scale >= 1e3 * farthest_m


# Keypoints


def test_states_are_told_apart():
    points = np.array([[10.0, 10.0], [10.0, 10.0], [10.0, 10.0], [70.0, 10.0], [np.nan, np.nan]])
    seen = np.array([True, True, False, True, True])
    lit = np.array([True, False, True, True, True])
    assert states_of(points, CAMERA, seen, lit) == (VISIBLE, SHADOW, HIDDEN, OUTSIDE, OUTSIDE)


def test_mirrored_keypoints_are_partners_across_the_middle():
    model = keypoint_model(wireframe_by_name("xmm"), None)
    partner = model.mirrored()
    assert partner is not None
    across = model.points_in_target * [1.0, -1.0, 1.0]
    assert np.abs(model.points_in_target[list(partner)] - across).max() < 0.02
    assert [partner[k] for k in partner] == list(range(len(model)))
    assert keypoint_model(wireframe_by_name("hispasat"), None).mirrored() is None


# Tone curves and colours


@pytest.mark.parametrize("name", CURVES)
def test_a_curve_rises_from_black_to_white(name):
    curve = ToneCurve(name, 100.0, 4095.0)
    levels = curve.applied(np.arange(4096, dtype=np.uint16))
    assert levels[0] == levels[100] == 0
    assert levels[4095] == 255
    assert (np.diff(levels.astype(int)) >= 0).all()


@pytest.mark.parametrize("pattern", MOSAICS)
def test_a_mosaic_leaves_in_its_colours(pattern, tmp_path):
    values = {"r": 3000, "g": 2000, "b": 1000}
    raw = np.zeros((16, 16), np.uint16)
    for number, colour in enumerate(pattern):
        raw[number // 2 :: 2, number % 2 :: 2] = values[colour]
    cv2.imwrite(str(tmp_path / "raw.png"), raw)
    picture = picture_of(tmp_path / "raw.png", None, pattern)
    assert picture.image.dtype == np.uint16
    assert (picture.image[4:-4, 4:-4] == [1000, 2000, 3000]).all()  # blue, green, red
    assert not picture.is_grey
    cv2.imwrite(str(tmp_path / "colour.png"), picture.image)
    assert (picture_of(tmp_path / "colour.png", None, None).image == picture.image).all()
    with pytest.raises(DatasetError, match="got one that has colours"):
        picture_of(tmp_path / "colour.png", None, pattern)
