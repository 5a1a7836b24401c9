"""What is on board before the first frame: it comes back, and what cannot be is refused."""

from __future__ import annotations

import os
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.dataset.onboard_files import (
    EXPECTATIONS,
    KNOWN,
    expectations_to_toml,
    onboard_texts,
    read_expectations,
    read_onboard,
)
from models.dataset.prior_file import prior_to_toml
from models.errors import DatasetError, ScenarioError
from models.onboard import FlightExpectations, OnboardKnowledge, needed
from models.pose import RigidTransform
from tests.support.public_halves import IMAGES, IMAGES_ON_BOARD, PAIRS, PAIRS_ON_BOARD
from tests.support.strategies import rigid_transforms

EULER_ROUNDING = 1e-14  # the prior's attitude goes through three angles and back
EVERYTHING = replace(
    PAIRS_ON_BOARD,
    wireframe=IMAGES_ON_BOARD.wireframe,
    expectations=IMAGES_ON_BOARD.expectations,
    psf_sigma_px=1 / 3,
    sigmas={"camera.fx": 0.1, "camera.k1": 1e-3},
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return written(tmp_path, EVERYTHING)


def written(folder: Path, onboard: OnboardKnowledge) -> Path:
    for name, text in onboard_texts(onboard).items():
        (folder / name).write_text(text)
    return folder


def test_all_that_is_on_board_comes_back(folder: Path) -> None:
    told, back = EVERYTHING, read_onboard(folder, KNOWN)
    assert (back.camera, back.detector) == (told.camera, told.detector)
    assert (back.psf_sigma_px, back.sigmas) == (told.psf_sigma_px, told.sigmas)
    assert told.markers
    assert told.prior
    assert told.wireframe
    assert told.expectations
    assert back.markers
    assert back.prior
    assert back.wireframe
    assert back.expectations
    assert back.markers.names == told.markers.names
    assert back.markers.radius_m == told.markers.radius_m
    for ours, theirs in (
        (back.markers.points_in_target, told.markers.points_in_target),
        (back.markers.normals_in_target, told.markers.normals_in_target),
        (back.prior.cam_from_target.translation, told.prior.cam_from_target.translation),
        (back.prior.sigma_m, told.prior.sigma_m),
        (back.prior.sigma_deg, told.prior.sigma_deg),
        (back.wireframe.points_in_target, told.wireframe.points_in_target),
        (back.expectations.cam_from_lvlh.matrix(), told.expectations.cam_from_lvlh.matrix()),
        (back.expectations.inertia_kg_m2, told.expectations.inertia_kg_m2),
    ):
        np.testing.assert_array_equal(ours, theirs)
    np.testing.assert_allclose(
        back.prior.cam_from_target.rotation,
        told.prior.cam_from_target.rotation,
        atol=EULER_ROUNDING,
    )
    assert (back.expectations.sigma_px, back.expectations.range_m) == (0.7, (29.0, 31.0))
    assert back.expectations.chaser_sigma_m == 10.0
    assert back.expectations.chaser_sigma_m_s == 0.1


def test_writing_again_gives_the_same_bytes(folder: Path) -> None:
    """All but the prior, whose angles round; its text is written once."""
    back = onboard_texts(read_onboard(folder, KNOWN))
    assert set(back) == set(KNOWN)
    for name, text in back.items():
        if name != "prior.toml":
            assert (folder / name).read_text() == text


@pytest.mark.parametrize("info", [PAIRS, IMAGES])
def test_what_nobody_has_is_not_there(folder: Path, info) -> None:
    """The folder has every file: what ``dataset.json`` does not name is not read."""
    back = read_onboard(folder, info.onboard)
    assert (back.markers is None) == (back.prior is None) == (info is IMAGES)
    assert (back.wireframe is None) == (back.expectations is None) == (info is PAIRS)
    assert back.psf_sigma_px is None
    assert back.sigmas == {}


def test_what_a_pipeline_lacks_is_told() -> None:
    assert needed(PAIRS_ON_BOARD.prior, "prior.toml", "any") is PAIRS_ON_BOARD.prior
    with pytest.raises(
        DatasetError, match=r"wireframe\.json for the pipeline any, got none; name a"
    ):
        needed(PAIRS_ON_BOARD.wireframe, "wireframe.json", "any")


def test_a_dataset_without_images_needs_no_camera(folder: Path) -> None:
    back = read_onboard(folder, ("prior.toml",))
    assert back.camera is None
    assert back.detector is None
    assert back.prior is not None
    assert set(onboard_texts(back)) == {"prior.toml"}


def test_a_chains_own_tables_come_back(folder: Path) -> None:
    tables = {"range_finder.toml": {"sigma_m": 1 / 3, "beams": [{"name": "a", "on": True}]}}
    told = replace(EVERYTHING, tables=tables)
    back = read_onboard(written(folder, told), (*KNOWN, *tables))
    assert back.tables == tables
    assert read_onboard(folder, KNOWN).tables == {}


@pytest.mark.parametrize("name", ["camera.toml", "notes.txt", "range_finder"])
def test_a_table_has_a_name_of_its_own(folder: Path, name: str) -> None:
    with pytest.raises(DatasetError, match=f"a name of its own ending in .toml.*got '{name}'"):
        onboard_texts(replace(EVERYTHING, tables={name: {"a": 1}}))


def test_a_file_that_is_no_table_is_told(folder: Path) -> None:
    (folder / "notes.txt").write_text("a = 1")
    with pytest.raises(DatasetError, match=r"dataset\.json: .*ending in \.toml, got 'notes\.txt'"):
        read_onboard(folder, (*KNOWN, "notes.txt"))


def test_a_run_has_files_of_its_own(folder: Path, tmp_path: Path) -> None:
    run = tmp_path / "seeds" / "003"
    run.mkdir(parents=True)
    assert EVERYTHING.prior is not None
    moved = replace(
        EVERYTHING.prior, cam_from_target=RigidTransform(np.eye(3), np.array([0.0, 0.0, 5.0]))
    )
    (run / "prior.toml").write_text(prior_to_toml(moved))
    back = read_onboard(folder, KNOWN, run)
    assert back.prior is not None
    assert back.prior.cam_from_target.translation.tolist() == [0.0, 0.0, 5.0]
    assert back.camera == EVERYTHING.camera
    (run / "prior.toml").unlink()
    os.mkfifo(run / "prior.toml")  # one that is there but no file does not give way in silence
    with pytest.raises(DatasetError, match=r"003/prior\.toml: a pipe"):
        read_onboard(folder, KNOWN, run)


@pytest.mark.parametrize("name", KNOWN)
def test_a_missing_file_is_named(folder: Path, name: str) -> None:
    (folder / name).unlink()
    with pytest.raises((DatasetError, ScenarioError), match=rf"{name}.*No such file"):
        read_onboard(folder, KNOWN)


@pytest.mark.parametrize("name", KNOWN)
@pytest.mark.parametrize("data", [b"radius_m = ", b"\xff\xfe\x00", b"a" + b".a" * 5000 + b" = 1"])
def test_a_garbled_file_is_named(folder: Path, name: str, data: bytes) -> None:
    (folder / name).write_bytes(data)
    with pytest.raises((DatasetError, ScenarioError), match=name):
        read_onboard(folder, KNOWN)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("optics.toml", "psf_sigma_px = -0.1", "psf_sigma_px of at least 0"),
        ("optics.toml", "psf_sigma_px = 0.5\nblur = 1", "unknown: blur"),
        ("sigmas.toml", '"camera.fx" = -1.0', "camera.fx of at least 0"),
        ("sigmas.toml", '"camera.fx" = nan', "camera.fx of at least 0 .*, got nan"),
        ("sigmas.toml", "camera.fx = 1.0", "camera to be a number, got .'fx'"),
    ],
)
def test_what_is_told_of_the_lens_and_of_errors_can_be(
    folder: Path, name: str, text: str, said: str
) -> None:
    (folder / name).write_text(text)
    with pytest.raises(DatasetError, match=rf"{name}: .*{said}"):
        read_onboard(folder, KNOWN)


