"""A pipe, or bytes that are no text, among files of ours: no reader waits, none raises another way.

Whoever opens a pipe that nobody writes to waits for ever, so a test that fails here hangs.
"""

from __future__ import annotations

import os
from types import SimpleNamespace

import pytest

from bench.export.plan import Shot
from bench.export.records import Records
from bench.suites.folder import begin
from bench.sweep.table import read_csv
from models.errors import DatasetError
from models.reading.regular_file import holds_text
from renders.batches.dataset_writer import is_whole_png, is_whole_record
from renders.store.claims import live_claims
from renders.store.sealed_exr import read_exr

NO_TEXT = b"\xff\xfe{}\n"


def test_light_that_is_a_pipe_is_absent(tmp_path):
    os.mkfifo(tmp_path / "a.exr")
    assert read_exr(tmp_path / "a.exr") is None


def test_light_that_never_ends_is_absent(tmp_path):
    (tmp_path / "a.exr").symlink_to("/dev/zero")
    assert read_exr(tmp_path / "a.exr") is None


def test_a_claim_that_is_a_pipe_is_nobodys(tmp_path):
    (tmp_path / "claims").mkdir()
    os.mkfifo(tmp_path / "claims" / "a.json")
    assert live_claims(tmp_path) == []


def test_an_exposure_that_is_a_pipe_is_not_there(tmp_path):
    os.mkfifo(tmp_path / "a.png")
    assert not is_whole_png(tmp_path / "a.png")


@pytest.mark.parametrize(
    ("data", "whole"),
    [(b'{"a": 1}\n', True), (b'{"a": 1\n', False), (NO_TEXT, False), (b'{"a":\n1}\n', False)],
)
def test_truth_that_is_no_record_is_not_there(tmp_path, data, whole):
    (tmp_path / "a.json").write_bytes(data)
    assert is_whole_record(tmp_path / "a.json") is whole


def test_a_suite_is_not_begun_where_a_pipe_names_it(tmp_path):
    (tmp_path / "units").mkdir()
    os.mkfifo(tmp_path / "units" / "made_by.json")
    with pytest.raises(DatasetError, match="to be empty or to hold"):
        begin(tmp_path, "small")


@pytest.mark.parametrize("is_pipe", [True, False])
def test_a_label_record_that_cannot_be_read_is_made_again(tmp_path, is_pipe):
    shot = Shot(scene=1, frame=0, stream="image", split="train", key="000001_000000")
    records = Records(SimpleNamespace(shots=(shot,)), tmp_path)
    path = records.path(shot)
    path.parent.mkdir(parents=True)
    if is_pipe:
        os.mkfifo(path)
    else:
        path.write_bytes(NO_TEXT)
    assert records.get(shot) is None
    with pytest.raises(DatasetError, match="expected the label record"):
        list(records.of())


def test_text_is_held_to_the_byte(tmp_path):
    (tmp_path / "a").write_bytes(NO_TEXT)
    os.mkfifo(tmp_path / "b")
    assert not holds_text(tmp_path / "a", "{}\n")
    assert not holds_text(tmp_path / "b", "{}\n")
    (tmp_path / "a").write_text("{}\n")
    assert holds_text(tmp_path / "a", "{}\n")
    assert not holds_text(tmp_path / "a", "{}")


def test_a_table_of_no_bytes_is_refused(tmp_path):
    (tmp_path / "sweep.csv").write_bytes(b"")
    with pytest.raises(DatasetError, match="expected the table of a sweep"):
        read_csv(tmp_path / "sweep.csv")
