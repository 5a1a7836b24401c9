"""The doctor names what is there, what renders, and what to do about the rest."""

from __future__ import annotations

import io
import os
from importlib import metadata

import pytest
from rich.console import Console

from bench import doctor
from renders.variant.choice import ProbeResult

RENDERS = ProbeResult("scalar_rgb", True, first_image_s=0.5, samples_per_s=2.5e6)
NO_LLVM = ProbeResult("llvm_ad_rgb", False, reason="no libLLVM found")
NO_CUDA = ProbeResult("cuda_ad_rgb", False, reason="no CUDA driver or GPU found")
NO_SCALAR = ProbeResult("scalar_rgb", False, reason="ImportError: mitsuba")


def visit() -> tuple[int, str]:
    """Return the doctor's exit code and its words, wide enough that none is folded."""
    console = Console(file=io.StringIO(), width=300)
    code = doctor.doctor(console)
    return code, console.file.getvalue()


def answer(monkeypatch, *results: ProbeResult) -> None:
    """Let every probe answer at once, with these."""
    by_variant = {result.variant: result for result in results}
    names = {"cuda": "cuda_ad_rgb", "llvm": "llvm_ad_rgb", "scalar": "scalar_rgb"}
    monkeypatch.setattr(doctor, "probe", lambda name, fresh: by_variant[names[name]])


def test_on_this_machine_with_llvm_hidden(monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "/nonexistent")
    monkeypatch.setenv("RVBENCH_CACHE", str(tmp_path))
    code, words = visit()
    assert code == 0
    assert metadata.version("mitsuba") in words
    assert metadata.version("drjit") in words
    assert str(tmp_path) in words
    assert "to do: llvm_ad_rgb does not render (no libLLVM found): DRJIT_LIBLLVM_PATH" in words


def test_nothing_that_renders_is_exit_code_two(monkeypatch) -> None:
    answer(monkeypatch, NO_CUDA, NO_LLVM, NO_SCALAR)
    code, words = visit()
    assert code == 2
    assert "to do: scalar_rgb does not render" in words


def test_a_machine_without_a_gpu_is_not_told_to_buy_one(monkeypatch) -> None:
    results = [NO_CUDA, NO_LLVM, RENDERS]
    assert not any("cuda" in line for line in doctor.advice(results, gpus=[]))
    told = doctor.advice(results, gpus=["NVIDIA H200, 550.54, 143771 MiB"])
    assert any("driver 535" in line for line in told)


def test_missing_llvm_is_told_how_to_get_it(monkeypatch) -> None:
    monkeypatch.delenv("DRJIT_LIBLLVM_PATH", raising=False)
    (line,) = [line for line in doctor.advice([NO_LLVM], gpus=[]) if "llvm_ad_rgb" in line]
    assert "libLLVM 19 or newer" in line


def test_times_and_library_of_what_renders(monkeypatch) -> None:
    llvm = ProbeResult("llvm_ad_rgb", True, 0.7, 9.9e6, library="/opt/libLLVM.so.20.1")
    answer(monkeypatch, NO_CUDA, llvm, RENDERS)
    _, words = visit()
    (row,) = [line for line in words.splitlines() if "/opt/libLLVM.so.20.1" in line]
    assert row.split() == ["llvm_ad_rgb", "yes", "0.7", "s", "9.9", "/opt/libLLVM.so.20.1"]


def test_a_cache_folder_not_there_yet_is_measured_at_its_parent(monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("RVBENCH_CACHE", str(tmp_path / "not" / "yet"))
    (room,) = [value for name, value in doctor.disks() if name == "caches"]
    assert room.endswith("GB free")


@pytest.mark.parametrize(
    ("name", "variable"), [("caches", "RVBENCH_CACHE"), ("light", "RVBENCH_STORE")]
)
def test_a_full_disk_is_told_with_the_way_to_another(name, variable, monkeypatch, tmp_path) -> None:
    monkeypatch.setenv(variable, str(tmp_path))
    monkeypatch.setattr(doctor, "SCARCE_DISK_BYTES", float("inf"))
    (line,) = [line for line in doctor.advice([RENDERS], gpus=[]) if line.startswith(f"{name}:")]
    assert str(tmp_path) in line
    assert variable in line


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="the system keeps no affinity")
def test_cores_are_those_this_process_may_use() -> None:
    allowed = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(allowed)})
        assert doctor.usable_cores() == 1
    finally:
        os.sched_setaffinity(0, allowed)
