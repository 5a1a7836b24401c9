"""Memory stays where it is while frames are made: what a frame needs is free before the next.

Shares within one run, so that neither the machine nor its load enters. What is compared are means
over the second and the last quarter of the frames: by then all that is built once is built.
"""

from pathlib import Path

import pytest
import tomli_w

from tests.support.resident_memory import growth, watched
from tests.support.tumble_scenario import tumble_table

FRAMES = 400
DRAWN = 1000  # of a dataset: its second process has built all it needs by the second quarter
MOST_GROWTH = 0.03  # of what a process has; 10 kB lost with each frame are 0.7 % of 300 MB,
# 100 kB, as of one plane of its image and its files' tables, 7 %
SPECIFICATION = """
name = "few"
frames = {frames}
[[target]]
spacecraft = "hispasat"
[[camera]]
name = "wide"
width = 64
[pose]
range_m = [40.0, 90.0]
[render]
samples = 1
max_depth = 2
"""


def pictures(folder: Path) -> int:
    return sum(1 for _ in folder.glob("**/frames/[0-9]*.png"))


@pytest.mark.slow
def test_one_process_renders_many_frames_in_the_memory_of_few(tmp_path):
    case, out = tmp_path / "turning.toml", tmp_path / "out"
    motion = {"end_s": (FRAMES - 1) / 10.0, "rate_hz": 10.0}
    render = {"samples": 1, "max_depth": 2}
    case.write_text(tomli_w.dumps(tumble_table(motion=motion, render=render)))
    typed = ("render", case, "--out", out, "--store", tmp_path / "store", "--threads", "1")
    looks = watched((*typed, "--keep-light", "none"), lambda: pictures(out))
    own = next(iter(looks[0].now_mb))
    amounts = [(look.done, look.now_mb[own]) for look in looks if own in look.now_mb]
    second_mb, last_mb = growth(amounts, FRAMES)
    assert last_mb < (1.0 + MOST_GROWTH) * second_mb


@pytest.mark.slow
def test_the_workers_of_a_dataset_keep_their_memory(tmp_path):
    spec, out = tmp_path / "spec.toml", tmp_path / "out"
    spec.write_text(SPECIFICATION.format(frames=DRAWN))
    looks = watched(("dataset", spec, "--workers", 2, "--out", out), lambda: pictures(out))
    crew = {process for look in looks for process in look.now_mb if look.done > DRAWN // 2}
    assert len(crew) >= 3  # who was asked, one more, and Python's own that watches what they share
    for process in crew:
        amounts = [(look.done, look.now_mb[process]) for look in looks if process in look.now_mb]
        second_mb, last_mb = growth(amounts, DRAWN)
        assert last_mb < (1.0 + MOST_GROWTH) * second_mb
