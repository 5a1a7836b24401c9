"""The cube carved by its own images and true motion: files for everybody, and a target of it."""

import json

import numpy as np
import pytest
import trimesh

from bench.cli import main
from bench.estimating.unknown.shape_files import make_shapes, read_surface, shape_folder
from bench.scoring.unknown.inertia_score import inertia_score
from models.dataset.dataset import open_dataset
from models.motion.tumble import CAM_FROM_LVLH
from models.spacecraft.own.build import read_own_target
from pipelines.unknown_target.knowledge import mean_motion_of
from pipelines.unknown_target.past_poses import KnownMotion
from tests.support.textured_cube import CAMERA, HALF_M
from tests.support.told_cube import (
    INERTIA_KG_M2,
    ON_IT,
    SIGMA_M,
    TRUE_FROM_OWN,
    told,
    write_told,
)
from tests.support.unknown_cube import DISTANCE_M, off_the_cube_m, write_cube

COUNT = 200  # frames at 2.0 deg/s: more than a turn
ROUND_DEG_S = 1.5, 0.4, 1.2  # nearly across the line of sight: the camera goes all round
PIXEL_M = DISTANCE_M / CAMERA.fx
TIDE = 2e-3  # rad: gravity's gradient turns the estimates' motion, and not the cube
FLOAT32_M = 1e-6  # of numbers of a metre, in files


@pytest.fixture(scope="module")
def carved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("told") / "cube"
    truths = write_cube(folder, COUNT, ROUND_DEG_S)
    write_told(folder, truths)
    files = make_shapes(open_dataset(folder))
    return folder, truths, files


def test_earlier_poses_follow_from_the_last(carved):
    folder, truths, _ = carved
    frame = open_dataset(folder).frame(COUNT - 1)
    known = KnownMotion.of(told(truths[-1]), CAM_FROM_LVLH.rotation, mean_motion_of(frame))
    where = known.at(np.array([truth.time_s for truth in truths]))
    true = np.array([truth.cam_from_target.rotation @ TRUE_FROM_OWN for truth in truths])
    places = np.array([truth.cam_from_target.translation for truth in truths])
    assert np.allclose(where.R_cam_from_target, true, atol=TIDE)
    assert np.allclose(where.t_cam_from_target, places, atol=1e-3)


def test_the_surface_is_the_cubes(carved):
    folder, _, _ = carved
    own = read_surface(open_dataset(folder), "best") @ TRUE_FROM_OWN.T
    off = off_the_cube_m(own.reshape(-1, 3))
    assert np.median(off) < 1.5 * PIXEL_M  # outlines err by 0.7 px, shadows are none
    # The camera goes round one axis: what stands before a side's middle, seen askew at best by the
    # angle between that axis and the side, is left there.
    assert np.sqrt(np.mean(off**2)) < 0.1 * HALF_M
    volume = trimesh.Trimesh(own.reshape(-1, 3), np.arange(3 * len(own)).reshape(-1, 3)).volume
    assert (2.0 * HALF_M) ** 3 < 1.02 * volume < 1.25 * (2.0 * HALF_M) ** 3


def test_another_reader_finds_the_same_in_all_files(carved):
    folder, _, files = carved
    home = shape_folder(folder, "best")
    assert {path.name for path in files} == {
        "surface.glb",
        "surface.ply",
        "cloud.ply",
        "shape.json",
    }
    glb = trimesh.load(home / "surface.glb", force="mesh", process=False)
    ply = trimesh.load(home / "surface.ply", process=False)
    assert glb.is_watertight
    assert np.array_equal(glb.faces, ply.faces)
    assert np.allclose(glb.vertices, ply.vertices, atol=FLOAT32_M)
    cloud = trimesh.load(home / "cloud.ply", process=False)
    assert np.allclose(cloud.vertices @ TRUE_FROM_OWN.T, ON_IT, atol=FLOAT32_M)
    raw = cloud.metadata["_ply_raw"]["vertex"]["data"]
    assert np.allclose(raw["sigma_m"].ravel(), SIGMA_M)
    said = json.loads((home / "shape.json").read_text())
    assert said["points"] == len(ON_IT)
    assert said["no_surface"] == ""


def test_what_is_there_is_not_made_again_and_what_is_stale_is(carved):
    folder, _, files = carved
    before = [path.stat().st_mtime_ns for path in files]
    assert make_shapes(open_dataset(folder)) == files
    assert [path.stat().st_mtime_ns for path in files] == before
    path = folder / "estimates" / "best.jsonl"
    kept = path.read_text()
    path.write_text(kept + "\n")
    assert read_surface(open_dataset(folder), "best") is None
    path.write_text(kept)
    assert read_surface(open_dataset(folder), "best") is not None


def test_a_run_becomes_a_spacecraft_with_the_cubes_edges(carved, tmp_path, monkeypatch):
    folder, _, _ = carved
    monkeypatch.chdir(tmp_path)
    assert main(["new", "target", "carved", "--from", str(folder)]) == 0
    target = read_own_target(tmp_path / "carved.toml")
    inertia = TRUE_FROM_OWN @ np.asarray(target.description.inertia_kg_m2) @ TRUE_FROM_OWN.T
    assert inertia_score(inertia, INERTIA_KG_M2).entries_percent < 1e-6
    wireframe = target.known_wireframe
    corners = wireframe.points_in_target @ TRUE_FROM_OWN.T
    assert len(wireframe.edges) >= 8
    off = off_the_cube_m(corners)
    assert np.median(off) < 0.1 * HALF_M


def test_a_run_without_a_surface_makes_no_spacecraft(tmp_path, monkeypatch, capsys):
    truths = write_cube(tmp_path / "short", 24)
    write_told(tmp_path / "short", truths)
    make_shapes(open_dataset(tmp_path / "short"))
    monkeypatch.chdir(tmp_path)
    capsys.readouterr()
    assert main(["new", "target", "carved", "--from", "short"]) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "102 deg apart or more, got" in said
    assert "deg by 24 images; give" in said
    assert main(["new", "case", "carved", "--from", "short"]) == 2
    assert "with `rvbench new target`" in " ".join(capsys.readouterr().err.split())
    assert not list(tmp_path.glob("carved*"))
