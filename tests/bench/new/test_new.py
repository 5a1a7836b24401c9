"""Start files run as they are, show every key there is, and never replace anything."""

import re
import tomllib
from pathlib import Path

import pytest
from pydantic import BaseModel

from bench.cli import main
from bench.new.case_text import case_text
from models.camera import Camera, camera_preset
from renders.scenario.scenario import RenderRequest, Scenario, read_scenario, resolve

UNCOMMENTED = re.compile(r"^#(?=\w+ = |\[)", re.MULTILINE)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_case_can_be_rendered_as_it_is(here, capsys):
    assert main(["new", "case", "mine"]) == 0
    assert "rvbench run mine.toml --out out/mine" in capsys.readouterr().out
    scenario = resolve(RenderRequest(case="mine.toml", out=here / "out"))
    assert scenario.name == "mine"
    assert len(scenario.times_s) == 5


def test_what_a_case_leaves_in_comments_are_the_defaults(here):
    """Taken out of its comments, all but [tumble] changes nothing."""
    (here / "mine.toml").write_text(case_text("mine"))
    as_written = read_scenario(here / "mine.toml")
    text = UNCOMMENTED.sub("", case_text("mine"))
    pairs_only = text[: text.index("\n[tumble]")]
    assert pairs_only.count("\n[") > 10
    (here / "all.toml").write_text(pairs_only)
    assert read_scenario(here / "all.toml") == as_written


def test_the_free_target_of_a_case_can_be_taken_out_of_its_comments(here):
    text = UNCOMMENTED.sub("", case_text("mine")).replace("marker_samples", "#")
    text = text.replace('"maxar1300"', '"xmm"').replace('default = "S2"', 'default = "1,0,0"')
    (here / "free.toml").write_text(text.replace('mode = "schedule"', 'mode = "auto"'))
    tumble = read_scenario(here / "free.toml").tumble
    assert tumble is not None
    assert tumble.rho0_m == (0.0, 30.0, 0.0)


def keys(table: type[BaseModel]) -> set[str]:
    found = set()
    for name, field in table.model_fields.items():
        kinds = [field.annotation, *getattr(field.annotation, "__args__", ())]
        inner = [k for k in kinds if isinstance(k, type) and issubclass(k, BaseModel)]
        found |= keys(inner[0]) if inner else {name}
    return found


def test_every_key_of_a_scenario_is_there_with_its_range():
    text = case_text("mine")
    missing = {key for key in keys(Scenario) if not re.search(rf"^#?{key} = ", text, re.MULTILINE)}
    assert not missing
    assert re.search(r"^#max_depth = 4 .*from 1 up to 32$", text, re.MULTILINE)
    assert re.search(r'^#mode = "schedule" .*"auto" or "fixed"', text, re.MULTILINE)


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
        assert f"expected no file at {place} yet, there is one" in capsys.readouterr().err
    assert (here / "mine.toml").read_text() == "my own"
    assert not (here / "absent").exists()


@pytest.mark.parametrize("name", ["../up", "a/b", ".hidden", "-x", "two words", ".toml"])
def test_a_name_that_is_none(here, name):
    assert main(["new", "case", "--", name] if name.startswith("-") else ["new", "case", name]) == 2
    assert list(here.iterdir()) == []
