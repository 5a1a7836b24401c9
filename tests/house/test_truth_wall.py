"""The wall between what a pipeline gets and what is true, tried from outside.

A subprocess estimates a dataset whose truth is deleted: the estimates are the same to the byte,
nothing of the renderer was loaded, and, where truth is there, nothing of it was opened.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from bench import api
from models.dataset.estimates_file import read_estimates
from tests.support.patience import HANGS_S
from tests.support.synthetic_dataset import write_dataset
from tests.support.synthetic_images import write_images

HOUSE = Path(__file__).resolve().parents[2]
VARIANTS = ("paper", "best")

# Runs a command of rvbench and prints, last, what was loaded and which truths were opened.
WATCHED = """
import json, sys
opened = []
def watch(event, arguments):
    if event == "open" and isinstance(arguments[0], (str, bytes)):
        opened.append(str(arguments[0]))
sys.addaudithook(watch)
from bench.cli import main
code = main(sys.argv[1:])
roots = {name.split(".")[0] for name in sys.modules}
print(json.dumps({"code": code, "loaded": sorted(roots), "opened": opened}))
"""


# The same for single images; the trial of many starts is that pipeline again: it is loaded only.
WATCHED_IMAGES = WATCHED.replace(
    "from bench.cli import main\ncode = main(sys.argv[1:])",
    """
from pathlib import Path
import bench.estimating.tumble.starts
from bench.estimating.estimation import taking_part
from bench.estimating.runner import estimate_run
from models.dataset.dataset import open_dataset
dataset = open_dataset(Path(sys.argv[1]))
chosen, count = taking_part(dataset), len(dataset.entries)
code = len(estimate_run(dataset.folder, 0, dataset.frames(), dataset.onboard, chosen, count))
""",
)


def watched(*arguments: str, program: str = WATCHED) -> dict:
    try:
        result = subprocess.run(
            [sys.executable, "-c", program, *arguments],
            cwd=HOUSE,
            env={**os.environ, "PYTHONPATH": str(HOUSE)},
            capture_output=True,
            text=True,
            check=False,
            timeout=HANGS_S,
        )
    except subprocess.TimeoutExpired as error:
        what = " ".join(arguments)
        pytest.fail(f"waited {HANGS_S:g} s for `rvbench {what}` to end; it said {error.stderr!r}")
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> tuple[Path, dict]:
    """Return a dataset with both halves, estimated, and what estimating it did."""
    folder = tmp_path_factory.mktemp("wall") / "whole"
    write_dataset(folder, frames=3)
    return folder, watched("estimate", str(folder))


def test_estimating_loads_no_renderer_and_opens_no_truth(whole):
    folder, did = whole
    assert did["code"] == 0
    assert {"renders", "mitsuba", "drjit"}.isdisjoint(did["loaded"])
    assert "pipelines" in did["loaded"]
    assert any(str(folder / "frames") in path for path in did["opened"])
    assert not [path for path in did["opened"] if "truth" in Path(path).parts]


def test_without_truth_the_estimates_are_the_same_to_the_byte(whole, tmp_path):
    folder, _ = whole
    blind = tmp_path / "blind"
    shutil.copytree(folder, blind)
    shutil.rmtree(blind / "truth")
    shutil.rmtree(blind / "estimates")
    did = watched("estimate", str(blind))
    assert did["code"] == 0
    assert {"renders", "mitsuba", "drjit"}.isdisjoint(did["loaded"])
    for variant in VARIANTS:
        name = f"{variant}.jsonl"
        said = (blind / "estimates" / name).read_bytes()
        assert said == (folder / "estimates" / name).read_bytes()
        assert said.count(b'"pose": {') == 3


@pytest.mark.parametrize("verb", ["score", "report", "show"])
def test_scoring_reporting_and_showing_load_no_mitsuba(whole, verb):
    folder, _ = whole
    if verb == "report":
        api.score(folder)
    did = watched(verb, str(folder), *(["0"] if verb == "show" else []))
    assert did["code"] == 0
    assert {"mitsuba", "drjit"}.isdisjoint(did["loaded"])
    assert [path for path in did["opened"] if "truth" in Path(path).parts]


def test_single_images_are_estimated_the_same_to_the_byte_without_truth(tmp_path):
    seeing, blind = tmp_path / "seeing", tmp_path / "blind"
    write_images(seeing, frames=1, start_s=100.0, width_px=128)
    shutil.copytree(seeing, blind)
    shutil.rmtree(blind / "truth")
    for folder in (seeing, blind):
        did = watched(str(folder), program=WATCHED_IMAGES)
        assert did["code"] == len(VARIANTS)
        assert {"renders", "mitsuba", "drjit"}.isdisjoint(did["loaded"])
        assert any(str(folder / "frames") in path for path in did["opened"])
        assert not [path for path in did["opened"] if "truth" in Path(path).parts]
    for variant in VARIANTS:
        name = f"{variant}.jsonl"
        said = (blind / "estimates" / name).read_bytes()
        assert said == (seeing / "estimates" / name).read_bytes()
        assert said.count(b"\n") == 2  # the format, and one frame
    best = read_estimates(blind / "estimates" / "best.jsonl")
    assert any(best)  # blind, and yet it sees


def test_the_watch_sees_what_it_watches_for(whole):
    """The test above, tested: rendering's rooms do show when they are loaded."""
    did = watched("list")
    assert "renders" in did["loaded"]
