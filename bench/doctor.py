"""``rvbench doctor``: what this machine has, what renders on it, and what to do about the rest."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table

from models.plain_console import plain_console
from renders.store.radiance_store import default_store
from renders.variant.choice import VARIANTS, ProbeResult, probe, remedy
from renders.variant.probe_cache import cache_folder, libllvm_files

DISTRIBUTIONS = ("rvbench", "mitsuba", "drjit", "numpy", "opencv-contrib-python-headless")
SCARCE_DISK_BYTES = 5e9  # a full approach at 2048 x 2048 wants a few
ELSEWHERE = {
    "caches": "name another folder in RVBENCH_CACHE",
    "light": "name another folder in RVBENCH_STORE",
    "here": "write elsewhere with --out",
}
DONE, COULD_NOT_RUN = 0, 2


def doctor(console: Console | None = None) -> int:
    """Print the state of this machine as tables, every variant probed afresh.

    Returns
    -------
    int
        0 if at least one variant renders, else 2.
    """
    console = console or plain_console()
    results = [probe(variant, fresh=True) for variant in VARIANTS]
    gpus = graphics_cards()
    console.print(_facts("versions", versions()))
    console.print(_facts("machine", [*machine(), *(("GPU", gpu) for gpu in gpus or ("none",))]))
    console.print(_variants(results))
    console.print(_facts("disk", disks()))
    to_do = [f"to do: {line}" for line in advice(results, gpus)]
    for line in to_do or ["nothing is missing"]:
        console.print(line, soft_wrap=True, markup=False, highlight=False)
    return DONE if any(result.renders for result in results) else COULD_NOT_RUN


def versions() -> list[tuple[str, str]]:
    """Return (name, version) of the house and of what its results rest on."""
    found = [("python", platform.python_version()), ("system", platform.platform())]
    for name in DISTRIBUTIONS:
        try:
            found.append((name, metadata.version(name)))
        except metadata.PackageNotFoundError:
            found.append((name, "not installed"))
    return found


def machine() -> list[tuple[str, str]]:
    """Return what there is to compute with, as this process may use it."""
    return [
        ("cores", str(usable_cores())),
        ("memory", memory()),
        ("libLLVM files", "\n".join(Path(path).name for path in libllvm_files()) or "none"),
    ]


def usable_cores() -> int:
    """Return the number of cores this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def memory() -> str:
    """Return the memory of the machine, and how much of it is free where the system says."""
    try:
        total = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return "unknown"
    try:
        lines = Path("/proc/meminfo").read_text().splitlines()
        kib = next(int(line.split()[1]) for line in lines if line.startswith("MemAvailable"))
    except (OSError, StopIteration):
        return _gigabytes(total)
    return f"{_gigabytes(total)}, {_gigabytes(kib * 1024)} free"


def graphics_cards() -> list[str]:
    """Return one line for each NVIDIA card, as its own tool tells; empty where there is none."""
    query = ["nvidia-smi", "--query-gpu=name,driver_version,memory.total", "--format=csv,noheader"]
    try:
        done = subprocess.run(query, capture_output=True, text=True, timeout=20, check=True)
    except (OSError, subprocess.SubprocessError):
        return []
    return [line.strip() for line in done.stdout.splitlines() if line.strip()]


def disks() -> list[tuple[str, str]]:
    """Return the room left where rendered light is kept and where a run here would write."""
    return [(name, f"{folder}\n{_room(folder)}") for name, folder in _folders().items()]


def advice(results: list[ProbeResult], gpus: list[str]) -> list[str]:
    """Return what to do about what is missing; a machine without a GPU is told nothing of it."""
    lines = []
    for result in results:
        if result.renders or (result.variant == VARIANTS["cuda"] and not gpus):
            continue
        lines.append(f"{result.variant} does not render ({result.reason}): {remedy(result)}")
    for name, folder in _folders().items():
        there = _existing(folder)
        if not os.access(there, os.W_OK):
            lines.append(f"{name}: {there} cannot be written: {ELSEWHERE[name]}")
        elif shutil.disk_usage(there).free < SCARCE_DISK_BYTES:
            lines.append(f"{name}: {folder} has little room, {_room(folder)}: {ELSEWHERE[name]}")
    return lines


def _variants(results: Iterable[ProbeResult]) -> Table:
    table = _table("variants, each tried in a process of its own")
    table.show_header = True
    for heading in ("variant", "renders", "first image", "Msamples/s", "library, or why not"):
        table.add_column(heading, overflow="fold")
    for result in results:
        if result.renders:
            times = f"{result.first_image_s:.1f} s", f"{result.samples_per_s / 1e6:.1f}"
            table.add_row(result.variant, "yes", *times, result.library)
        else:
            table.add_row(result.variant, "no", "", "", result.reason)
    return table


def _facts(title: str, facts: Iterable[tuple[str, str]]) -> Table:
    table = _table(title)
    table.add_column()
    table.add_column(overflow="fold")
    for name, value in facts:
        table.add_row(name, value)
    return table


def _table(title: str) -> Table:
    return Table(title=title, title_justify="left", box=box.SIMPLE, show_header=False)


def _folders() -> dict[str, Path]:
    return {"caches": cache_folder(), "light": default_store(), "here": Path.cwd()}


def _existing(folder: Path) -> Path:
    return next(parent for parent in (folder, *folder.absolute().parents) if parent.exists())


def _room(folder: Path) -> str:
    return f"{_gigabytes(shutil.disk_usage(_existing(folder)).free)} free"


def _gigabytes(size_bytes: float) -> str:
    return f"{size_bytes / 1e9:.1f} GB"
