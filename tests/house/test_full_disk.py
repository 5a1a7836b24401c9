"""Disks that are full or read-only: one message, exit code 2, and what was written stays whole.

The disks are real ones, a few hundred kilobytes of memory each, where the system lets us mount
them: as root. Elsewhere these tests are skipped; ``tests/models/test_atomic_file.py`` and
``tests/renders/test_store.py`` hold the same with limits on a single file.
"""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from bench.cli import main
from tests.support.small_disks import mount
from tests.support.synthetic_dataset import write_dataset
from tests.support.whole_runs import contents, identities, scratch_files

ROOM_FOR_SOME_FRAMES = "230k"  # each exposure is about 100 kB at 128 x 128, truth and all
ROOM_FOR_ALL = "8m"


@pytest.fixture
def disk(tmp_path) -> Iterator[Path]:
    """Mount a small disk for the time of a test."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount("-t", "tmpfs", "-o", f"size={ROOM_FOR_ALL}", "tmpfs", folder)
    yield folder
    subprocess.run(["umount", "--lazy", folder], check=True)


def told_in_one_line(capsys) -> str:
    told = capsys.readouterr().err
    message = told[told.index("rvbench: ") :].strip()
    assert "Traceback" not in told
    assert "\n" not in message
    return message


def test_a_disk_that_fills_up_keeps_whole_frames_and_goes_on(whole_run, disk, capsys):
    mount("-o", f"remount,size={ROOM_FOR_SOME_FRAMES}", disk)
    out = disk / "out"
    asked = ["render", str(whole_run.scenario), "--out", str(out)]
    asked += ["--store", str(whole_run.store)]
    assert main(asked) == 2
    message = told_in_one_line(capsys)
    assert "No space left on device; free some space" in message
    assert "the same command goes on from there" in message
    assert not scratch_files(out)
    kept = identities(out / "frames")
    assert 0 < len(kept) < 4
    assert contents(out).items() <= contents(whole_run.out).items()

    mount("-o", f"remount,size={ROOM_FOR_ALL}", disk)
    assert main(asked) == 0
    assert f"{len(kept)} of 4 exposures are there already" in capsys.readouterr().err
    assert kept.items() <= identities(out / "frames").items()
    assert contents(out).items() <= contents(whole_run.out).items()
    assert len(identities(out / "frames")) == 4


@pytest.mark.parametrize("verb", ["estimate", "score", "report", "show"])
def test_what_was_said_before_stands_when_there_is_no_room_to_say_more(disk, capsys, verb):
    """Each verb once with room, then with none."""
    folder = write_dataset(disk / "data", frames=2, width_px=128).folder
    before_it = {"estimate": [], "score": ["estimate"]}.get(verb, ["estimate", "score"])
    typed = [verb, str(folder), *(["0"] if verb == "show" else [])]
    for earlier in before_it:
        assert main([earlier, str(folder)]) == 0
    assert main(typed) == 0
    fill(disk / "filler")
    before = contents(disk)
    capsys.readouterr()
    assert main(typed) == 2
    assert "No space left on device; free some space" in told_in_one_line(capsys)
    assert contents(disk) == before
    (disk / "filler").unlink()
    assert main(typed) == 0


def fill(path: Path) -> None:
    """Write to a file until the disk takes no more."""
    with path.open("wb", buffering=0) as file:
        for size in (65536, 4096, 1):
            while True:
                try:
                    file.write(bytes(size))
                except OSError:
                    break


def test_a_read_only_disk_is_told_before_anything_is_rendered(whole_run, disk, capsys):
    mount("-o", "remount,ro", disk)
    asked = ["render", str(whole_run.scenario)]
    assert main([*asked, "--out", str(disk / "out"), "--store", str(whole_run.store)]) == 2
    assert "Read-only file system" in told_in_one_line(capsys)


def test_a_read_only_store_is_told_before_anything_is_rendered(whole_run, disk, tmp_path, capsys):
    mount("-o", "remount,ro", disk)
    asked = ["render", str(whole_run.scenario), "--out", str(tmp_path / "out")]
    assert main([*asked, "--store", str(disk / "store")]) == 2
    message = told_in_one_line(capsys)
    assert "Read-only file system" in message
    assert f"{disk / 'store'}" in message


def test_a_finished_dataset_on_a_read_only_disk_can_still_be_shown(whole_run, disk, tmp_path):
    folder = disk / "data"
    shutil.copytree(whole_run.out, folder)
    mount("-o", "remount,ro", disk)
    assert main(["show", str(folder), "0", "--out", str(tmp_path / "frame.png")]) == 0