# knowledge.toml

POSITIVE = st.floats(1e-6, 1e3)


@given(rigid_transforms(), POSITIVE, POSITIVE, POSITIVE, st.none() | st.tuples(POSITIVE, POSITIVE))
def test_any_expectations_come_back_to_the_last_bit(
    tmp_path_factory: pytest.TempPathFactory,
    mount: RigidTransform,
    sigma_px: float,
    sigma_m: float,
    sigma_m_s: float,
    range_m: tuple[float, float] | None,
) -> None:
    span = None if range_m is None else (min(range_m), max(range_m))
    told = FlightExpectations(mount, sigma_px, sigma_m, sigma_m_s, span)
    path = tmp_path_factory.mktemp("any") / EXPECTATIONS
    path.write_text(expectations_to_toml(told))
    back = read_expectations(path)
    assert back.cam_from_lvlh.matrix().tobytes() == mount.matrix().tobytes()
    assert (back.sigma_px, back.chaser_sigma_m) == (sigma_px, sigma_m)
    assert (back.chaser_sigma_m_s, back.range_m) == (sigma_m_s, span)
    assert back.inertia_kg_m2 is None


def test_the_sun_on_board_comes_back_to_the_last_bit(folder: Path) -> None:
    path = folder / EXPECTATIONS
    sun = np.array([1.0, -2.0, 0.5]) / np.sqrt(5.25)
    known = replace(read_expectations(path), sun_dir_in_inertial=sun, sun_sigma_deg=0.3)
    path.write_text(expectations_to_toml(known))
    back = read_expectations(path)
    assert back.sun_dir_in_inertial is not None
    assert back.sun_dir_in_inertial.tobytes() == sun.tobytes()
    assert back.sun_sigma_deg == 0.3


