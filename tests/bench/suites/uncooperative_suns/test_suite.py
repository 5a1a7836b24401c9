"""The whole study, tiny: the same bits however it is run, and a page that opens by itself."""

from __future__ import annotations

import io
import json
import re
import shutil
from pathlib import Path

import pytest
from rich.console import Console

from bench.suites.request import SuiteRequest
from bench.suites.uncooperative_suns.plan import Plan, Sizes
from bench.suites.uncooperative_suns.suite import plan_of, run_plan
from bench.suites.units import outcome_path
from models.errors import ScenarioError

SIZES = Sizes(runs=1, paper_runs=1, width=128, samples=2, seed=5)
QUIET = Console(file=io.StringIO())


def plan(out: Path) -> Plan:
    return Plan(SIZES, ("hispasat",), out)


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("suns") / "out"
    run_plan(plan(out), 1, QUIET)
    return out


def test_frames_and_starts_are_the_same_bits_when_done_again(done: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    shutil.copytree(done, out)
    gone = [
        *((out / "frames", unit) for unit in plan(out).frames("hispasat")),
        *((out / "units", unit) for unit in plan(out).starts("hispasat", "best")),
    ]
    for folder, unit in gone:
        outcome_path(folder, unit).unlink()
    run_plan(plan(out), 2, QUIET)
    for folder, unit in gone:
        same = outcome_path(done / folder.name, unit).read_bytes()
        assert outcome_path(folder, unit).read_bytes() == same


def test_every_start_ends_in_one_of_three_ways(done: Path) -> None:
    found = json.loads((done / "suite.json").read_text())["targets"]["hispasat"]
    for variant in ("best", "paper"):
        every = found[variant]["every"]
        assert every["starts"] == 4
        assert every["found"] + every["wrong"] + every["refused"] == 4
        assert sum(found[variant]["reasons"].values()) == every["refused"]


def test_the_page_opens_offline(done: Path) -> None:
    text = (done / "suite.html").read_text()
    assert not re.search("https?:", text.replace("http://www.w3.org", ""))
    assert "hispasat" in text


def test_a_target_without_a_wireframe_is_refused() -> None:
    with pytest.raises(ScenarioError, match="maxar1300"):
        plan_of(SuiteRequest("uncooperative-suns", Path("out"), 1, parts=("maxar1300",)))
