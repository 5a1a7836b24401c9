"""Start files run as they are, show every key there is, and never replace anything."""

import os
import re
import runpy
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from pydantic import BaseModel

from bench.cli import main
from bench.new.case_text import case_text
from bench.random_dataset.spec import read_spec
from docs.site.page_blocks import blocks_of
from models.camera import Camera, camera_preset
from models.dataset.estimates_file import read_estimates
from models.onboard import OnboardKnowledge, PosePrior
from models.sensors.camera_chip import Detector
from models.spacecraft.own.build import read_own_target
from pipelines.registry import pipeline_names
from renders.scenario.own_target import OwnTargetTable
from renders.scenario.scenario import RenderRequest, Scenario, read_scenario, resolve
from tests.support.half_written import left_half_written
from tests.support.own_meshes import textured_glb
from tests.support.patience import HANGS_S
from tests.support.synthetic_pair import (
    CAMERA_1024,
    PATTERN,
    PRIOR_SIGMA_DEG,
    PRIOR_SIGMA_M,
    Scene,
    drawn_prior,
    facing_pose,
    render_pair,
)

FOUND_WITHIN_M = 0.01  # no marker was taken for another: they are 0.2 m apart and more

HOUSE = Path(__file__).resolve().parents[3]
UNCOMMENTED = re.compile(r"^#(?=\w+ = |\[)", re.MULTILINE)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("kind", ["case", "camera", "dataset"])
def test_what_was_left_half_written_is_swept(here, kind):
    half = left_half_written(here / "mine.toml")
    assert main(["new", kind, "mine"]) == 0
    assert not half.exists()


def test_a_case_can_be_rendered_as_it_is(here, capsys):
    assert main(["new", "case", "mine"]) == 0
    assert "rvbench run mine.toml --out out/mine" in capsys.readouterr().out
    scenario = resolve(RenderRequest(case="mine.toml", out=here / "out"))
    assert scenario.name == "mine"
    assert len(scenario.times_s) == 5


def test_what_a_case_leaves_in_comments_are_the_defaults(here):
    """Taken out of its comments, what every case has changes nothing."""
    (here / "mine.toml").write_text(case_text("mine"))
    every, need_not = case_text("mine").split("# What a case need not have")
    text, count = UNCOMMENTED.subn("", every)
    assert count > 60
    (here / "all.toml").write_text(text)
    assert read_scenario(here / "all.toml") == read_scenario(here / "mine.toml")
    optional = tomllib.loads(UNCOMMENTED.sub("", need_not).partition("\n")[2])
    assert "tumble" in optional
    assert set(optional) <= set(Scenario.model_fields)


def test_the_free_target_of_a_case_can_be_taken_out_of_its_comments(here):
    every, need_not = case_text("mine").split("# What a case need not have")
    (tumble,) = (part for part in need_not.split("\n\n") if "#[tumble]" in part)
    text = re.sub("^marker_samples", "#", every, flags=re.MULTILINE)
    text = text.replace('"maxar1300"', '"xmm"').replace('\ndefault = "S2"', '\ndefault = "1,0,0"')
    text = text.replace('#mode = "schedule"', 'mode = "auto"')
    (here / "free.toml").write_text(text + "\n" + UNCOMMENTED.sub("", tumble) + "\n")
    scenario = resolve(RenderRequest(case="free.toml", out=here / "out"))
    assert scenario.tumble is not None
    assert scenario.tumble.rho0_m == (0.0, 30.0, 0.0)


