"""What is timed runs, and does as many things as it is said to do."""

from pathlib import Path

import pytest

from bench.throughput.timing import timed
from bench.throughput.work import Work, works

WORKS = {work.name: work for work in works(0.05)}
FILES = {
    "runs": "suite/units/tracking/*/*/*/*.seconds.json",
    "frames": "**/frames/*.png",
    "Suns": "sweep/shots/*",
    "images": "bop/*/*/gray_image_*/*.png",
}


def left(work: Work, place: Path) -> int:
    """Return how many things a command has left in its folder."""
    files = len(list(place.glob(FILES[work.things])))
    return files // 2 if work.things == "Suns" else files  # each Sun's shot is a pair


def test_more_is_done_in_a_larger_size_and_never_less_than_two():
    small, large = works(0.05), works(2.0)
    assert all(a.count <= b.count for a, b in zip(small, large, strict=True))
    assert min(work.count for work in small) >= 2


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_command_does_what_is_counted(name, tmp_path):
    work = WORKS[name]
    for arguments in work.prepare(tmp_path):
        timed(arguments, tmp_path / "prepare.log")
    (place := tmp_path / "own").mkdir()
    timed(work.arguments(place, 1), place / "command.log")
    if work.things != "pairs":
        assert left(work, place) == work.count
    else:
        lines = (tmp_path / "pairs/estimates/best.jsonl").read_text().splitlines()
        assert sum('"frame"' in line for line in lines) == work.count
