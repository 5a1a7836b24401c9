"""Units spread over processes: the same files whoever did them, and after whatever stop."""

import io
import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from rich.console import Console

from bench.suites.spread import Pace, do_units, one_of_each_kind_first
from bench.suites.units import is_done, outcome_path
from tests.support.patience import HANGS_S
from tests.support.suite_work import draw_units

HOUSE = Path(__file__).resolve().parents[3]
QUIET = Console(file=io.StringIO())


def files(folder: Path, count: int) -> list[bytes]:
    return [outcome_path(folder, unit).read_bytes() for unit in draw_units(count)]


def test_one_worker_and_two_write_the_same_bytes(tmp_path):
    for workers in (1, 2):
        assert do_units(draw_units(6), tmp_path / str(workers), workers, QUIET) == 6
    assert files(tmp_path / "1", 6) == files(tmp_path / "2", 6)


def test_what_is_done_is_not_done_again(tmp_path):
    do_units(draw_units(3), tmp_path, 1, QUIET)
    assert do_units(draw_units(5), tmp_path, 1, QUIET) == 2
    assert do_units(draw_units(5), tmp_path, 1, QUIET) == 0


def test_the_order_of_units_changes_nothing(tmp_path):
    do_units(draw_units(4), tmp_path / "a", 1, QUIET)
    do_units(draw_units(4)[::-1], tmp_path / "b", 1, QUIET)
    assert files(tmp_path / "a", 4) == files(tmp_path / "b", 4)


def test_a_killed_suite_goes_on_from_whole_files(tmp_path):
    program = (
        "from pathlib import Path; from bench.suites.spread import do_units; "
        "from tests.support.suite_work import draw_units; "
        f"do_units(draw_units(12, 0.3), Path({str(tmp_path)!r}), 1)"
    )
    environment = {**os.environ, "PYTHONPATH": str(HOUSE)}
    running = subprocess.Popen(
        [sys.executable, "-P", "-c", program], env=environment, cwd=tmp_path,
        stderr=subprocess.DEVNULL, start_new_session=True,
    )  # fmt: skip
    give_up_s = time.monotonic() + HANGS_S
    while len(list(tmp_path.rglob("*.npz"))) < 2 and time.monotonic() < give_up_s:
        time.sleep(0.02)
    os.killpg(running.pid, signal.SIGKILL)
    running.wait()
    units = draw_units(12, 0.3)
    there = [unit for unit in units if outcome_path(tmp_path, unit).exists()]
    assert 2 <= len(there) < 12
    written = {unit.name: outcome_path(tmp_path, unit).read_bytes() for unit in there}
    assert do_units(units, tmp_path, 2, QUIET) == 12 - len(there)
    do_units(units, tmp_path / "straight", 1, QUIET)
    for unit in units:
        straight = outcome_path(tmp_path / "straight", unit).read_bytes()
        assert outcome_path(tmp_path, unit).read_bytes() == straight
        assert written.get(unit.name, straight) == straight


def test_a_unit_keeps_the_key_of_the_code_that_it_was_planned_with(tmp_path, monkeypatch):
    """Who edits the code while a suite runs must not make its outcomes stale at its end."""
    units = draw_units(2)
    keys = [unit.key for unit in draw_units(2)]
    for unit in units:
        assert not is_done(tmp_path, unit)
    monkeypatch.setattr("bench.suites.units.code_fingerprint", lambda *_: "edited meanwhile")
    handed_over = pickle.loads(pickle.dumps(units))
    assert [unit.key for unit in handed_over] == keys
    assert draw_units(1)[0].key != keys[0]


def test_one_of_each_kind_comes_first():
    units = draw_units(7)
    ordered = one_of_each_kind_first(units)
    assert {unit.kind for unit in ordered[:2]} == {"even", "odd"}
    assert sorted(unit.name for unit in ordered) == sorted(unit.name for unit in units)


def test_time_left_follows_what_was_timed_and_is_shared_by_workers():
    pace = Pace(workers=2)
    units = draw_units(5)  # three even, two odd, a second each as expected
    for unit in units:
        pace.add(unit)
    assert pace.cpu_left_s == pytest.approx(5.0)
    pace.done(units[0], 3.0)
    assert pace.cpu_left_s == pytest.approx(2 * 3.0 + 2 * 3.0)  # odd ones as slow till timed
    pace.done(units[1], 0.5)
    assert pace.cpu_left_s == pytest.approx(2 * 3.0 + 1 * 0.5)
    assert pace.left_s == pytest.approx(0.5 * pace.cpu_left_s)


def test_progress_goes_where_it_is_sent(tmp_path):
    said = io.StringIO()
    do_units(draw_units(2), tmp_path, 1, Console(file=said, width=200))
    assert "0 of 2 units are done already; 1 worker" in said.getvalue()
    assert "units: 2 of 2; left: none" in said.getvalue()
