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
from bench.suites.uncooperative_tumbles.plan import Plan, Sizes
from bench.suites.uncooperative_tumbles.suite import STUDY, plan_of
from bench.suites.units import outcome_path
from models.errors import ScenarioError

SIZES = Sizes(runs=1, width=128, samples=2, images=3, seed=5)
QUIET = Console(file=io.StringIO())


def plan(out: Path) -> Plan:
    return Plan(SIZES, ("hispasat",), out)


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("tumbles") / "out"
    STUDY.run(plan(out), 1, QUIET)
    return out


def test_what_is_gone_is_done_again_to_the_same_bits(done: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    shutil.copytree(done, out)
    gone = [
        *((out / "frames", unit) for unit in plan(out).every_frame),
        *((out / "units", unit) for unit in plan(out).starts("hispasat", "best")),
    ]
    for folder, unit in gone:
        outcome_path(folder, unit).unlink()
    STUDY.run(plan(out), 2, QUIET)
    for folder, unit in gone:
        same = outcome_path(done / folder.name, unit).read_bytes()
        assert outcome_path(folder, unit).read_bytes() == same


def test_every_image_ends_with_a_state_or_without(done: Path) -> None:
    found = json.loads((done / "suite.json").read_text())["targets"]["hispasat"]
    for variant in ("best", "paper"):
        one = found[variant]
        assert one["images"] == SIZES.images
        assert one["right"] + one["wrong"] + one["without"] == SIZES.images


def test_the_page_opens_offline_and_says_what_is_asked(done: Path) -> None:
    text = (done / "suite.html").read_text()
    assert not re.search("https?:", text.replace("http://www.w3.org", ""))
    assert "no wrong state for more than 3 images" in text


def test_a_target_without_a_wireframe_is_refused() -> None:
    with pytest.raises(ScenarioError, match="got 'maxar1300'"):
        plan_of(SuiteRequest("uncooperative-tumbles", Path("out"), 1, parts=("maxar1300",)))
