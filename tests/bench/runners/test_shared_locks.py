"""What a mount tells of its locks, from lines as Linux lists them."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.runners.shared_locks import check_locks, mount_of
from models.errors import StorageError

ROOT = "/dev/vda / ext4 rw,relatime 0 0\n"
NFS = "server:/vol /shared{} nfs rw,relatime,vers=3,hard,{},addr=10.0.0.1 0 0\n"


def listed(folder: Path, text: str) -> Path:
    (folder / "mounts").write_text(text)
    return folder / "mounts"


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (NFS.format("", "nolock,local_lock=all"), "nfs with the option nolock"),
        (NFS.format("", "local_lock=flock"), "nfs with the option local_lock=flock"),
        ("a@tcp:/b /shared lustre rw,localflock 0 0\n", "lustre with the option localflock"),
        ("a@tcp:/b /shared lustre rw,relatime 0 0\n", "lustre with no locks between machines"),
        ("host /shared 9p rw 0 0\n", "9p with no locks between machines"),
    ],
)
def test_a_store_whose_locks_stay_on_a_machine_is_refused(
    tmp_path: Path, line: str, words: str
) -> None:
    with pytest.raises(StorageError, match=words):
        check_locks(Path("/shared/store"), listed(tmp_path, ROOT + line))


@pytest.mark.parametrize(
    "line",
    [
        NFS.format("", "local_lock=none"),
        "server:/vol /shared nfs4 rw,vers=4.2,hard,local_lock=none 0 0\n",
        "a@tcp:/b /shared lustre rw,flock 0 0\n",
        NFS.format("/elsewhere", "nolock"),
        "",
    ],
)
def test_a_store_whose_locks_hold_is_taken(tmp_path: Path, line: str) -> None:
    check_locks(Path("/shared/store"), listed(tmp_path, ROOT + line))


def test_the_innermost_mount_counts(tmp_path: Path) -> None:
    mounts = listed(tmp_path, ROOT + "a /shared nfs nolock 0 0\nb /shared/my\\040own ext4 rw 0 0\n")
    assert mount_of(Path("/shared/my own/store"), mounts) == ("/shared/my own", "ext4", ("rw",))
    assert mount_of(Path("/sharedish"), mounts) == ("/", "ext4", ("rw", "relatime"))


def test_where_no_mounts_are_listed_nothing_is_refused(tmp_path: Path) -> None:
    check_locks(Path("/shared/store"), tmp_path / "none")
