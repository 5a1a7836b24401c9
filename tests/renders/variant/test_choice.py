"""Variants are chosen by what really renders, in processes that may die without taking ours."""

from __future__ import annotations

import glob
import json
import subprocess
import sys
from pathlib import Path

import pytest

from models.errors import VariantError
from renders.variant import choice as variant
from renders.variant import probe_cache
from tests.support.half_written import left_half_written
from tests.support.patience import HANGS_S

A_SECOND = 1.0  # of the hour that the sleeper sleeps
TWO_DAYS_S = 2 * probe_cache.A_DAY_S


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch) -> Path:
    """Give each test an empty cache, in memory and on disk."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("RVBENCH_CACHE", str(folder))
    monkeypatch.setattr(variant, "_answers", {})
    return folder


@pytest.fixture
def hide_llvm(monkeypatch) -> None:
    """Hide LLVM from the process and its children."""
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "/nonexistent")


@pytest.fixture
def pretend(tmp_path, monkeypatch):
    """Return a function that puts another program in the place of the probe."""

    def pretend(body: str) -> None:
        program = tmp_path / "pretended_probe.py"
        program.write_text(f"import os, signal, sys, time\n{body}\n")
        monkeypatch.setattr(variant, "PROBE_PROGRAM", program)

    return pretend


RENDERS = """print('{"samples_per_s": 1e6, "library": "", "furnace": 1.0}')"""
COUNTS = f"open(__file__ + '.runs', 'a').write('x'); {RENDERS}"


def runs_of_probe() -> int:
    """Return how often the counting probe ran."""
    return len(Path(f"{variant.PROBE_PROGRAM}.runs").read_text())


def run_python(program: str) -> subprocess.CompletedProcess[str]:
    """Run a program that imports the house in a process of its own."""
    house = Path(variant.__file__).parents[2]
    return subprocess.run(
        [sys.executable, "-c", program], cwd=house, capture_output=True, text=True, timeout=HANGS_S
    )


def test_importing_and_probing_load_no_mitsuba() -> None:
    done = run_python(
        "import sys; from renders.variant.choice import probe; probe('scalar');"
        "print('mitsuba' in sys.modules or 'drjit' in sys.modules)"
    )
    assert done.stdout.split() == ["False"], done.stderr


def test_scalar_renders_wherever_mitsuba_is_installed() -> None:
    result = variant.probe("scalar")
    assert result.renders, result.reason
    assert result.variant == "scalar_rgb"
    assert 0.0 < result.first_image_s < variant.TIME_LIMIT_S
    assert result.samples_per_s > 0.0


@pytest.mark.usefixtures("hide_llvm")
def test_hidden_llvm_is_refused_and_scalar_serves() -> None:
    refused = variant.probe("llvm")
    assert not refused.renders
    assert refused.reason == "no libLLVM found"
    assert variant.choose_variant("scalar") == "scalar_rgb"
    with pytest.raises(VariantError, match=r"DRJIT_LIBLLVM_PATH is '/nonexistent'.*unset it"):
        variant.choose_variant("llvm")


@pytest.mark.parametrize("library", glob.glob("/usr/lib/*-linux-gnu/libLLVM*.so.*"))
def test_every_libllvm_of_this_machine_gets_a_verdict(library, monkeypatch) -> None:
    """Whatever it does to the process it is loaded into, ours lives on to tell."""
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", library)
    result = variant.probe("llvm")
    if result.renders:
        assert Path(result.library).resolve() == Path(library).resolve()
    else:
        assert result.reason


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("os.kill(os.getpid(), signal.SIGABRT)", "Aborted"),
        ("os.kill(os.getpid(), signal.SIGSEGV)", "Segmentation fault"),
        ("sys.exit('LLVM ERROR: Cannot select: f32 = fminimum')", "cannot compile for this"),
        ("raise RuntimeError('no OptiX')", "RuntimeError: no OptiX"),
    ],
)
def test_a_probe_that_dies_is_a_refusal_with_its_reason(body, reason, pretend) -> None:
    pretend(body)
    result = variant.probe("llvm")
    assert not result.renders
    assert reason in result.reason


def test_auto_takes_the_fastest_that_renders(pretend, monkeypatch) -> None:
    monkeypatch.setattr(variant, "active_variant", lambda: None)
    for refused, chosen in [
        ([], "cuda_ad_rgb"),
        (["cuda_ad_rgb"], "llvm_ad_rgb"),
        (["cuda_ad_rgb", "llvm_ad_rgb"], "scalar_rgb"),
    ]:
        pretend(f"if sys.argv[1] in {refused!r}: sys.exit(1)\n{RENDERS}")
        assert variant.choose_variant("auto") == chosen


def test_nothing_that_renders_is_an_error_naming_each(pretend, monkeypatch) -> None:
    monkeypatch.setattr(variant, "active_variant", lambda: None)
    pretend("sys.exit('ModuleNotFoundError: No module named mitsuba')")
    with pytest.raises(VariantError, match=r"cuda_ad_rgb: .*llvm_ad_rgb: .*scalar_rgb: .*install"):
        variant.choose_variant()


def test_an_unknown_variant_is_told_the_known_ones() -> None:
    with pytest.raises(VariantError, match=r"auto, cuda, llvm, scalar.*got 'lvm'"):
        variant.choose_variant("lvm")


def test_a_probe_is_run_once_a_day_whatever_the_process(pretend, monkeypatch) -> None:
    pretend(COUNTS)
    first = variant.probe("scalar")
    assert variant.probe("scalar_rgb") == first
    monkeypatch.setattr(variant, "_answers", {})  # as another process would find it
    assert variant.probe("scalar") == first
    assert runs_of_probe() == 1
    variant.probe("scalar", fresh=True)
    assert runs_of_probe() == 2


def test_an_old_record_is_probed_again(pretend, cache, monkeypatch) -> None:
    pretend(COUNTS)
    variant.probe("scalar")
    (record,) = cache.glob("*.json")
    aged = json.loads(record.read_text())
    aged["probed_at"] -= TWO_DAYS_S
    record.write_text(json.dumps(aged))
    monkeypatch.setattr(variant, "_answers", {})
    variant.probe("scalar")
    assert runs_of_probe() == 2


@pytest.mark.parametrize(
    "damage",
    ["", "{", "[]", '{"probed_at": "x"}', '{"probed_at": 9e99, "result": {}}', "now-other-keys"],
)
def test_a_broken_record_is_no_record(damage, pretend, cache, monkeypatch) -> None:
    pretend(COUNTS)
    variant.probe("scalar")
    (record,) = cache.glob("*.json")
    if damage == "now-other-keys":
        kept = json.loads(record.read_text())
        damage = json.dumps(kept | {"result": {"variant": "scalar_rgb", "works": True}})
    record.write_text(damage)
    monkeypatch.setattr(variant, "_answers", {})
    assert variant.probe("scalar").renders
    assert runs_of_probe() == 2


def test_a_cache_that_cannot_be_written_is_done_without(pretend, tmp_path, monkeypatch) -> None:
    (tmp_path / "a_file").write_text("")
    monkeypatch.setenv("RVBENCH_CACHE", str(tmp_path / "a_file"))
    pretend(COUNTS)
    assert variant.probe("scalar").renders


def test_a_probe_too_slow_once_is_tried_again_by_the_next_process(pretend) -> None:
    pretend("time.sleep(3600)")
    result = variant.probe("scalar", time_limit_s=A_SECOND)
    assert result.reason == "no picture within 1 s"
    machine = probe_cache.fingerprint(variant.PROBE_PROGRAM)
    assert probe_cache.read("scalar_rgb", machine) is None


@pytest.mark.parametrize("name", probe_cache.VARIABLES)
def test_what_tells_drjit_where_to_look_is_in_the_key(name, monkeypatch) -> None:
    before = probe_cache.fingerprint(variant.PROBE_PROGRAM)
    monkeypatch.setenv(name, "/elsewhere")
    assert probe_cache.fingerprint(variant.PROBE_PROGRAM) != before


def test_a_new_libllvm_is_in_the_key(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(probe_cache, "LIBRARY_FOLDERS", (str(tmp_path),))
    before = probe_cache.fingerprint(variant.PROBE_PROGRAM)
    (tmp_path / "libLLVM.so.19.1").write_text("")
    assert probe_cache.fingerprint(variant.PROBE_PROGRAM) != before


def test_a_process_keeps_its_variant() -> None:
    done = run_python(
        "from renders.variant.choice import activate, active_variant, choose_variant\n"
        "assert active_variant() is None\n"
        "activate('scalar'); activate('scalar_rgb')\n"
        "assert active_variant() == choose_variant('auto') == 'scalar_rgb'\n"
        "activate('llvm')"
    )
    assert "VariantError: expected one variant in a process, got llvm_ad_rgb" in done.stderr


@pytest.mark.usefixtures("hide_llvm")
def test_activating_what_does_not_load_says_what_to_do() -> None:
    done = run_python("from renders.variant.choice import activate; activate('llvm')")
    assert "VariantError: expected llvm_ad_rgb to load, got: no libLLVM found" in done.stderr


def test_what_was_left_half_written_of_a_record_is_swept():
    half = left_half_written(probe_cache._record_path("llvm_ad_rgb", "here"))
    probe_cache.write("llvm_ad_rgb", "here", {"renders": True})
    assert not half.exists()
    assert probe_cache.read("llvm_ad_rgb", "here") == {"renders": True}
