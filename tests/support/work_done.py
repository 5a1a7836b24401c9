"""What a refusal may cost, in what no busy machine changes: bytes read and bytes held."""

import tracemalloc
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

READ_BYTES = 128_000_000  # twice the most that any table may have
HELD_BYTES = 256_000_000  # the most that a mesh file may have; a table's text takes some of it
COUNTS = Path("/proc/self/io")


def bytes_read() -> int:
    """Return how many bytes this process has asked files for so far; 0 where none are counted."""
    if not COUNTS.exists():
        return 0
    counts = dict(line.split(": ") for line in COUNTS.read_text().splitlines())
    return int(counts["rchar"])


@contextmanager
def little_work(read: int = READ_BYTES, held: int = HELD_BYTES) -> Iterator[None]:
    """Hold what runs inside to a number of bytes read, and of bytes held at once."""
    before = bytes_read()
    tracemalloc.start()
    try:
        yield
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    asked = bytes_read() - before
    assert asked < read, f"{asked} bytes were read of what cannot be good"
    assert most < held, f"{most} bytes of memory were taken for what cannot be good"
