"""Archives of arrays read back as written, or are refused: by no other exception."""

from __future__ import annotations

import io

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.errors import UnreadableError
from models.reading.npz_file import read_npz


def archive() -> bytes:
    stream = io.BytesIO()
    np.savez_compressed(stream, draw=np.arange(50.0), key=np.array("abc"))
    return stream.getvalue()


WHOLE = archive()


def test_what_was_written_is_read(tmp_path):
    path = tmp_path / "a.npz"
    path.write_bytes(WHOLE)
    read = read_npz(path)
    assert set(read) == {"draw", "key"}
    np.testing.assert_array_equal(read["draw"], np.arange(50.0))


@given(place=st.integers(0, len(WHOLE) - 1), bit=st.integers(0, 7))
@settings(max_examples=200, deadline=None)
def test_a_flipped_bit_is_refused_or_harmless(tmp_path_factory, place, bit):
    spoilt = bytearray(WHOLE)
    spoilt[place] ^= 1 << bit
    path = tmp_path_factory.getbasetemp() / "flipped.npz"
    path.write_bytes(spoilt)
    try:
        read = read_npz(path)
    except UnreadableError:
        return
    if "draw" in read:  # checked by its CRC
        np.testing.assert_array_equal(read["draw"], np.arange(50.0))


def test_a_flag_that_says_encrypted_is_refused(tmp_path):
    spoilt = bytearray(WHOLE)
    for head, flags in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        place = spoilt.find(head)
        while place >= 0:
            spoilt[place + flags] |= 1
            place = spoilt.find(head, place + 4)
    (tmp_path / "a.npz").write_bytes(spoilt)
    with pytest.raises(UnreadableError, match="no archive of arrays"):
        read_npz(tmp_path / "a.npz")
