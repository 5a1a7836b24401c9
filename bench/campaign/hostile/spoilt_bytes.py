"""Ways to spoil bytes, whatever they mean: as disks, transfers and other programs do."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.random import Generator

ByteSpoil: TypeAlias = Callable[[Generator, bytes], bytes]
WORDS = (
    b"\xff\xff\xff\xff", b"\x7f\xff\xff\xff", b"\xff\xff\xff\x7f", b"\x00\x00\x00\x80",
    b"\x00\x00\x00\x00", struct.pack("<f", np.nan), struct.pack("<f", np.inf),
    struct.pack("<f", -3e38), struct.pack(">f", np.nan),
)  # fmt: skip
HEAD_BYTES = 160  # headers say how much is to come


def flipped(random: Generator, data: bytes) -> bytes:
    """Flip one to eight bits."""
    spoilt = bytearray(data)
    for _ in range(int(random.integers(1, 9))):
        spoilt[_place(random, data)] ^= 1 << int(random.integers(8))
    return bytes(spoilt)


def cut(random: Generator, data: bytes) -> bytes:
    """Leave the beginning."""
    return data[: int(random.integers(len(data)))]


def beheaded(random: Generator, data: bytes) -> bytes:
    """Leave the end."""
    return data[int(random.integers(1, len(data) + 1)) :]


def worded(random: Generator, data: bytes) -> bytes:
    """Put a word that is the largest, the least or no number over four bytes."""
    place = _place(random, data)
    return data[:place] + WORDS[int(random.integers(len(WORDS)))] + data[place + 4 :]


def blanked(random: Generator, data: bytes) -> bytes:
    """Put zeros over a stretch, as a file that was not flushed has."""
    start, length = _stretch(random, data)
    return data[:start] + bytes(length) + data[start + length :]


def repeated(random: Generator, data: bytes) -> bytes:
    """Have a stretch twice."""
    start, length = _stretch(random, data)
    return data[: start + length] + data[start:]


def lost(random: Generator, data: bytes) -> bytes:
    """Take a stretch out."""
    start, length = _stretch(random, data)
    return data[:start] + data[start + length :]


def noisy(random: Generator, data: bytes) -> bytes:
    """Put noise over a stretch."""
    start, length = _stretch(random, data)
    return data[:start] + random.bytes(length) + data[start + length :]


def lengthened(random: Generator, data: bytes) -> bytes:
    """Add noise at the end."""
    return data + random.bytes(int(random.integers(1, 2000)))


BYTE_SPOILS: dict[str, ByteSpoil] = {
    each.__name__: each
    for each in (flipped, cut, beheaded, worded, blanked, repeated, lost, noisy, lengthened)
}


def _place(random: Generator, data: bytes) -> int:
    """Return a place; every other one in the header."""
    most = len(data) if random.random() < 0.5 else min(len(data), HEAD_BYTES)
    return int(random.integers(most))


def _stretch(random: Generator, data: bytes) -> tuple[int, int]:
    start = _place(random, data)
    return start, int(random.integers(1, min(len(data) - start, 512) + 1))
