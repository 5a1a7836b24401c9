"""Exports killed in the midst, several times each, end with the bytes of one that never was."""

from __future__ import annotations

import random
import signal
import subprocess

import pytest

from tests.support.whole_runs import TIME_LIMIT_S, contents, rvbench, scratch_files, start

SPLIT = ["--split", "0.4", "0.3", "0.3"]
MOST_RANDOM_S = 1.5  # after the first image; the rest takes about as long
STRUCK = {  # as a file gets its name: of an image, of a record, of what tells of all, the last two
    "bop": ["*/gray/000001.png", "*/records/*000001_000001.json", "*/obj_000001.ply",
            "*/files.sha256", "*/out/export.json"],
    "webdataset": ["*/staged/*mask.json", "*/shard-000000.tar", "*/tables/labels.csv"],
    "huggingface": ["*/metadata.jsonl", "*/croissant.json"],
}  # fmt: skip


@pytest.mark.slow  # sixteen processes, each with its own start-up
@pytest.mark.parametrize("kind", list(STRUCK))
def test_an_export_killed_again_and_again_ends_as_if_never_killed(kind, exported, tumble, tmp_path):
    out = tmp_path / "out"
    command = ["export", tumble, "--as", kind, *SPLIT, "--out", out]
    for pattern in STRUCK[kind]:
        code, errors = rvbench(*command, struck=("SIGKILL", pattern))
        assert code == -signal.SIGKILL, errors
        assert scratch_files(out)
    process = start(*command)
    process.stderr.readline()
    try:
        process.wait(random.uniform(0.0, MOST_RANDOM_S))
    except subprocess.TimeoutExpired:
        process.kill()
    process.communicate(timeout=TIME_LIMIT_S)
    code, errors = rvbench(*command)
    assert code == 0, errors
    assert not scratch_files(out)
    assert contents(out) == contents(exported(kind))
