"""The whole study, tiny: the same bits however it is run, and a page that opens by itself."""

from __future__ import annotations

import io
import json
import re
import shutil
from pathlib import Path

import pytest
from rich.console import Console

from bench.runners.chunks import Chunk
from bench.suites.request import SuiteRequest
from bench.suites.shared_units import do_share, shares_of
from bench.suites.uncooperative_suns import frame_plan, suite
from bench.suites.uncooperative_suns.plan import Plan, Sizes
from bench.suites.uncooperative_suns.suite import STUDY, plan_of
from bench.suites.units import WorkUnit, outcome_path
from models.errors import ScenarioError

SIZES = Sizes(runs=1, paper_runs=1, width=128, samples=2, seed=5)
QUIET = Console(file=io.StringIO())


def plan(out: Path) -> Plan:
    return Plan(SIZES, ("hispasat",), out)


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("suns") / "out"
    STUDY.run(plan(out), 1, QUIET)
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
    STUDY.run(plan(out), 2, QUIET)
    for folder, unit in gone:
        same = outcome_path(done / folder.name, unit).read_bytes()
        assert outcome_path(folder, unit).read_bytes() == same


def test_shares_write_the_bytes_of_one_machine_and_render_only_what_they_look_at(
    done: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A motion is of one job, whichever variants look at it: the other job renders nothing."""
    monkeypatch.setattr(suite, "QUICK", SIZES)
    out = tmp_path / "out"
    request = SuiteRequest("uncooperative-suns", out, 1, ("hispasat",), quick=True, seed=SIZES.seed)
    units = suite.units_of(request)
    assert [unit.name for unit in units] == [unit.name for unit in plan(out).units]
    shared = [share for share in shares_of(units, 2) if share]
    assert [len(share) for share in shared] == [len(units)]
    with_work = shares_of(units, 2).index(shared[0])
    assert do_share(suite.__name__, request, Chunk(1 - with_work, 2), QUIET) == 0
    assert not out.exists()
    assert do_share(suite.__name__, request, Chunk(with_work, 2), QUIET) == len(units)
    for folder, own in (("frames", plan(out).every_frame), ("units", units)):
        for unit in own:
            same = outcome_path(done / folder, unit).read_bytes()
            assert outcome_path(out / folder, unit).read_bytes() == same
    assert not (out / "suite.json").exists()


def test_a_job_renders_the_motions_of_its_own_starts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rendered = list[list[str]]()

    def note(units: list[WorkUnit], *_: object) -> int:
        rendered.append([unit.name for unit in units])
        return 0

    monkeypatch.setattr(frame_plan, "do_units", note)
    request = SuiteRequest("uncooperative-suns", tmp_path, 1, runs=20)
    every = shares_of(suite.units_of(request), 3)
    for share in every:
        suite.prepare(request, share, QUIET)
    flat = [name for names in rendered for name in names]
    assert sorted(flat) == sorted(unit.name for unit in suite.plan_of(request).every_frame)
    assert len(flat) == 3 * 5  # five motions of four starts, of three targets, each in one job
    assert all(rendered)
    left = [unit for unit in every[0] if "/best/" in unit.name][:1]
    suite.prepare(request, left, QUIET)
    assert rendered[-1] == [left[0].name.replace("/best/", "/")]


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
    with pytest.raises(ScenarioError, match="got 'maxar1300'"):
        plan_of(SuiteRequest("uncooperative-suns", Path("out"), 1, parts=("maxar1300",)))
