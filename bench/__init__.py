"""Scenarios run, scored, reported and exported; the command line.

The four rooms are top-level packages, so a stray ``models`` on the path could stand in for ours
without a word. It is refused here, at the one door every command passes.
"""

import os
from importlib.util import find_spec
from pathlib import Path

# Before NumPy is loaded: for matrices of 6 x 6, threads of OpenBLAS on busy cores cost 40 times
# what they save.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

_HOME = Path(__file__).resolve().parent.parent

for _room in ("models", "renders", "pipelines"):
    _spec = find_spec(_room)
    _found = Path(_spec.origin).resolve().parent if _spec and _spec.origin else None
    if _found != _HOME / _room:
        raise ImportError(
            f"expected the package {_room!r} in {_HOME}, beside {Path(__file__).parent.name}, "
            f"found it at {_found}; another folder of that name is first on the path: "
            "use the `rvbench` command, or `python -P -m bench.cli`, or another folder to start in"
        )
