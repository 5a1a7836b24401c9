"""A rate: what a second worker brings, and what does not depend on the machine."""

import os

import pytest

from bench.throughput.kept import keep, rates_before
from bench.throughput.rate import Rate
from bench.throughput.timing import CommandFailed, Spent, timed, yardstick_s
from models.errors import RvbenchError


def rate(one, two=(), target=0.9, yard_s=0.1, before=None, count=60):
    return Rate("a suite", "runs", count, list(one), list(two), target, yard_s, before)


def test_half_the_time_is_an_efficiency_of_one_and_no_gain_is_a_half():
    one = Spent(20.0, 19.0)
    assert rate([one], [Spent(10.0, 19.0)]).efficiency == 1.0
    assert rate([one], [Spent(20.0, 19.0)]).efficiency == 0.5


def test_what_two_spend_more_is_told_by_processor_time_however_busy_the_machine():
    """By the clock nothing was gained; the processors did not work more for it."""
    own = rate([Spent(20.0, 19.0)], [Spent(35.0, 20.0)])
    assert own.spared == pytest.approx(0.95)
    assert not own.reached


def test_the_middle_of_the_repetitions_counts():
    one = [Spent(20.0, 19.0)] * 3
    two = [Spent(10.0, 19.0), Spent(11.0, 19.0), Spent(40.0, 19.0)]
    assert rate(one, two).efficiency == pytest.approx(20.0 / 22.0)


def test_a_machine_of_half_the_speed_is_as_fast_as_before():
    fast = rate([Spent(20.0, 20.0)], yard_s=0.1)
    slow = rate([Spent(40.0, 40.0)], yard_s=0.2, before=fast.a_yardstick)
    assert slow.over_before == pytest.approx(1.0)
    assert fast.efficiency is None
    assert fast.reached


def test_rates_are_kept_by_name(tmp_path):
    path = tmp_path / "kept.json"
    assert rates_before(1.0, path) == {}
    own = rate([Spent(20.0, 20.0)])
    keep([own], 1.0, path)
    assert rates_before(2.0, path) == {}
    assert rates_before(1.0, path) == {"a suite": pytest.approx(own.a_yardstick, rel=1e-3)}
    path.write_text("[]")
    with pytest.raises(RvbenchError, match="expected rates as --keep writes them"):
        rates_before(1.0, path)


def test_a_yardstick_takes_time_of_the_processor():
    assert yardstick_s(rounds=1) > 0.0


def test_a_command_is_timed_and_one_that_fails_says_its_last_words(tmp_path):
    every = os.sched_getaffinity(0)
    spent = timed(["--version"], tmp_path / "log", cores=1)
    assert os.sched_getaffinity(0) == every
    assert spent.processor_s <= spent.clock_s + 0.1  # of one core; processors' clocks tick
    assert spent.processor_s > 0.0
    assert spent.clock_s > 0.0
    with pytest.raises(CommandFailed, match=r"got exit code 2:\n(.|\n)*nowhere"):
        timed(["report", str(tmp_path / "nowhere")], tmp_path / "log")
