"""Who is at work in a folder is seen while it lives; why one failed stays until the next begins."""

from __future__ import annotations

import subprocess
import sys

import pytest

from models.at_work import FAILED_NAME, at_work, is_at_work, last_failure
from models.errors import StorageError
from tests.support.patience import HANGS_S

HOLDS = """
import sys, pathlib
from models.at_work import at_work
with at_work(pathlib.Path(sys.argv[1]), "render"):
    print("held", flush=True)
    sys.stdin.readline()
"""


def test_work_is_seen_while_it_lasts(tmp_path):
    assert is_at_work(tmp_path) is False
    with at_work(tmp_path, "run"), at_work(tmp_path, "render"):
        assert is_at_work(tmp_path) is True
    assert is_at_work(tmp_path) is False
    assert not list(tmp_path.iterdir())


def test_a_killed_process_is_no_longer_at_work(tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDS, tmp_path], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert process.stdout.readline() == b"held\n"
    assert is_at_work(tmp_path) is True
    process.kill()
    process.communicate(timeout=HANGS_S)
    assert is_at_work(tmp_path) is False
    assert last_failure(tmp_path) is None


def test_a_failure_stays_until_the_next_begins(tmp_path):
    with pytest.raises(StorageError), at_work(tmp_path, "sweep"):
        raise StorageError("expected room, got none")
    assert last_failure(tmp_path) == {"what": "sweep", "why": "expected room, got none"}
    with at_work(tmp_path, "sweep"):
        assert last_failure(tmp_path) is None
    assert not list(tmp_path.iterdir())


def test_a_record_that_is_none_tells_of_no_failure(tmp_path):
    (tmp_path / FAILED_NAME).write_text('{"verb": "run"')
    assert last_failure(tmp_path) is None
    assert is_at_work(tmp_path / "not_there") is False