def test_the_earth_and_the_level_of_white_come_back_to_the_last_bit(folder: Path) -> None:
    path = folder / EXPECTATIONS
    earth = np.array([0.5, 1.0, -2.0]) / np.sqrt(5.25)
    plain = read_expectations(path)
    known = replace(
        plain,
        earth_shines=True,
        earth_dir_in_inertial=earth,
        white_dn_ms=13_611.7,
        earth_hides_sun=True,
    )
    assert not plain.earth_shines
    assert not plain.earth_hides_sun
    path.write_text(expectations_to_toml(known))
    back = read_expectations(path)
    assert back.earth_dir_in_inertial is not None
    assert back.earth_dir_in_inertial.tobytes() == earth.tobytes()
    assert back.earth_shines
    assert back.earth_hides_sun
    assert back.white_dn_ms == 13_611.7


def test_a_sun_of_another_length_is_refused(folder: Path) -> None:
    path = folder / EXPECTATIONS
    known = replace(read_expectations(path), sun_dir_in_inertial=np.array([0.5, 0.0, 0.0]))
    path.write_text(expectations_to_toml(known))
    with pytest.raises(DatasetError, match="sun_dir_in_inertial"):
        read_expectations(path)


def test_a_mount_typed_with_six_digits_is_made_exact(folder: Path) -> None:
    path = folder / EXPECTATIONS
    table = tomllib.loads(path.read_text())
    turn = Rotation.from_rotvec([0.2, 1.0, -0.5]).as_matrix()
    table["R_cam_from_lvlh"] = np.round(turn, 6).tolist()
    path.write_text(tomli_w.dumps(table))
    mount = read_expectations(path).cam_from_lvlh
    np.testing.assert_allclose((mount.inverse() @ mount).matrix(), np.eye(4), atol=1e-14)
    np.testing.assert_allclose(mount.rotation, turn, atol=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("sigma_px", "sigma_pix", "unknown: sigma_pix; missing: sigma_px"),
        ("sigma_px = 0.7", "sigma_px = 0.0", "sigma_px above 0"),
        ("sigma_px = 0.7", "sigma_px = inf", "sigma_px above 0 and at most"),
        ("-1.0", "1.0", "R_cam_from_lvlh as a rotation matrix, got one with"),
        ("-1.0", "nan", "R_cam_from_lvlh as numbers of at least -2"),
        ("29.0", "90.0", "range_m as nearest and farthest"),
        ("29.0", "0.0", "range_m as nearest and farthest"),
        ("chaser_sigma_m = 10.0", "chaser_sigma_m = -10.0", "chaser_sigma_m of at least 0"),
        ("7000.", "-7000.", "inertia_kg_m2 as a covariance, got one with a variance of -"),
    ],
)
def test_expectations_that_cannot_be_are_refused(
    folder: Path, old: str, new: str, said: str
) -> None:
    path = folder / EXPECTATIONS
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(DatasetError, match=rf"knowledge\.toml: .*{said}"):
        read_expectations(path)
