"""A verb written as what one types, and parsed again, is the same verb."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.cli import parse
from bench.random_dataset.verb import Dataset
from bench.runners.arguments import typed_arguments
from bench.runners.options import JOBS, NAMES, RunnerRequest, runner_request
from bench.suites.verb import Suite
from models.errors import ScenarioError

COUNTS = st.none() | st.integers(1, 10**6)
WORDS = st.text("abcS-2", min_size=1, max_size=6).filter(lambda text: not text.startswith("-"))
SUITES = st.builds(
    Suite,
    name=st.sampled_from(["pesce2019", "vinag2018"]),
    out=st.none() | WORDS.map(lambda text: Path("/shared") / text),
    workers=COUNTS,
    parts=st.lists(WORDS, max_size=3).map(tuple),
    quick=st.booleans(),
    runs=COUNTS,
    duration_s=st.none() | st.floats(1e-3, 1e6),
    store=st.none() | WORDS.map(lambda text: Path("/store of all") / text),
    seed=st.integers(0, 2**63),
)


@given(SUITES)
def test_a_suite_is_parsed_as_it_was(verb: Suite) -> None:
    assert parse(typed_arguments("suite", verb, NAMES)) == verb


def test_who_does_it_is_left_out_and_paths_are_absolute(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    verb = Dataset(Path("mine.toml"), Path("out"), only=(3, 7), variant="llvm")
    sent = replace(verb, runner="slurm", jobs=4, sbatch=("time=1:00",))
    typed = typed_arguments("dataset", sent, NAMES)
    absolute = replace(verb, spec=tmp_path / "mine.toml", out=tmp_path / "out")
    assert parse(typed) == absolute


def test_where_this_process_does_the_work_nothing_is_asked_of_a_cluster() -> None:
    assert runner_request("local", None, 2, (), None, "1/4") is None
    asked = runner_request("slurm", None, None, ("time=1:00",), None, None)
    assert asked == RunnerRequest("slurm", JOBS, 1, ("time=1:00",))


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (("local", 4, None, (), None, None), "--jobs with --runner slurm or dask alone"),
        (("dask", 4, None, ("time=1",), "tcp://a:1", None), "--sbatch with --runner slurm alone"),
        (("slurm", 4, None, (), "tcp://a:1", None), "--scheduler with --runner dask alone"),
        (("slurm", 4, None, (), None, "0/4"), "either --runner slurm or --chunk"),
        (("dask", 4, None, (), None, None), "expected --scheduler tcp://HOST:PORT"),
        (("slurm", 0, None, (), None, None), "--jobs"),
    ],
)
def test_options_that_do_not_go_together_are_refused(asked: tuple, words: str) -> None:
    with pytest.raises(ScenarioError, match=words):
        runner_request(*asked)
