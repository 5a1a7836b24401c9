"""A specification is read strictly, and what is wrong with it is told."""

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import tomli_w

from bench import api
from bench.cli import main
from bench.new.dataset_text import dataset_text
from bench.random_dataset.folder import FOLDER
from bench.random_dataset.parts import parts_of
from bench.random_dataset.spec import check_spec, differences, read_spec
from bench.random_dataset.spec_tables import Spec
from models.camera import Camera
from models.errors import ScenarioError
from tests.support.random_specs import spec_of

GOOD: dict[str, Any] = {
    "name": "small",
    "frames": 10,
    "target": [{"spacecraft": "hispasat"}],
    "camera": [{"name": "wide", "width": 64}],
}
UNCOMMENTED = re.compile(r"^#(?=\w+ = )", re.MULTILINE)


def read(folder: Path, **changed: Any) -> Spec:
    path = folder / "spec.toml"
    path.write_text(tomli_w.dumps({**GOOD, **changed}))
    return read_spec(path)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"frame": 10}, "unknown key frame; expected one of .*perhaps you meant frames"),
        ({"pose": {"range": [1, 2]}}, "unknown key pose.range;.*perhaps you meant range_m"),
        ({"target": [{"spacecraft": "xmm", "rang_m": [1, 2]}]}, "perhaps you meant range_m"),
        ({"camera": [{"name": "a", "widht": 64}]}, "perhaps you meant width"),
        ({"frames": "many"}, "expected frames to be a whole number .*got 'many'"),
        ({"frames": 0}, "expected frames from 1 to 1e\\+06"),
        ({"suns_per_pose": 1.5}, "expected suns_per_pose to be a whole number"),
        ({"pose": {"range_m": [20, 10]}}, r"pose\.range_m as least and most.*\[10, 20\] may have"),
        ({"pose": {"range_m": [0, 10]}}, r"pose\.range_m"),
        ({"pose": {"axis": [0, 0, 0]}}, r"pose\.axis of three numbers, not all zero"),
        ({"sun": {"phase_deg": [90, 10]}}, r"sun\.phase_deg as least and most"),
        ({"split": {"train": 0.9}}, r"to add up to 1, got 0\.9 \+ 0\.1 \+ 0\.1 = 1\.1"),
        ({"background": {"space": 0}}, "expected one of background.space, stars and earth above"),
        ({"camera": [{"name": "a"}, {"name": "A"}]}, r"each \[\[camera\]\] with a name of its own"),
        ({"target": [{"spacecraft": "xmm"}] * 2}, "with a spacecraft of its own, got 'xmm' 2"),
        ({"camera": [{"name": "../up"}]}, r"camera\.0\.name of letters, digits, _, \. and - alone"),
        ({"name": "n" * 33}, "name of letters, .* alone, 32 at most"),
        ({"camera": [{"name": "a", "preset": "no"}]}, "no"),
        ({"camera": [{"name": "a", "width": 64, "height": 64}]}, "camera a: expected camera.fx"),
        ({"target": []}, "target"),
        ({"target": {"spacecraft": "xmm"}}, r"target to be a list \(a table \[\[target\]\] for"),
        ({"render": {"seed": 3}}, "expected render.seed to be left out"),
        ({"camera": [{"name": "a", "file": "none.toml"}]}, "none.toml"),
    ],
)
def test_what_is_wrong_is_told(tmp_path: Path, changed: dict[str, Any], told: str) -> None:
    with pytest.raises(ScenarioError, match=told) as raised:
        read(tmp_path, **changed)
    assert "\n" not in str(raised.value)
    assert "validation" not in str(raised.value)


@pytest.mark.parametrize("text", ["name = ", "\0", "name = nan\nframes = 1"])
def test_what_is_no_specification_is_told(tmp_path: Path, text: str) -> None:
    (tmp_path / "spec.toml").write_text(text)
    with pytest.raises(ScenarioError, match=r"spec\.toml"):
        read_spec(tmp_path / "spec.toml")
    with pytest.raises(ScenarioError, match="rvbench new dataset"):
        read_spec(tmp_path / "absent.toml")


@pytest.mark.parametrize(
    ("only", "told"),
    [(("--only", "0", "4"), "without --only renders them"), ((), "same command renders them")],
)
def test_what_renders_the_frames_that_are_left_is_told(only, told, monkeypatch, capsys) -> None:
    monkeypatch.setattr(api, "dataset", lambda *_, **__: SimpleNamespace(left=55, folders=[]))
    assert main(["dataset", "spec.toml", "--out", "out", *only]) == 0
    assert f"left: 55 frames; the same command {told.removeprefix('same command ')}" in (
        capsys.readouterr().out
    )


def test_names_with_dashes_lead_to_folders_that_are_found_again(tmp_path: Path) -> None:
    spec = read(tmp_path, name="my-frames", camera=[{"name": "left-eye", "width": 64}])
    (part,) = parts_of(spec, tmp_path / "spec.toml")
    assert part.name == "hispasat-left-eye"
    assert FOLDER.fullmatch(part.name)


def test_a_cameras_file_lies_beside_the_specification(tmp_path: Path) -> None:
    own = Camera(80, 60, 100.0, 101.0, 39.0, 29.0, k1=-0.1)
    (tmp_path / "own.toml").write_text(own.to_toml())
    spec = read(tmp_path, camera=[{"name": "own", "file": "own.toml"}])
    assert (spec.camera[0].fx, spec.camera[0].k1, spec.camera[0].file) == (100.0, -0.1, None)
    with pytest.raises(ScenarioError, match=r"camera\.file alone"):
        read(tmp_path, camera=[{"name": "own", "file": "own.toml", "fx": 3.0}])


def test_the_start_file_is_read_and_its_comments_are_the_defaults(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(dataset_text("mine"))
    as_it_is = read_spec(path)
    assert as_it_is.frames == 60
    assert [each.spacecraft for each in as_it_is.target] == ["maxar1300", "xmm", "hispasat"]
    text, count = UNCOMMENTED.subn("", dataset_text("mine"))
    assert count > 40
    path.write_text(text)
    assert read_spec(path) == as_it_is
    for key in Spec.model_fields:
        assert re.search(rf"^#?\s?\[*{key}\b", text, re.MULTILINE), key


def test_rvbench_new_dataset_writes_it_and_says_what_to_type(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", "dataset", "mine"]) == 0
    assert "rvbench dataset mine.toml --out out/mine" in capsys.readouterr().out
    assert read_spec(Path("mine.toml")).name == "mine"


def test_differences_name_the_keys() -> None:
    one = spec_of(seed=1).model_dump(mode="json")
    other = spec_of(seed=2, camera=[{"name": "wide", "width": 128}]).model_dump(mode="json")
    assert differences(one, one) == []
    assert differences(one, other) == ["seed is 1, now 2", "camera.0.width is 64, now 128"]
    wider = spec_of(pose={"range_m": [10.0, 90.0]}).model_dump(mode="json")
    assert differences(one, wider) == ["pose.range_m.1 is 80.0, now 90.0"]


def test_a_specification_made_in_python_is_checked_alike() -> None:
    with pytest.raises(ScenarioError, match="add up to 1"):
        check_spec(spec_of(split={"train": 0.5}), "here")
