"""The time left is what the work done so far says, and no more than it knows."""

import io

import pytest
from rich.console import Console

from bench.sweep.time_left import LIGHT, POSES, StageClock, SweepProgress, told


def test_nothing_is_known_before_anything_is_done():
    clock = StageClock(100)
    assert clock.left_s is None
    clock.add(10, 20.0)
    assert clock.left_s == pytest.approx(180.0)


def test_the_first_step_counts_only_while_it_is_the_only_one():
    """It compiles kernels or starts processes."""
    clock = StageClock(30)
    clock.add(10, 60.0)
    assert clock.left_s == pytest.approx(120.0)
    clock.add(10, 5.0)
    assert clock.left_s == pytest.approx(5.0)
    clock.add(10, 5.0)
    assert clock.left_s == 0.0


def test_a_step_unlike_the_others_tells_nothing():
    clock = StageClock(22)
    clock.add(2, 60.0, telling=False)
    assert clock.left_s is None
    clock.add(10, 5.0)
    assert clock.left_s == pytest.approx(5.0)


def test_a_steady_pace_is_foretold_exactly():
    clock = StageClock(40)
    for done in range(4):
        clock.add(10, 7.0)
        assert clock.left_s == pytest.approx(7.0 * (3 - done))


def test_in_all_is_known_once_every_stage_is():
    said = io.StringIO()
    progress = SweepProgress(Console(file=said, width=200), {LIGHT: 20, POSES: 10})
    with progress.shown():
        progress.add(LIGHT, 10, 100.0)
        assert progress.left_s is None
        progress.add(POSES, 5, 10.0)
        assert progress.left_s == pytest.approx(110.0)
        progress.add(LIGHT, 10, 100.0)
        progress.add(POSES, 5, 10.0)
        assert progress.left_s == 0.0
    lines = said.getvalue()
    assert "light: 10 of 20; left: about 2 min; in all: not known yet" in lines
    assert "poses: 10 of 10; left: none; in all: none" in lines


def test_a_stage_without_work_takes_no_time():
    progress = SweepProgress(Console(file=io.StringIO()), {LIGHT: 0, POSES: 2})
    with progress.shown():
        progress.add(POSES, 1, 4.0)
        assert progress.left_s == pytest.approx(4.0)


def test_times_are_told_with_the_digits_of_an_estimate():
    assert [told(s) for s in (None, 0.0, 3.0, 42.0, 55.0, 100.0, 754.0, 6000.0)] == [
        "not known yet", "none", "about 5 s", "about 45 s", "about 1 min", "about 2 min",
        "about 13 min", "about 1.7 h",
    ]  # fmt: skip
