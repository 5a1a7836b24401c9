"""A suite's units by chunks: together they are all of it, and no more is done than was asked."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from bench.runners.chunks import Chunk
from bench.runners.options import RunnerRequest
from bench.status.readers import ASKED_NAME
from bench.suites.request import SuiteRequest
from bench.suites.shared_units import do_share, shares_of, suite_work
from bench.suites.spread import do_units
from bench.suites.units import is_done, outcome_path, read_outcome, write_outcome
from models.errors import ScenarioError
from tests.support.suite_work import draw_units, units_of

MODULE = units_of.__module__
COUNT = 7
QUIET = Console(file=io.StringIO())


def request_of(out: Path) -> SuiteRequest:
    return SuiteRequest("draws", out, 1, runs=COUNT)


def test_chunks_write_the_bytes_that_one_process_writes(tmp_path: Path) -> None:
    request = request_of(tmp_path / "chunks")
    done = [do_share(MODULE, request, Chunk(number, 3), QUIET) for number in (2, 0, 1)]
    assert sum(done) == COUNT
    assert do_share(MODULE, request, Chunk(1, 3), QUIET) == 0
    do_units(draw_units(COUNT), tmp_path / "one", 1, QUIET)
    for unit in draw_units(COUNT):
        own, alone = outcome_path(request.out / "units", unit), outcome_path(tmp_path / "one", unit)
        assert own.read_bytes() == alone.read_bytes()


def test_a_chunk_does_its_own_units_and_no_others(tmp_path: Path) -> None:
    request = request_of(tmp_path)
    do_share(MODULE, request, Chunk(0, 3), QUIET)
    done = {unit.name for unit in draw_units(COUNT) if is_done(tmp_path / "units", unit)}
    assert done == {unit.name for unit in shares_of(draw_units(COUNT), 3)[0]}


def test_units_over_the_same_frames_are_of_one_chunk() -> None:
    units = [replace(unit, reads=f"flight {k % 2}") for k, unit in enumerate(draw_units(COUNT))]
    for share in shares_of(units, 4):
        assert len({unit.reads for unit in share}) <= 1


def test_what_is_missing_is_counted_by_chunk_and_what_is_stale_is_missing(tmp_path: Path) -> None:
    request, runner = request_of(tmp_path), RunnerRequest("slurm", 3)
    work = suite_work(MODULE, request, runner, ["suite", "draws"])
    own = [len(share) for share in shares_of(draw_units(COUNT), 3)]
    assert work.missing() == dict(enumerate(own))
    other = replace(draw_units(COUNT)[0].task, count=5)
    stale = replace(shares_of(draw_units(COUNT), 3)[1][0], task=other)
    write_outcome(tmp_path / "units", stale, stale.done())
    do_share(MODULE, request, Chunk(0, 3), QUIET)
    assert work.missing() == {1: own[1], 2: own[2]}
    assert work.missing() == {1: own[1], 2: own[2]}  # without reading the stale one again
    do_share(MODULE, request, Chunk(1, 3), QUIET)
    assert work.missing() == {2: own[2]}
    assert work.command(2) == ["suite", "draws", "--chunk", "2/3"]
    assert read_outcome(tmp_path / "units", shares_of(draw_units(COUNT), 3)[1][0]) is not None


def test_a_chunk_writes_down_all_that_was_asked_for(tmp_path: Path) -> None:
    """So that the status of the folder counts all units, not a job's."""
    do_share(MODULE, request_of(tmp_path), Chunk(0, 3), QUIET)
    asked = json.loads((tmp_path / "units" / ASKED_NAME).read_text())["asked"]
    assert asked == [unit.name for unit in draw_units(COUNT)]


def test_a_suite_that_cannot_be_shared_out_says_so(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="cannot yet: leave out --runner and --chunk"):
        do_share("bench.suites.request", request_of(tmp_path), Chunk(0, 3), QUIET)
    assert not list(tmp_path.iterdir())
