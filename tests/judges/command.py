"""The command line, as anybody runs it."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

HOUSE = Path(__file__).parents[2]
RVBENCH = HOUSE / ".venv" / "bin" / "rvbench"
SPLIT = ("0.4", "0.3", "0.3")


def rvbench(*words: object) -> str:
    """Run the command and return what it says; it has to end well."""
    told = subprocess.run(
        [RVBENCH, *map(str, words)],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": ""},
        cwd=HOUSE,
    )
    assert told.returncode == 0, told.stderr
    return told.stdout
