"""The campaign sees every kind of fault, and a seed does the same again."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import numpy as np
import pytest

from bench.campaign.hostile.crew import _processor
from bench.campaign.hostile.kind import Kind
from bench.campaign.hostile.spoiling import spoil
from bench.campaign.hostile.spoilt_bytes import BYTE_SPOILS
from bench.campaign.hostile.spoilt_text import TEXT_SPOILS
from bench.campaign.hostile.tree import damage, tree
from bench.campaign.hostile.typed import typed_wrongly
from bench.campaign.hostile.verdict import Ended, Heard, judge
from bench.campaign.processes import contents, differences

TEXT = '[camera]\nwidth = 128\nname = "mine"\nlist = [1.0, 2.0]\n'
SEEDS = range(40)


@pytest.mark.parametrize("how", TEXT_SPOILS)
def test_text_is_spoilt_alike_by_the_same_seed(how):
    spoil_text = TEXT_SPOILS[how]
    spoilt = [spoil_text(np.random.default_rng(seed), TEXT) for seed in SEEDS]
    assert spoilt == [spoil_text(np.random.default_rng(seed), TEXT) for seed in SEEDS]
    assert len(set(spoilt)) > 1
    assert sum(each != TEXT for each in spoilt) > len(SEEDS) // 2


@pytest.mark.parametrize("how", BYTE_SPOILS)
def test_bytes_are_spoilt_alike_by_the_same_seed(how):
    data = bytes(range(256)) * 3
    spoilt = [BYTE_SPOILS[how](np.random.default_rng(seed), data) for seed in SEEDS]
    assert spoilt == [BYTE_SPOILS[how](np.random.default_rng(seed), data) for seed in SEEDS]
    assert sum(each != data for each in spoilt) > len(SEEDS) // 2


def test_one_file_of_a_kind_is_spoilt_and_no_other(tmp_path):
    kind = Kind("a", "ground", ("*.toml",), (("score", "{file}"),))
    for seed in SEEDS:
        folder = tmp_path / str(seed)
        folder.mkdir()
        for name in ("a.toml", "b.toml", "c.csv"):
            (folder / name).write_text(TEXT)
        spoilt = spoil(np.random.default_rng(seed), kind, folder)
        left = {"a.toml", "b.toml", "c.csv"} - {spoilt.path.name}
        assert all((folder / name).read_text() == TEXT for name in left)
        assert spoilt.path.suffix == ".toml"


def test_command_lines_are_typed_alike_by_the_same_seed():
    one, other = ([typed_wrongly(np.random.default_rng(s)) for s in SEEDS] for _ in range(2))
    assert one == other


REFUSED = "rvbench: expected a number, got 'x'\n"


@pytest.mark.parametrize(
    ("code", "errors", "ended", "fault"),
    [
        (2, REFUSED, Ended.REFUSED, ""),
        (1, "", Ended.REFUSED, ""),
        (0, "", Ended.ACCEPTED, ""),
        (None, "", Ended.ACCEPTED, ""),
        (2, "╭─ Required options ─╮\n", Ended.REFUSED, ""),
        (2, "", Ended.FAULT, "0 messages"),
        (2, REFUSED + REFUSED, Ended.FAULT, "2 messages"),
        (2, REFUSED + "more\n", Ended.FAULT, "several lines"),
        (2, "rvbench: \x1b]0;x\x07\n", Ended.FAULT, "control characters"),
        (2, f"rvbench: {'x' * 9000}\n", Ended.FAULT, "characters"),
        (139, "", Ended.FAULT, "exit code 139"),
        (2, "Traceback (most recent call last):\nKeyError: 1\n", Ended.FAULT, "KeyError: 1"),
        (0, "a.py:3: RuntimeWarning: overflow\n", Ended.FAULT, "overflow"),
    ],
)
def test_a_verdict_names_what_is_wrong(tmp_path, code, errors, ended, fault):
    verdict = judge(Heard(code, errors), never_right=False, damaged=[], written=tmp_path)
    assert verdict.ended == ended
    assert fault in verdict.fault


def test_what_cannot_be_right_must_be_refused(tmp_path):
    verdict = judge(Heard(0, ""), never_right=True, damaged=[], written=tmp_path)
    assert verdict.fault == "accepted what cannot be"


def test_json_that_is_none_is_a_fault(tmp_path):
    (tmp_path / "score.json").write_text('{"rms": NaN}')
    verdict = judge(Heard(0, ""), never_right=False, damaged=[], written=tmp_path)
    assert "score.json" in verdict.fault


def test_damage_is_seen_but_where_it_is_allowed(tmp_path):
    (tmp_path / "ours").mkdir()
    for name in ("mine.txt", "theirs.txt", "ours/a.json"):
        (tmp_path / name).write_text("a")
    before = tree(tmp_path)
    (tmp_path / "theirs.txt").write_text("b")
    (tmp_path / "mine.txt").unlink()
    (tmp_path / "ours" / "a.json").write_text("b")
    (tmp_path / "ours" / "new.json").write_text("b")
    assert damage(before, tree(tmp_path), ["ours/*"]) == ["mine.txt", "theirs.txt"]


def test_folders_that_differ_in_a_runtime_alone_are_alike(tmp_path):
    for name, runtime_ms, rms in (("a", 1.0, 2.0), ("b", 3.0, 2.0), ("c", 1.0, 2.5)):
        (tmp_path / name).mkdir()
        text = f'{{"core": {{"runtime_ms": {runtime_ms}, "rms": {rms}}}}}'
        (tmp_path / name / "score.json").write_text(text)
    a, b, c = (contents(tmp_path / name) for name in "abc")
    assert differences(a, b) == ""
    assert differences(a, c) == "score.json differs"
    assert differences(a, {}) == "score.json is missing"


WORKS, WAITS = "while True: pass", "import time; time.sleep(600)"
PARENT = "import subprocess, sys; subprocess.run([sys.executable, '-c', sys.argv[1]])"
LONG_S = 60.0  # for a process to be given a core, however busy the machine


def reached(condition):
    until = time.monotonic() + LONG_S
    while time.monotonic() < until:
        if condition():
            return True
        time.sleep(0.05)
    return False


@pytest.mark.parametrize("child", [WORKS, WAITS])
def test_who_waits_for_a_child_at_work_is_at_work(child):
    """A child that is starved of a core still runs, so its parent does not hang."""
    process = subprocess.Popen([sys.executable, "-c", PARENT, child], start_new_session=True)
    try:
        if child == WORKS:
            assert reached(lambda: _processor(process.pid)[0] > 0.5)
            assert not _processor(process.pid)[1]
        else:
            assert reached(lambda: _processor(process.pid)[1])
    finally:
        os.killpg(process.pid, 9)
        process.wait()
