"""Whole runs of the command line in processes of their own, to be killed and compared."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from models.at_work import FAILED_NAME
from tests.support.patience import HANGS_S

HOUSE = Path(__file__).resolve().parents[2]
TIME_LIMIT_S = HANGS_S

SCENARIO = """
name = "small"
[camera]
width = 128
[motion]
start_s = 200.0
end_s = 210.0
rate_hz = 0.1
[sun]
shared = ["S2", "S3"]
[render]
samples = 4
marker_samples = 16
max_depth = 2
"""
EXPOSURES = 4

RVBENCH = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a test run in the background ignores it
from bench.cli import main
sys.exit(main(sys.argv[1:]))
"""

# Sends itself a signal before the first file that matches a pattern gets its name.
STRUCK = """
import fnmatch, os, pathlib, signal, sys
sign, pattern, rename = sys.argv.pop(1), sys.argv.pop(1), pathlib.Path.replace
def replace(scratch, place):
    if fnmatch.fnmatch(str(place), pattern):
        os.kill(os.getpid(), getattr(signal, sign))
    return rename(scratch, place)
pathlib.Path.replace = replace
"""


def start(*arguments: object, struck: tuple[str, str] | None = None) -> Any:
    """Start ``rvbench``; where ``struck`` by a signal, it is as a file matching a pattern is made.

    Parameters
    ----------
    struck : (str, str), optional
        Name of the signal, and pattern of the file's path.
    """
    program, strike = (RVBENCH, ()) if struck is None else (STRUCK + RVBENCH, struck)
    return subprocess.Popen(
        [sys.executable, "-P", "-c", program, *strike, *map(str, arguments)],
        cwd=HOUSE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def rvbench(*arguments: object, struck: tuple[str, str] | None = None) -> tuple[int, str]:
    """Run ``rvbench`` to its end; return its exit code and what it said on stderr."""
    process = start(*arguments, struck=struck)
    _, errors = process.communicate(timeout=TIME_LIMIT_S)
    return process.returncode, errors


def write_scenario(folder: Path) -> Path:
    """Write the small scenario into a folder."""
    path = folder / "small.toml"
    path.write_text(SCENARIO)
    return path


def identities(folder: Path, pattern: str = "*") -> dict[str, tuple[int, int]]:
    """Return inode and time of writing of all files below a folder whose names match."""
    return {
        str(path.relative_to(folder)): (path.stat().st_ino, path.stat().st_mtime_ns)
        for path in sorted(folder.rglob(pattern))
        if path.is_file()
    }


def contents(folder: Path) -> dict[str, str]:
    """Return a hash of every file below a folder: runtimes, and what names folders, apart."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(_lasting(path)).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
        and path.name not in ("report.html", FAILED_NAME)
        and not path.match("*.runtime.csv")
        and not path.match("claims/*.json")
    }


def scratch_files(*folders: Path) -> list[Path]:
    """Return what is half written."""
    return [path for folder in folders for path in folder.rglob(".*.part")]


def _lasting(path: Path) -> bytes:
    if path.name not in ("score.json", "light.json"):
        return path.read_bytes()
    return json.dumps(_without(json.loads(path.read_text()), {"runtime_ms", "store"})).encode()


def _without(value: Any, keys: set[str]) -> Any:
    if not isinstance(value, dict):
        return value
    return {key: _without(item, keys) for key, item in value.items() if key not in keys}
