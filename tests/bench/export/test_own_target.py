"""A spacecraft of one's own leaves in every format, as those do that have a name here."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import tomli_w
import trimesh

from bench import api
from bench.cli import main
from bench.export.check import check_export
from bench.export.exporter import export_datasets
from bench.export.formats.catalogue import FORMATS
from bench.export.plan import make_plan
from bench.export.request import ExportRequest
from bench.export.source import open_source
from models.errors import ScenarioError
from tests.support.own_meshes import BOOM_M, BUS_M, PANEL_M, textured_glb, toml_of

CASE = {
    "name": "own",
    "target": "craft/boxsat.toml",
    "camera": {"width": 96},
    "motion": {"end_s": 4.0, "rate_hz": 0.5},
    "sun": {"default": "0.86,0.38,0.33"},
    "exposure": {"mode": "auto"},
    "render": {"samples": 4, "max_depth": 2},
    "tumble": {
        "orbit": {"a_km": 7143.1, "i_deg": 98.2, "raan_deg": 79.2, "argument_of_perigee_deg": 85.9},
        "rho0_m": [0.0, 9.0, 0.0],
        "omega0_deg_s": [0.5, -0.3, 0.2],
        "q_lvlh_from_target_wxyz": [0.8, 0.4, 0.4, 0.2],
    },
}
SIDES_MM = 1e3 * np.array([BUS_M[0] + 0.1 + PANEL_M[0], 0.95, BUS_M[2] + BOOM_M[2]])


def rendered(folder: Path, scale: float = 1.0) -> Path:
    (folder / "craft").mkdir(parents=True)
    toml_of(textured_glb(folder / "craft" / "boxsat.glb", scale=scale))
    (folder / "case.toml").write_text(tomli_w.dumps(CASE))
    api.render(str(folder / "case.toml"), folder / "data", store=folder / "store")
    return folder / "data"


@pytest.fixture(scope="module")
def own(tmp_path_factory) -> Path:
    return rendered(tmp_path_factory.mktemp("own"))


@pytest.mark.parametrize("kind", list(FORMATS))
def test_it_leaves_in_every_format(kind, own, tmp_path):
    out = tmp_path / "out"
    export_datasets(ExportRequest((own,), kind, out, split=(0.4, 0.3, 0.3)))
    name, found = check_export(out)
    assert (name, found.faults, found.images, found.objects) == (kind, [], 3, 3)
    told = json.loads((out / "targets.json").read_text())["boxsat"]
    assert len(told["keypoints"]) == len(told["keypoints_in_target_m"]) > 10
    assert told["skeleton"]
    if kind == "bop":
        mesh = trimesh.load(out / "models" / "obj_000001.ply")
        assert np.allclose(np.ptp(mesh.bounds, axis=0), SIDES_MM, atol=0.01)


def test_two_of_the_same_name_and_another_shape_are_refused(own, tmp_path):
    other = rendered(tmp_path / "other", scale=1.2)
    sources = [open_source(number + 1, folder) for number, folder in enumerate((own, other))]
    with pytest.raises(ScenarioError, match="expected every dataset of boxsat to show the same"):
        make_plan(sources, (0.8, 0.1, 0.1), 0, 1)


@pytest.mark.parametrize("gone", [True, False])
def test_without_its_mesh_it_does_not_leave(gone, own, tmp_path, capsys):
    mesh = own.parent / "craft" / "boxsat.glb"
    shutil.copy(mesh, tmp_path / "kept.glb")
    try:
        mesh.unlink() if gone else textured_glb(mesh, scale=1.1)
        assert main(["export", str(own), "--as", "coco", "--out", str(tmp_path / "out")]) == 2
    finally:
        shutil.copy(tmp_path / "kept.glb", mesh)
    message = capsys.readouterr().err
    assert str(mesh) in message
    assert "expected" in message
    assert not (tmp_path / "out").exists()
