"""Runs killed, interrupted, doubled and resumed: what is there is kept, and the end is the same.

Every comparison is with a run that nothing interrupted, in another folder with another store.
"""

import json
import shutil
import signal

import pytest

from bench.cli import main
from models.atomic_file import MACHINE
from tests.support.whole_runs import (
    EXPOSURES,
    TIME_LIMIT_S,
    contents,
    identities,
    rvbench,
    scratch_files,
    start,
)


@pytest.mark.slow
def test_a_run_killed_again_and_again_ends_as_if_never_killed(whole_run, tmp_path):
    out, store = tmp_path / "out", tmp_path / "store"
    frames = out / "frames"
    command = ["run", whole_run.scenario, "--out", out, "--store", store, "--seeds", 2]

    code, _ = rvbench(*command, struck=("SIGKILL", f"{store}/??/*.exr"))
    assert code == -signal.SIGKILL
    assert scratch_files(store)

    code, errors = rvbench(*command, struck=("SIGKILL", f"{frames}/000000_850.png"))
    assert code == -signal.SIGKILL
    assert f"0 of {EXPOSURES} exposures are there already" in errors
    assert scratch_files(frames)
    assert not scratch_files(store)
    finished = identities(frames, "[0-9]*.png")
    assert list(finished) == ["000000_800.png"]

    code, errors = rvbench(*command, struck=("SIGINT", f"{frames}/000001_800.png"))
    assert code == 130
    assert "Traceback" not in errors
    assert "every file written so far is whole and kept" in errors
    assert f"1 of {EXPOSURES} exposures are there already" in errors
    assert not scratch_files(out, store)
    assert list(identities(frames)) == ["000000_800.png", "000000_850.png"]

    killed = identities(frames, "[0-9]*.png")
    assert finished.items() <= killed.items()

    code, errors = rvbench(*command)
    assert code == 0, errors
    assert f"{len(killed)} of {EXPOSURES} exposures are there already" in errors
    assert killed.items() <= identities(frames).items()
    assert not scratch_files(out, store)
    assert contents(out) == contents(whole_run.out)
    assert contents(store) == contents(whole_run.store)


@pytest.mark.slow
def test_two_runs_at_once_on_one_store_do_no_harm(whole_run, tmp_path):
    store = tmp_path / "store"
    outs = [tmp_path / name for name in ("first", "second")]
    processes = [
        start("render", whole_run.scenario, "--out", out, "--store", store) for out in outs
    ]
    for process in processes:
        _, errors = process.communicate(timeout=TIME_LIMIT_S)
        assert process.returncode == 0, errors
    wanted = contents(whole_run.out)
    for out in outs:
        made = contents(out)
        assert len(list(out.glob("frames/*.png"))) == EXPOSURES
        assert made.items() <= wanted.items()
    assert contents(store) == contents(whole_run.store)
    assert not scratch_files(tmp_path)


@pytest.mark.slow
def test_light_that_has_left_the_store_comes_back_for_more_runs(whole_run, tmp_path):
    """Frames stay; only the light that is gone or damaged is rendered, and to the same bits."""
    out, store = tmp_path / "out", tmp_path / "store"
    shutil.copytree(whole_run.out, out, copy_function=shutil.copy2)
    shutil.copytree(whole_run.store, store, copy_function=shutil.copy2)
    lit = json.loads((out / "truth" / "light.json").read_text())["exposures"]
    shining = ("sun_S2", "lamps_800", "lamps_850")  # more runs miss no light of another Sun
    keys = sorted(names[name] for names in lit.values() for name in names if name in shining)
    entries = [store / key[:2] / f"{key}.exr" for key in keys]  # light, not pixel truth
    entries[0].unlink()
    entries[1].write_bytes(entries[1].read_bytes()[:500])
    before = identities(out / "frames")
    code, errors = rvbench("run", whole_run.scenario, "--out", out, "--store", store, "--seeds", 3)
    assert code == 0, errors
    assert identities(out / "frames") == before
    assert (out / "seeds" / "002" / "estimates" / "best.jsonl").is_file()
    assert contents(store) == contents(whole_run.store)


def test_frames_of_another_light_are_never_mixed_with_ours(whole_run, tmp_path, capsys):
    """As after a change of version or variant: the keys on record are not those of today."""
    out = tmp_path / "out"
    shutil.copytree(whole_run.out, out, copy_function=shutil.copy2)
    record = out / "truth" / "light.json"
    record.write_text(record.read_text().replace('"sun_S2": "', '"sun_S2": "0'))
    asked = ["render", str(whole_run.scenario), "--out", str(out), "--store", str(tmp_path / "s")]
    assert main(asked) == 0  # whole as it is: nothing is rendered, nothing is changed
    assert '"sun_S2": "0' in record.read_text()
    (out / "frames" / "000001_850.png").unlink()
    before = identities(out)
    capsys.readouterr()
    assert main(asked) == 2
    assert "3 are of another variant or version. They are kept" in capsys.readouterr().err
    assert identities(out) == before


def test_what_a_living_process_writes_is_left_alone(whole_run, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(whole_run.out, out, copy_function=shutil.copy2)
    mine = out / "frames" / f".000000_800.png.{MACHINE}-1.part"  # process 1 lives
    theirs = out / "frames" / ".000000_800.png.00000000-99999999.part"  # on another machine
    for path in (mine, theirs):
        path.write_bytes(b"half")
    asked = ["render", str(whole_run.scenario), "--out", str(out)]
    assert main([*asked, "--store", str(whole_run.store)]) == 0
    assert set(scratch_files(out)) == {mine, theirs}
