"""What a process that was killed as a file was about to get its name leaves beside it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from models import atomic_file


def left_half_written(path: Path) -> Path:
    """Leave it beside a file that may not be there yet; return it.

    Parameters
    ----------
    path : Path
    """
    ended = subprocess.Popen([sys.executable, "-S", "-c", ""])
    ended.wait()
    scratch = path.parent / f".{path.name}.{atomic_file.MACHINE}-{ended.pid}.part"
    scratch.parent.mkdir(parents=True, exist_ok=True)
    scratch.write_bytes(b"half")
    return scratch
