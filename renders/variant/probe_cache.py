"""Yesterday's probe of a variant, so that not every command pays for one.

A record holds for a day, and only as long as everything that could change its answer stands as
it was: the probing program, the versions of Mitsuba and Dr.Jit, the libLLVM files found, the
driver of the GPU, the variables by which Dr.Jit is told where to look, and the processor. A
record that cannot be read is no record.
"""

from __future__ import annotations

import glob
import hashlib
import json
import os
import platform
import time
from importlib import metadata
from pathlib import Path
from typing import Any

from models.atomic_file import sweep_beside, write_text
from models.errors import StorageError, UnreadableError
from models.reading.json_file import read_json_table

A_DAY_S = 86_400.0
VARIABLES = (
    "DRJIT_LIBLLVM_PATH",
    "DRJIT_LIBCUDA_PATH",
    "DRJIT_LIBOPTIX_PATH",
    "CUDA_VISIBLE_DEVICES",
    "LD_LIBRARY_PATH",
)
LIBRARY_FOLDERS = ("/usr/lib/*-linux-gnu", "/usr/lib/wsl/lib", "/usr/lib64", "/usr/lib")


def cache_folder() -> Path:
    """Return the folder for what can be made again: ``RVBENCH_CACHE``, or the user's cache."""
    chosen = os.environ.get("RVBENCH_CACHE")
    if chosen:
        return Path(chosen)
    caches = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return Path(caches) / "rvbench"


def fingerprint(program: Path) -> str:
    """Return a hash of all that decides what the probing program will find here."""
    facts = {
        "program": _text(str(program)),
        "versions": [_version("mitsuba"), _version("drjit")],
        "variables": [os.environ.get(name) for name in VARIABLES],
        "libraries": [_identity(path) for path in libllvm_files()],
        "gpu_driver": _text("/proc/driver/nvidia/version"),
        "processor": [platform.machine(), platform.processor(), _processor()],
    }
    return hashlib.sha256(json.dumps(facts).encode()).hexdigest()[:16]


def libllvm_files() -> list[str]:
    """Return the libLLVM files in the system's library folders, sorted by name."""
    patterns = [f"{folder}/libLLVM*.so*" for folder in LIBRARY_FOLDERS]
    return sorted(path for pattern in patterns for path in glob.glob(pattern))


def read(variant: str, machine: str) -> dict[str, Any] | None:
    """Return the record of a probe made within the last day on this machine, or None."""
    try:
        record = read_json_table(_record_path(variant, machine))
        age_s = time.time() - float(record["probed_at"])
        result = record["result"]
    except (UnreadableError, ValueError, KeyError, TypeError):
        return None
    return result if 0.0 <= age_s < A_DAY_S and isinstance(result, dict) else None


def write(variant: str, machine: str, result: dict[str, Any]) -> None:
    """Keep the result of a probe; a folder that cannot be written keeps none.

    Parameters
    ----------
    variant : str
    machine : str
        Its fingerprint, part of the record's name.
    result : dict
        What the probe said; plain enough for JSON.
    """
    record = {"probed_at": time.time(), "result": result}
    place = _record_path(variant, machine)
    sweep_beside(place)
    try:
        write_text(place, json.dumps(record, indent=1) + "\n")
    except StorageError:
        return


def _record_path(variant: str, machine: str) -> Path:
    return cache_folder() / f"variant-{variant}-{machine}.json"


def _version(distribution: str) -> str:
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return "none"


def _identity(path: str) -> list[str | int]:
    try:
        status = os.stat(path)
    except OSError:
        return [path]
    return [path, status.st_size, status.st_mtime_ns]


def _text(path: str) -> str:
    try:
        return Path(path).read_text()
    except OSError:
        return ""


def _processor() -> list[str]:
    lines = _text("/proc/cpuinfo").splitlines()
    return sorted({line for line in lines if line.startswith(("model name", "flags", "Features"))})
