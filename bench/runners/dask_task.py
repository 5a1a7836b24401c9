"""What runs on a Dask worker: a share of a command, as a process of its own.

This file is sent to the workers as it stands and needs nothing but Python's own library there.
"""

from __future__ import annotations

import os
import socket
import subprocess
import time
from pathlib import Path

LOOK_S = 0.5
CANCELLED = -1


def sees(token: str) -> bool:
    """Tell whether this machine sees a file."""
    return os.path.isfile(token)


def do_chunk(
    command: list[str], folder: str, environment: dict[str, str], place: str, name: str, number: int
) -> int:
    """Run a command and return its exit code.

    Parameters
    ----------
    command : list of str
    folder : str
        Where it runs.
    environment : dict
        Added to the worker's own.
    place : str
        The runner's folder.
    name : str
        Of the job; a file ``NAME.cancelled`` ends the command.
    number : int
        Of the chunk.
    """
    own = Path(place)
    (own / "started").mkdir(exist_ok=True)
    (own / "started" / str(number)).write_text(f"{name} {socket.gethostname()}\n")
    with (own / "logs" / f"{number}.log").open("ab") as log:
        running = subprocess.Popen(
            command,
            cwd=folder,
            env={**os.environ, **environment},
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
        )
        try:
            while running.poll() is None:
                if (own / f"{name}.cancelled").exists():
                    return CANCELLED
                time.sleep(LOOK_S)
        finally:
            if running.poll() is None:
                running.kill()
                running.wait()
    return running.returncode
