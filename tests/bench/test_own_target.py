"""A spacecraft of one's own, all the way: rendered, and met by pipelines without its mesh."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from bench import api
from bench.cli import main
from bench.estimating.foreign_knowledge import markers_and_wireframe
from models.dataset.dataset import open_dataset
from models.dataset.estimates_file import read_estimates
from models.dataset.image_file import read_image
from tests.support.own_meshes import millimetre_stl, textured_glb, toml_of

RANGE_M = 9.0
CASE: dict[str, Any] = {
    "name": "own",
    "target": "craft/boxsat.toml",
    "camera": {"width": 256},
    "motion": {"end_s": 8.0, "rate_hz": 0.25},
    "sun": {"default": "0.86,0.38,0.33"},
    "earth": {"shines": True},
    "optics": {"f_number": 8.0},
    "render": {"samples": 4, "max_depth": 2},
    "exposure": {"mode": "auto"},
    "tumble": {
        "orbit": {"a_km": 7143.1, "i_deg": 98.2, "raan_deg": 79.2, "argument_of_perigee_deg": 85.9},
        "rho0_m": [0.0, RANGE_M, 0.0],
        "omega0_deg_s": [0.5, -0.3, 0.2],
        "q_lvlh_from_target_wxyz": [0.8, 0.4, 0.4, 0.2],
    },
}


def _lines(path: Path) -> list[str]:
    return path.read_text().splitlines()


@pytest.fixture(scope="module")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("own")
    (folder / "craft").mkdir()
    toml_of(textured_glb(folder / "craft" / "boxsat.glb"))
    (folder / "case.toml").write_text(tomli_w.dumps(CASE))
    api.render(str(folder / "case.toml"), folder / "out", store=folder / "store")
    return folder


def test_the_public_half_is_estimated_without_mesh_truth_or_renders(
    rendered: Path, tmp_path: Path
) -> None:
    public = Path(shutil.copytree(rendered / "out", tmp_path / "public"))
    truth = [json.loads(line) for line in _lines(public / "truth" / "exposures.jsonl")]
    shutil.rmtree(public / "truth")
    shutil.move(rendered / "craft", tmp_path / "gone")
    try:
        assert main(["estimate", str(public), "--pipelines", "uncooperative"]) == 0
    finally:
        shutil.move(tmp_path / "gone", rendered / "craft")
    said = read_estimates(public / "estimates" / "best.jsonl")
    poses = {each.frame: each.pose for each in said if each.pose is not None}
    assert len(poses) >= 2, [each.reason for each in said]
    for row in truth:
        if (pose := poses.get(row["frame"])) is None:
            continue
        away = pose.cam_from_target.translation - row["t_cam_from_target_m"]
        assert np.linalg.norm(away) < 0.01 * RANGE_M
        turn = pose.cam_from_target.rotation @ np.array(row["R_cam_from_target"]).T
        assert np.trace(turn) > 1.0 + 2.0 * np.cos(np.deg2rad(3.0))


def test_its_parts_are_labelled_and_lit(rendered: Path) -> None:
    truth = rendered / "out" / "truth"
    labels = json.loads((truth / "parts.json").read_text())
    assert {"bus", "panel", "boom"} <= set(labels)
    dataset = open_dataset(rendered / "out")
    assert dataset.info.target == "boxsat"
    image = read_image(rendered / "out" / "frames" / "000000.png")
    assert (image > 400).sum() > 200


def test_the_same_command_goes_on_and_changes_nothing(rendered: Path) -> None:
    before = {path: path.read_bytes() for path in (rendered / "out" / "frames").iterdir()}
    api.render(str(rendered / "case.toml"), rendered / "out", store=rendered / "store")
    assert {path: path.read_bytes() for path in before} == before


def test_frames_of_others_may_show_it(tmp_path: Path) -> None:
    toml = toml_of(millimetre_stl(tmp_path / "a.stl"), 'unit = "mm"')
    markers, wireframe = markers_and_wireframe(str(toml))
    assert markers is None
    assert wireframe is not None
    assert len(wireframe) >= 14
