"""Jobs: the clock's readings, both sides' channel names, and a process that fails."""

from __future__ import annotations

import json
import sys

import numpy as np
import OpenEXR
import pytest

from bench.cycles import jobs
from bench.cycles.jobs import CYCLES, OURS, Job, SideFailed, Task, effort, read_radiance, run


def test_light_is_told_apart_from_start_up_and_writing():
    clock = [
        ("imported", 101.0, 0.5),
        ("ready", 103.5, 3.0),
        ("rendered", 107.5, 10.0),
        ("written", 108.0, 10.5),
        ("rendered", 110.0, 14.0),
        ("written", 110.25, 14.25),
    ]
    taken = effort(clock, started=100.0, whole_s=11.0, processor_s=18.0, peak_mib=300.0)
    assert (taken.import_s, taken.scene_s) == (1.0, 2.5)
    assert taken.rendered_s == (4.0, 2.0)
    assert taken.rendered_processor_s == (7.0, 3.5)
    assert taken.whole_s == 11.0


def image(value):
    return np.full((4, 6), value, dtype=np.float32)


def write(path, parts):
    header = {"compression": OpenEXR.NO_COMPRESSION, "type": OpenEXR.scanlineimage}
    made = [OpenEXR.Part({**header, "name": name}, channels) for name, channels in parts.items()]
    with OpenEXR.File(made) as file:
        file.write(str(path))


def test_channels_are_found_by_either_sides_names(tmp_path):
    write(tmp_path / "ours.exr", {"": {"S2": image(1.0), "S5": image(2.0)}})
    write(tmp_path / "one.exr", {"": {"R": image(3.0), "G": image(9.0), "B": image(9.0)}})
    write(
        tmp_path / "groups.exr",
        {
            "ViewLayer.Combined": {"ViewLayer.Combined.R": image(9.0)},
            "ViewLayer.Combined_S2": {"ViewLayer.Combined_S2.R": image(4.0)},
            "ViewLayer.Combined_S5": {"ViewLayer.Combined_S5.R": image(5.0)},
        },
    )
    ours = read_radiance(tmp_path / "ours.exr", ("S2", "S5"))
    groups = read_radiance(tmp_path / "groups.exr", ("S2", "S5"))
    one = read_radiance(tmp_path / "one.exr", ("S2",))
    found = [ours["S2"], ours["S5"], groups["S2"], groups["S5"], one["S2"]]
    for value, radiance in zip((1.0, 2.0, 4.0, 5.0, 3.0), found, strict=True):
        np.testing.assert_array_equal(radiance, image(value))


def test_a_missing_channel_is_named(tmp_path):
    write(tmp_path / "ours.exr", {"": {"S2": image(1.0), "S5": image(2.0)}})
    with pytest.raises(KeyError, match="S7"):
        read_radiance(tmp_path / "ours.exr", ("S2", "S7"))


def test_both_sides_are_told_the_same(tmp_path):
    task = Task(("S2",), 16, 7, tmp_path / "out.exr")
    ours = Job(OURS, tmp_path, (task,)).table()
    theirs = Job(CYCLES, tmp_path, (task,)).table()
    assert ours == theirs
    assert json.loads(json.dumps(ours))["renders"][0]["out"] == str(tmp_path / "out.exr")


def test_a_process_is_timed_and_weighed(tmp_path, monkeypatch):
    program = (
        "import json, pathlib, sys, time\n"
        "hold = bytearray(64 << 20)\n"
        "start = time.time(); time.sleep(0.2)\n"
        "ready = [['imported', start, 0.0], ['ready', start, 0.0]]\n"
        "clock = [*ready, ['rendered', time.time(), time.process_time()]]\n"
        "pathlib.Path(sys.argv[1]).with_suffix('.clock.json').write_text(json.dumps(clock))\n"
    )
    monkeypatch.setattr(jobs, "command", lambda side: [sys.executable, "-S", "-c", program])
    taken = run(Job(OURS, tmp_path, ()), tmp_path / "jobs")
    assert 0.2 <= taken.rendered_s[0] < taken.whole_s
    assert taken.peak_mib > 64.0


def test_a_process_that_fails_says_its_last_words(tmp_path, monkeypatch):
    program = "import sys; sys.exit('no such light')"
    monkeypatch.setattr(jobs, "command", lambda side: [sys.executable, "-S", "-c", program])
    with pytest.raises(SideFailed, match="exit code 1:\nno such light"):
        run(Job(OURS, tmp_path, ()), tmp_path / "jobs")


def test_without_its_environment_cycles_says_what_to_do(tmp_path, monkeypatch):
    monkeypatch.setattr(jobs, "ORACLE_PYTHON", tmp_path / "no" / "bin" / "python")
    with pytest.raises(SideFailed, match="make oracle"):
        run(Job(CYCLES, tmp_path, ()), tmp_path / "jobs")
