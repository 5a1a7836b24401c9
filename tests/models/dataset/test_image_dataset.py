"""The public half of single images: what was known and seen comes back, damage does not."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from models.dataset.image_dataset import (
    FORMAT,
    knowledge_to_toml,
    read_image_frames,
    read_image_info,
    read_navigation,
    read_uncooperative_knowledge,
)

from models.dataset.dataset import FILTERED, image_path, read_format, read_info
from models.errors import DatasetError
from tests.support.synthetic_images import SyntheticImages, write_images


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> SyntheticImages:
    return write_images(tmp_path_factory.mktemp("images") / "data", frames=3, width_px=64)


@pytest.fixture
def folder(written: SyntheticImages, tmp_path: Path) -> Path:
    return Path(shutil.copytree(written.folder, tmp_path / "data"))


def test_the_format_is_told_and_the_other_one_refused(folder: Path) -> None:
    assert read_format(folder) == FORMAT == read_image_info(folder).format
    with pytest.raises(DatasetError, match="expected format 'rvbench-pairs', got 'rvbench-images'"):
        read_info(folder)


def test_what_is_known_on_board_comes_back(folder: Path, written: SyntheticImages) -> None:
    known, back = written.knowledge, read_uncooperative_knowledge(folder)
    assert (back.camera, back.detector) == (known.camera, known.detector)
    assert (back.sigma_px, back.range_m) == (0.7, (29.0, 31.0))
    assert (back.chaser_sigma_m, back.chaser_sigma_m_s) == (10.0, 0.1)
    np.testing.assert_array_equal(back.cam_from_lvlh.matrix(), known.cam_from_lvlh.matrix())
    np.testing.assert_array_equal(back.inertia_kg_m2, known.inertia_kg_m2)
    np.testing.assert_array_equal(back.target.points_in_target, known.target.points_in_target)
    assert knowledge_to_toml(back) == (folder / "knowledge.toml").read_text()


def test_what_nobody_knows_is_left_out(folder: Path, written: SyntheticImages) -> None:
    known = replace(written.knowledge, range_m=None, inertia_kg_m2=None)
    (folder / "knowledge.toml").write_text(knowledge_to_toml(known))
    back = read_uncooperative_knowledge(folder)
    assert back.range_m is None
    assert back.inertia_kg_m2 is None


def test_frames_come_back_in_time_with_what_the_chaser_believes(
    folder: Path, written: SyntheticImages
) -> None:
    frames = list(read_image_frames(folder))
    assert [frame.index for frame in frames] == [0, 1, 2]
    for frame, truth in zip(frames, written.truths, strict=True):
        assert frame.time_s == truth.time_s == frame.chaser.time_s
        assert frame.image.shape == (64, 64)
        off_m = frame.chaser.position_in_inertial - truth.chaser.position_in_inertial
        assert 0.0 < np.abs(off_m).max() < 60.0  # six sigma
    assert frames[0].chaser.position_in_inertial[0] != frames[1].chaser.position_in_inertial[0]


def test_navigation_keeps_every_digit(folder: Path) -> None:
    states = read_navigation(folder)
    text = (folder / "navigation.csv").read_text()
    for state in states.values():
        for number in (*state.position_in_inertial, *state.velocity_in_inertial):
            assert repr(float(number)) in text


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


DAMAGE: dict[str, tuple[Callable[[Path], object], str]] = {
    "no knowledge": (lambda d: (d / "knowledge.toml").unlink(), "expected a TOML file at"),
    "an unknown key": (
        lambda d: edit(d / "knowledge.toml", "sigma_px", "sigma_pix"),
        "unknown: sigma_pix; missing: sigma_px",
    ),
    "a sigma of nothing": (
        lambda d: edit(d / "knowledge.toml", "sigma_px = 0.7", "sigma_px = 0.0"),
        "sigma_px above zero",
    ),
    "a mount that mirrors": (
        lambda d: edit(d / "knowledge.toml", "-1.0", "1.0"),
        "expected a mount that is a rotation",
    ),
    "a range upside down": (
        lambda d: edit(d / "knowledge.toml", "29.0", "90.0"),
        "nearest and farthest",
    ),
    "another version": (
        lambda d: edit(d / "dataset.json", '"version": 1', '"version": 99'),
        "expected version 1, got 99",
    ),
    "navigation without a column": (
        lambda d: edit(d / "navigation.csv", "vz_m_s", "w"),
        "with the columns index, time_s, x_m",
    ),
    "navigation of other frames": (
        lambda d: edit(d / "navigation.csv", "\n1,3.0", "\n7,3.0"),
        "expected the chaser's state at frame 1",
    ),
    "navigation of another time": (
        lambda d: edit(d / "navigation.csv", "\n1,3.0", "\n1,3.5"),
        "at frame 1, 3.0 s, got 3.5",
    ),
    "navigation that is not finite": (
        lambda d: edit(d / "navigation.csv", "\n1,3.0", "\n1,nan"),
        "not finite",
    ),
    "an image gone": (
        lambda d: image_path(d, 1, FILTERED).unlink(),
        r"expected an image at .*000001\.png",
    ),
}


def read_all(folder: Path) -> None:
    read_image_info(folder)
    read_uncooperative_knowledge(folder)
    list(read_image_frames(folder))


@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_named(damage: str, folder: Path) -> None:
    spoil, said = DAMAGE[damage]
    spoil(folder)
    with pytest.raises(DatasetError, match=said):
        read_all(folder)
