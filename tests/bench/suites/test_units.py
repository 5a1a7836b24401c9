"""A unit's outcome is found again if everything that shaped it is as it was, and never else."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from bench.suites.units import (
    Outcome,
    WorkUnit,
    done_outcome,
    is_done,
    outcome_path,
    read_outcome,
    seconds_path,
    write_outcome,
)
from models.errors import DatasetError
from tests.support.suite_work import DrawTask, draw_units, drawn

UNIT = draw_units(1)[0]


@pytest.fixture
def done(tmp_path):
    write_outcome(tmp_path, UNIT, UNIT.work(UNIT.task))
    return tmp_path


def test_what_was_written_is_read_bit_by_bit(done):
    found = done_outcome(done, UNIT)
    np.testing.assert_array_equal(found.values["draw"], drawn(UNIT.task).values["draw"])
    assert list(found.values) == ["draw"]


def test_the_same_outcome_gives_the_same_bytes_whenever_it_was_made(done, tmp_path):
    again = tmp_path / "again"
    write_outcome(again, UNIT, Outcome(UNIT.work(UNIT.task).values, np.array([1e3])))
    assert outcome_path(done, UNIT).read_bytes() == outcome_path(again, UNIT).read_bytes()
    assert seconds_path(done, UNIT).read_bytes() != seconds_path(again, UNIT).read_bytes()


def test_another_task_is_not_done(done):
    assert not is_done(done, replace(UNIT, task=DrawTask(seed=5)))
    assert not is_done(done, replace(UNIT, modules=("models.pose",)))
    assert is_done(done, replace(UNIT, kind="another", expected_s=9.0))


@pytest.mark.parametrize("keep", [0, 10, 200])
def test_a_truncated_file_is_not_done(done, keep):
    path = outcome_path(done, UNIT)
    path.write_bytes(path.read_bytes()[:keep])
    assert read_outcome(done, UNIT) is None


def test_every_flipped_byte_is_refused_or_harmless(done):
    path = outcome_path(done, UNIT)
    whole = path.read_bytes()
    truth = drawn(UNIT.task).values["draw"]
    for place in range(0, len(whole), 37):
        hurt = bytearray(whole)
        hurt[place] ^= 0xFF
        path.write_bytes(hurt)
        found = read_outcome(done, UNIT)
        assert found is None or np.array_equal(found.values["draw"], truth)


def test_without_its_times_it_is_not_done(done):
    seconds_path(done, UNIT).unlink()
    assert not is_done(done, UNIT)


def test_what_is_not_done_says_what_to_do(tmp_path):
    with pytest.raises(DatasetError, match="run the same suite again"):
        done_outcome(tmp_path, UNIT)


@dataclass(frozen=True)
class ArrayTask:
    points: object


def test_a_task_that_text_cannot_tell_has_no_key():
    unit = WorkUnit("a", drawn, ArrayTask(np.zeros(3)), "kind", 1.0)
    with pytest.raises(TypeError):
        assert unit.key
