from __future__ import annotations

import os
import socket

import pytest

from models.errors import UnreadableError, cause
from models.reading.regular_file import read_bytes, read_lines, read_text


def make_pipe(path):
    os.mkfifo(path)


def make_socket(path):
    with socket.socket(socket.AF_UNIX) as door:
        door.bind(str(path))


@pytest.mark.parametrize(
    ("make", "kind"),
    [(make_pipe, "a pipe"), (make_socket, "a socket"), (lambda path: path.mkdir(), "a folder")],
)
def test_only_a_file_is_read(tmp_path, monkeypatch, make, kind):
    """A pipe without a writer would keep ``open`` waiting for ever; none of these is opened."""
    monkeypatch.chdir(tmp_path)  # a socket's name may have 100 characters
    path = tmp_path / "it"
    make(path.relative_to(tmp_path)) if kind == "a socket" else make(path)
    with pytest.raises(UnreadableError, match=f"{path}: {kind}, where a file was expected"):
        read_bytes(path)


def test_a_device_is_refused():
    with pytest.raises(UnreadableError, match="a device"):
        read_bytes(os.devnull)


@pytest.mark.parametrize("name", ["absent", "nul\0inside", "n" * 300])
def test_a_file_that_cannot_be_opened_says_why(tmp_path, name):
    with pytest.raises(UnreadableError) as caught:
        read_bytes(tmp_path / name)
    assert str(tmp_path) not in cause(caught.value)


def test_a_link_to_a_file_is_one(tmp_path):
    (tmp_path / "file").write_bytes(b"light")
    (tmp_path / "link").symlink_to(tmp_path / "file")
    assert read_bytes(tmp_path / "link") == b"light"


def test_size_has_a_limit_and_it_is_told(tmp_path):
    path = tmp_path / "large"
    path.write_bytes(b"x" * 1001)
    assert len(read_bytes(path, 1001)) == 1001
    with pytest.raises(UnreadableError, match=r"more than 0\.001 MB"):
        read_bytes(path, 1000)


def test_a_byte_order_mark_is_no_part_of_the_text(tmp_path):
    path = tmp_path / "text"
    path.write_bytes(b"\xef\xbb\xbfname\r\nvalue\n")
    assert read_text(path) == "name\r\nvalue\n"
    assert read_lines(path) == ["name", "value"]


def test_what_is_no_utf_8_is_told_with_its_line(tmp_path):
    path = tmp_path / "text"
    path.write_bytes("eins\nzwölf".encode("latin-1"))
    with pytest.raises(UnreadableError, match=f"{path}:2: byte 0xf6 is no UTF-8"):
        read_text(path)


def test_a_line_has_a_limit(tmp_path):
    path = tmp_path / "text"
    path.write_text("short\n" + 101 * "x" + "\n")
    with pytest.raises(UnreadableError, match=f"{path}:2: more than 100 characters"):
        read_lines(path, most_line_bytes=100)
