from __future__ import annotations

import errno
import os
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from models import atomic_file
from models.atomic_file import sweep_scratch, write_bytes, write_text
from models.errors import StorageError

LIMIT_BYTES = 4096


@contextmanager
def files_no_larger_than(limit_bytes: int) -> Iterator[None]:
    """Have the kernel refuse to let any file grow further, as a full disk does."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_what_is_written_is_there_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "new" / "folders" / "file.bin"
    write_bytes(path, b"\x00\x01")
    assert path.read_bytes() == b"\x00\x01"
    write_bytes(path, b"\x02")
    assert path.read_bytes() == b"\x02"
    assert [entry.name for entry in path.parent.iterdir()] == ["file.bin"]


def test_text_is_utf_8_and_its_line_ends_are_kept(tmp_path: Path) -> None:
    write_text(tmp_path / "a.txt", "S1 \u2192 90\u00b0\r\n")
    assert (tmp_path / "a.txt").read_bytes() == b"S1 \xe2\x86\x92 90\xc2\xb0\r\n"


def test_a_disk_that_fills_up_leaves_the_old_file_whole(tmp_path: Path) -> None:
    path = tmp_path / "frame.png"
    write_bytes(path, b"old")
    with (
        files_no_larger_than(LIMIT_BYTES),
        pytest.raises(StorageError, match=r"frame\.png \(8192 bytes\).*File too large.*free some"),
    ):
        write_bytes(path, b"n" * 2 * LIMIT_BYTES)
    assert path.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["frame.png"]


def test_a_disk_that_fills_up_at_the_flush_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Network and quota file systems say so only at fsync."""

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StorageError, match="No space left on device"):
        write_bytes(tmp_path / "a", b"1234")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("folder", ["/proc", "/proc/new"])
def test_a_folder_that_cannot_be_written_is_named(folder: str) -> None:
    """/proc takes no files, not even root's."""
    with pytest.raises(
        StorageError, match=f"expected to write {folder}/a .*a folder you can write"
    ):
        write_bytes(Path(folder) / "a", b"1")


def test_a_folder_in_the_way_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    with pytest.raises(StorageError, match="directory"):
        write_bytes(tmp_path / "a", b"1")
    assert [entry.name for entry in tmp_path.iterdir()] == ["a"]


def test_a_file_in_a_folders_place_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"file")
    with pytest.raises(StorageError, match="expected to write"):
        write_bytes(tmp_path / "a" / "b", b"1")
    assert (tmp_path / "a").read_bytes() == b"file"


def test_killed_before_the_rename_the_old_file_stands(tmp_path: Path) -> None:
    path = tmp_path / "a"
    write_bytes(path, b"old")
    program = (
        "import os, signal, sys; from pathlib import Path; from models.atomic_file import *\n"
        "os.fsync = lambda _: os.kill(os.getpid(), signal.SIGKILL)\n"
        "write_bytes(Path(sys.argv[1]), b'new')\n"
    )
    done = subprocess.run([sys.executable, "-c", program, str(path)], check=False)
    assert done.returncode == -9
    assert path.read_bytes() == b"old"


def test_a_file_in_hand_survives_a_clock_that_was_set_back(tmp_path, monkeypatch) -> None:
    with atomic_file.whole_or_absent(tmp_path / "a") as scratch:
        scratch.write_bytes(b"1")
        monkeypatch.setattr(atomic_file, "_BEGAN_S", time.time() + 3600.0)
        assert sweep_scratch(tmp_path) == 0
    assert (tmp_path / "a").read_bytes() == b"1"
    monkeypatch.setattr(atomic_file, "_BEGAN_S", time.time() + 3600.0)
    scratch.write_bytes(b"of an earlier process with our number")
    assert sweep_scratch(tmp_path) == 1


def test_only_what_was_left_of_one_file_is_swept_beside_it(tmp_path) -> None:
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    left = [tmp_path / f".{name}.{atomic_file.MACHINE}-{ended.pid}.part" for name in ("a[1]", "b")]
    alive = tmp_path / f".a[1].{atomic_file.MACHINE}-1.part"
    for path in (*left, alive):
        path.write_bytes(b"half")
    atomic_file.sweep_beside(tmp_path / "a[1]")
    assert sorted(tmp_path.iterdir()) == sorted([left[1], alive])