def keys(kind: object) -> set[str]:
    """Return the keys of a table, and of those within it, by their names alone."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return {
            key
            for name, field in kind.model_fields.items()
            for key in {name} | keys(field.annotation)
        }
    return {key for inner in get_args(kind) for key in keys(inner)}


def test_every_key_of_a_scenario_is_there_with_its_range():
    text = case_text("mine")
    typed = keys(Scenario) - {"own_target"} - keys(OwnTargetTable)
    missing = {key for key in typed if not re.search(rf"\b{key}( = |\])", text)}
    assert len(keys(Scenario)) > 100
    assert not missing
    assert re.search(r"^#max_depth = 4 .*from 1 up to 32$", text, re.MULTILINE)
    assert re.search(r'"auto" or "fixed".*\n(# .*\n)*#mode = "schedule"$', text, re.MULTILINE)
    assert max(len(line) for line in text.splitlines()) <= 100


def test_a_camera_is_the_chasers(here):
    assert main(["new", "camera", "cam.toml"]) == 0
    assert Camera.from_toml(here / "cam.toml") == camera_preset("chaser_fixed")
    assert "cx" in tomllib.loads((here / "cam.toml").read_text())


@pytest.mark.parametrize("kind", ["case", "camera"])
def test_nothing_is_written_over(here, kind, capsys):
    for place in ("mine.toml", "link.toml"):
        if place == "link.toml":
            (here / place).symlink_to("absent")
        else:
            (here / place).write_text("my own")
        assert main(["new", kind, place.removesuffix(".toml")]) == 2
        assert f"expected nothing at {place} yet, there is something" in capsys.readouterr().err
    assert (here / "mine.toml").read_text() == "my own"
    assert not (here / "absent").exists()


@pytest.mark.parametrize("name", ["../up", "a/b", ".hidden", "-x", "two words", ".toml"])
def test_a_name_that_is_none(here, name):
    assert main(["new", "case", "--", name] if name.startswith("-") else ["new", "case", name]) == 2
    assert list(here.iterdir()) == []


@pytest.mark.parametrize("kind", ["case", "camera", "target", "dataset"])
def test_what_is_written_is_accepted_under_a_name_with_dashes(here, kind):
    """A pipeline, by its own tests below, is called my-finder."""
    name = "my-own-2"
    if kind == "target":
        textured_glb(here / f"{name}.glb")
    assert main(["new", kind, name]) == 0
    read = {
        "case": read_scenario,
        "camera": Camera.from_toml,
        "target": read_own_target,
        "dataset": read_spec,
    }
    assert read[kind](here / f"{name}.toml")


@pytest.mark.parametrize(("kind", "most"), [("dataset", 32), ("case", 100)])
def test_a_name_that_would_be_refused_later_is_refused_now(here, kind, most, capsys):
    assert main(["new", kind, "n" * (most + 1)]) == 2
    assert f"{most} at most" in capsys.readouterr().err
    assert list(here.iterdir()) == []
    assert main(["new", kind, "n" * most]) == 0
    (read_spec if kind == "dataset" else read_scenario)(here / f"{'n' * most}.toml")


# A pipeline in a package of its own


@pytest.fixture
def package(here, monkeypatch) -> Path:
    """Return the folder of a new package, installed by hand: on the path, with its metadata."""
    assert main(["new", "pipeline", "my-finder"]) == 0
    folder = here / "my-finder"
    project = tomllib.loads((folder / "pyproject.toml").read_text())
    assert project["tool"]["setuptools"]["py-modules"] == ["my_finder"]
    info = folder / "rvbench_my_finder-0.1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: rvbench-my-finder\nVersion: 0.1.0\n"
    )
    ((group, points),) = project["project"]["entry-points"].items()
    rows = "".join(f"{name} = {place}\n" for name, place in points.items())
    (info / "entry_points.txt").write_text(f"[{group}]\n{rows}")
    monkeypatch.syspath_prepend(str(folder))
    return folder


def test_a_pipeline_is_found_and_says_why_it_finds_nothing(package, scored_dataset, here):
    """Beside ours, on every frame; its own are lost frames with a reason, and no failure."""
    data = here / "data"
    shutil.copytree(scored_dataset.folder, data)
    before = (data / "estimates" / "best.jsonl").read_bytes()
    assert "my-finder" in pipeline_names()
    assert main(["estimate", str(data)]) == 0
    said = read_estimates(data / "estimates" / "my-finder.jsonl")
    assert len(said) == len(scored_dataset.entries)
    for estimate in said:
        assert not estimate
        assert re.fullmatch(
            r"nothing is looked for yet; the largest difference is [1-9]\d+ DN", estimate.reason
        )
    assert (data / "estimates" / "best.jsonl").read_bytes() == before


def tried(package: Path) -> subprocess.CompletedProcess[str]:
    """Run the test that lies beside a new pipeline."""
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "."],
        cwd=package,
        env={**os.environ, "PYTHONPATH": os.pathsep.join((str(HOUSE), str(package)))},
        capture_output=True,
        text=True,
        check=False,
        timeout=HANGS_S,
    )


def test_the_test_of_a_pipeline_passes_and_can_fail(package):
    passed = tried(package)
    assert passed.returncode == 0, passed.stdout
    module = package / "my_finder.py"
    module.write_text(module.read_text().replace("return Estimate(", "return None and Estimate("))
    assert tried(package).returncode == 1


# The tutorial's pipeline, which takes its place


@pytest.fixture
def tutorials(package) -> Path:
    page = (HOUSE / "docs" / "tutorials" / "score-own-pipeline.md").read_text()
    (block,) = (each for each in blocks_of(page) if each.name == "my-finder/my_finder.py")
    (package / "my_finder.py").write_text(block.body)
    return package


def test_the_tutorials_pipeline_passes_the_test_beside_it(tutorials):
    passed = tried(tutorials)
    assert passed.returncode == 0, passed.stdout


@pytest.mark.parametrize("width", [512, 1024])
def test_the_tutorials_pipeline_finds_markers_in_images_of_any_size(tutorials, width):
    """From first poses drawn by its sigmas; a gate of some pixels would suit one size alone."""
    names = runpy.run_path(str(tutorials / "my_finder.py"))
    scene, pose = Scene(camera=CAMERA_1024.resized(width)), facing_pose(3.1)
    frame = render_pair(scene, pose)
    for seed in range(5):
        prior = PosePrior(drawn_prior(pose, seed), PRIOR_SIGMA_M, PRIOR_SIGMA_DEG)
        onboard = OnboardKnowledge(scene.camera, Detector(), markers=PATTERN, prior=prior)
        said = names["PIPELINE"].make(onboard, "default").process(frame)
        assert said.pose is not None, said.reason
        found = said.pose.cam_from_target.translation
        assert np.linalg.norm(found - pose.translation) < FOUND_WITHIN_M


def test_a_pipeline_can_be_built(here, tmp_path):
    """By the build backend that its project names, without a network."""
    assert main(["new", "pipeline", "finder_2"]) == 0
    built = subprocess.run(
        [sys.executable, "-c", "from setuptools import build_meta as b; print(b.build_wheel('.'))"],
        cwd=here / "finder_2",
        capture_output=True,
        text=True,
        check=False,
        timeout=HANGS_S,
    )
    assert built.returncode == 0, built.stderr
    with zipfile.ZipFile(next((here / "finder_2").glob("*.whl"))) as wheel:
        assert "finder_2.py" in wheel.namelist()
        points = next(name for name in wheel.namelist() if name.endswith("entry_points.txt"))
        assert b"finder_2 = finder_2:PIPELINE" in wheel.read(points)


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("Big", "of small letters"),
        ("a.b", "of small letters"),
        ("chaser_fixed", "there is a pipeline 'chaser_fixed'"),
        ("json", "no Python module has"),
        ("models", "no Python module has"),
        ("class", "no Python module has"),
    ],
)
def test_a_name_that_no_pipeline_can_have(here, name, why, capsys):
    assert main(["new", "pipeline", name]) == 2
    assert why in capsys.readouterr().err
    assert list(here.iterdir()) == []


def test_a_folder_of_the_users_own_is_no_package(here):
    (here / "mine").mkdir()
    assert main(["new", "pipeline", "mine"]) == 2
    assert list((here / "mine").iterdir()) == []
