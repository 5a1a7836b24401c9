"""Disks that are unmounted while something writes: nothing is written beneath, and it goes on."""

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from bench.sweep.workers import Workers
from models.atomic_file import write_bytes
from models.errors import StorageError
from models.output_folder import check_place
from renders.store.radiance_store import RadianceStore
from tests.support.small_disks import mount, unmount


@pytest.fixture
def mounted(tmp_path) -> Iterator[tuple[Path, Path]]:
    """Mount a disk, at another place, too, for the time of a test."""
    kept, seen = tmp_path / "kept", tmp_path / "seen"
    kept.mkdir()
    seen.mkdir()
    mount("-t", "tmpfs", "-o", "size=1m", "tmpfs", kept)
    mount("--bind", kept, seen)
    yield kept, seen
    for place in (seen, kept):
        with suppress(OSError):
            while place.is_mount():
                unmount(place)


@pytest.mark.parametrize("name", ["a", "new/a", "out/a", "out/new/a"])
def test_nothing_is_written_beneath_the_place_of_a_mount(mounted, name):
    kept, seen = mounted
    write_bytes(seen / "first", b"1")
    write_bytes(seen / "out" / "first", b"1")
    unmount(seen)
    with pytest.raises(StorageError, match=r"no longer on the disk .* mount it again"):
        write_bytes(seen / name, b"2")
    assert not list(seen.iterdir())
    mount("--bind", kept, seen)
    write_bytes(seen / name, b"2")
    assert (kept / name).read_bytes() == b"2"
    assert (kept / "out" / "first").read_bytes() == b"1"


def test_a_verb_that_begins_may_find_another_disk(mounted):
    """As where a disk was mounted again, and the system has given it another number."""
    _, seen = mounted
    check_place(seen / "out")
    write_bytes(seen / "out" / "a", b"1")
    unmount(seen)
    check_place(seen / "out")
    write_bytes(seen / "out" / "a", b"2")
    assert (seen / "out" / "a").read_bytes() == b"2"


def test_a_store_that_is_opened_may_be_on_another_disk(mounted):
    _, seen = mounted
    RadianceStore(seen / "store").open_for_writing()
    unmount(seen)
    RadianceStore(seen / "store").open_for_writing()
    assert (seen / "store" / "CACHEDIR.TAG").is_file()


def writes(path: Path) -> None:
    write_bytes(path, b"2")


def test_workers_do_not_write_beneath_either(mounted):
    """They are begun after the disk is gone, and know of it from who began them."""
    _, seen = mounted
    write_bytes(seen / "out" / "first", b"1")
    unmount(seen)
    with Workers(2) as workers, pytest.raises(StorageError, match="no longer on the disk"):
        list(workers.run(writes, [(seen / "out" / name,) for name in "ab"]))
    assert not list(seen.iterdir())


def test_a_folder_that_was_deleted_is_made_again(tmp_path):
    write_bytes(tmp_path / "out" / "a", b"1")
    (tmp_path / "out" / "a").unlink()
    (tmp_path / "out").rmdir()
    write_bytes(tmp_path / "out" / "a", b"2")
    assert (tmp_path / "out" / "a").read_bytes() == b"2"
