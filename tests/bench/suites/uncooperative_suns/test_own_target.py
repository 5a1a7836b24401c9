"""A target of one's own in the study: drawn, told and counted as ours are, and refused at once."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from bench.suites.request import SuiteRequest
from bench.suites.uncooperative_suns.frames import drawn
from bench.suites.uncooperative_suns.plan import Plan, Sizes
from bench.suites.uncooperative_suns.suite import STUDY, units_of
from bench.suites.uncooperative_suns.told import REFLECTANCE_SIGMA, onboard_of
from models.errors import ScenarioError
from models.spacecraft.own.build import read_own_target
from tests.support.own_meshes import millimetre_stl, textured_glb, toml_of

SIZES = Sizes(runs=1, paper_runs=0, width=128, samples=2, seed=5)
QUIET = Console(file=io.StringIO())
MOST_SIGMAS = 4.0


@pytest.fixture(scope="module")
def probe(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return toml_of(textured_glb(tmp_path_factory.mktemp("own") / "probe.glb"), name="probe")


def test_it_is_counted_under_its_files_name(probe: Path, tmp_path: Path) -> None:
    STUDY.run(Plan(SIZES, (str(probe),), tmp_path / "out"), 1, QUIET)
    (found,) = json.loads((tmp_path / "out" / "suite.json").read_text())["targets"].values()
    every = found["best"]["every"]
    assert every["starts"] == 4
    assert every["found"] + every["wrong"] + every["refused"] == 4
    assert "probe" in (tmp_path / "out" / "suite.html").read_text()


def test_its_own_materials_are_told_each_off_by_its_error(probe: Path, tmp_path: Path) -> None:
    """The bus is of metal without a matt part, as its file has it; nothing of ours is like it."""
    (task, *_) = Plan(SIZES, (str(probe),), tmp_path).motions(str(probe))
    told = onboard_of(task, drawn(task), 0, 0.3).wireframe
    assert told is not None
    assert told.finish is not None
    craft = read_own_target(probe).spacecraft
    bus = next(part for part in craft.parts if part.name == "bus")
    mirror = craft.material_of(bus).specular.sunlight
    assert mirror > 0.0
    outer = told.finish.mirror.max()
    assert abs(np.log(outer / mirror)) < MOST_SIGMAS * REFLECTANCE_SIGMA


def test_another_unit_of_the_same_mesh_is_another_target(tmp_path: Path) -> None:
    mesh = millimetre_stl(tmp_path / "probe.stl")
    own = toml_of(mesh, 'unit = "mm"', name="probe")
    keys = []
    for unit in ("mm", "cm"):
        toml_of(mesh, f'unit = "{unit}"', name="probe")
        keys.append(Plan(SIZES, (str(own),), tmp_path).motions(str(own))[0])
    assert keys[0] != keys[1]


@pytest.mark.parametrize(
    ("file", "said"),
    [
        ("probe.stl", "rvbench inspect probe.stl"),
        ("missing.toml", "missing.toml: expected the TOML of a spacecraft"),
        ("ball.toml", "expected unit as one of m, cm"),
        ("flat.toml", "at least four corners"),
    ],
)
def test_what_cannot_be_tried_is_refused_before_anything_is_rendered(
    file: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    toml_of(millimetre_stl(tmp_path / "ball.stl"), name="ball")
    away = "origin = [30000.0, 0.0, 0.0]"
    toml_of(millimetre_stl(tmp_path / "flat.stl"), 'unit = "mm"', away, name="flat")
    request = SuiteRequest("uncooperative-suns", tmp_path / "out", 1, (file,), runs=4)
    with pytest.raises(ScenarioError, match=said):
        units_of(request)
